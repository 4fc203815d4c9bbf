// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Moves runs of instructions out of long blocks into functions of their own, `NAME_part_1` and so on: parameters are
/// what a run reads, results what others read of it. C++ compilers take time that grows with the square of a function's
/// length (tests and figures in emit/cpp.h). What is uniform and what varies go into runs of their own, so that what
/// counts a loop stays uniform. Keeps every bit: no operation changes, nor does what it reads.
/// Needs: a valid module. Leaves: a valid one, in which a block computes about `longest` values, unless it is one long
/// list of arguments.
void cut_long(ir::Module& module, size_t longest);

}  // namespace isoshade::passes
