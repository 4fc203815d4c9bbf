// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::ir {

/// The functions that `entries` reach through calls, callees before callers, otherwise in the order in which
/// they are called; nothing if a function reaches itself. Callee indices must be in range.
std::optional<std::vector<uint32_t>> callees_first(const Module& module, std::span<const uint32_t> entries);

}  // namespace isoshade::ir
