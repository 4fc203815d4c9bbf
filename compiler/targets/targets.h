// SPDX-License-Identifier: Apache-2.0
// The table of target languages.
#pragma once

#include <span>
#include <string_view>

#include "compiler/emit/target.h"

namespace isoshade::targets {

/// In the order of targets.def.
std::span<const emit::Target* const> all();
const emit::Target& get(emit::TargetId id);
/// By its name on the command line; null: there is none.
const emit::Target* find(std::string_view name);
/// The target whose binary form has this name; null: there is none.
const emit::Target* find_binary(std::string_view name);

}  // namespace isoshade::targets
