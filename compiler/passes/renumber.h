// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Rewrites every function in canonical order and drops what nothing uses: instructions, blocks, results of
/// branches, values that loops carry, and origins.
/// The order of a block is depth-first from its yields: a value's operands come before it, in their order. What
/// inner blocks use from outside counts as operands of the instruction that contains them. So the order depends
/// only on the data flow, and not on the order in which a builder made the instructions (where C++ leaves the
/// evaluation order of arguments open). Values, instructions, blocks and origins get the numbers of text IR.
/// Needs: a valid module. Leaves: nothing dead inside functions; print and parse give back the same module.
void renumber(ir::Module& module);

}  // namespace isoshade::passes
