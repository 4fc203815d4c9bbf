// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::ir {

/// The size of each function after inlining all calls, as every Vulkan driver inlines them: the number of scalar
/// operations, with both sides of a branch and one turn of a loop. (Two calls in each of 30 nested functions make
/// 2^30.) By function of the module; 0 for declarations and for functions that `entry` does not reach. Counting
/// saturates. `of_division` is the weight of `/` and sqrt.
std::vector<uint64_t> expanded_operations(const Module& module, uint32_t entry, uint64_t of_division = 1);

/// The size of one instruction with its blocks, given the sizes of the functions.
uint64_t expanded_operations(const Function& function, const Instruction& instruction,
                             const std::vector<uint64_t>& of_functions, uint64_t of_division = 1);

}  // namespace isoshade::ir
