// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "compiler/ir/module.h"

namespace isoshade::ir {

/// Checks every rule of the IR; returns the first breach in words, or nothing. The module may be broken in any way.
/// - Names of buffers, functions, parameters, groups, results and nodes are identifiers, and unique in their list;
///   the parameters of a group are consecutive. Only library functions lack a body.
/// - Every index is in range; every listed instruction, block and value is listed once. A value is used only after its
///   definition, in its own block or an inner one. What no block lists is dead and may be anything.
/// - Operands and results have the types of the op's rule; constants are canonical (no denormal, NaN 0x7fc00000, bools
///   0 or 1).
/// - A branch has a bool and two blocks without parameters that yield its results. A loop has a uniform count, initial
///   values, and one block with an index and the carried values as parameters, which yields the carried values. Blocks
///   nest at most max_block_depth deep.
/// - Calls fit the callee's types, pass uniform values to its uniform parameters, and are acyclic.
std::string validate(const Module& module);

}  // namespace isoshade::ir
