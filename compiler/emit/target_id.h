// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace isoshade::emit {

/// The text languages, in the order of targets.def.
enum class TargetId : uint8_t {
#define TARGET(name) name,
#include "compiler/targets/targets.def"
};
inline constexpr size_t target_count = 0
#define TARGET(name) +1
#include "compiler/targets/targets.def"
    ;

}  // namespace isoshade::emit
