// SPDX-License-Identifier: Apache-2.0
// What the functions of a forward pair ask their host for, as functions of the pair.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "compiler/emit/forward.h"

namespace isoshade::glsl {

/// The number of an image's first level; its smaller levels are the numbers behind it (the wrapper's own convention).
inline constexpr size_t forward_levels = 16;

/// The definitions. `is_es`: for WebGL 2.0, where y is up in pictures that were drawn.
std::string forward_host(const emit::ForwardProgram& program, bool is_es);

/// What print_linked calls the struct of the results of a function of the wrapper.
std::string forward_result_record(std::string_view function);

}  // namespace isoshade::glsl
