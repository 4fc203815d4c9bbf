// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Moves runs of instructions from long blocks into functions of their own, `NAME_part_1` and so on. A part's
/// parameters are the values that the run reads, its results the values that others read from it. The reason: the
/// time that a C++ compiler takes grows with the square of a function's length (figures in emit/cpp.h). Uniform and
/// varying instructions go into separate runs, so that loop counts stay uniform. Bit-exact: no operation changes, nor
/// do its operands.
/// Needs: a valid module. Leaves: a valid module in which a block computes about `longest` values, unless it is one
/// long list of arguments.
void cut_long(ir::Module& module, size_t longest);

}  // namespace isoshade::passes
