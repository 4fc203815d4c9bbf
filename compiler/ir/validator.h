// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "compiler/ir/module.h"

namespace isoshade::ir {

/// Empty if the module keeps every rule of the IR, else the first breach in words. Any module may be asked
/// about, however broken. The rules:
/// - Names of buffers, functions, parameters, groups, results and nodes are identifiers, and unique where
/// they
///   stand side by side; a group's parameters are consecutive. Only library functions lack a body.
/// - Every index is in range; every listed instruction, block and value has one place. A value is used only
/// after
///   it is defined, in its own block or one inside. What no block lists is dead and may be anything.
/// - Operands and results have the types of the op's rule; constants are canonical (no denormal, NaN
/// 0x7fc00000,
///   bools 0 or 1).
/// - A branch has a bool and two blocks without parameters that yield its results. A loop has a uniform
/// count,
///   initial values, and one block with an index and the carried values as parameters, which it yields again.
///   Blocks nest at most max_block_depth deep.
/// - Calls fit the callee's types, give uniform values to its uniform parameters, and never lead back.
std::string validate(const Module& module);

}  // namespace isoshade::ir
