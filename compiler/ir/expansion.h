// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::ir {

/// What functions come to when each of their calls is replaced by the body of what it calls, as every Vulkan driver
/// does: the operations on single numbers of each, those of both ways through a branch and of one turn of a loop. Two
/// calls in each of 30 nested functions make 2^30. By function of the module; of those that `entry` does not reach, and
/// of declarations, 0. Stops counting at a number beyond all limits. `of_division` is what `/` or sqrt counts.
std::vector<uint64_t> expanded_operations(const Module& module, uint32_t entry, uint64_t of_division = 1);

/// The same of one instruction, with its blocks, given those of what it calls.
uint64_t expanded_operations(const Function& function, const Instruction& instruction,
                             const std::vector<uint64_t>& of_functions, uint64_t of_division = 1);

}  // namespace isoshade::ir
