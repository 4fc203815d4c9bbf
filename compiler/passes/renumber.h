// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Rewrites every function in canonical order and drops what nothing needs: instructions, blocks, results of
/// branches, values that loops carry, and origins.
/// The order of a block is depth-first from its yields: a value's operands come before it, in their order.
/// What blocks inside use from outside counts as operands of the instruction that has them. So it depends
/// only on what computes what, not on the order in which a builder (and a C++ compiler, which picks the order
/// of arguments) made it. Values, instructions, blocks and origins are numbered as text IR counts them.
/// Needs: a valid module. Leaves: nothing dead inside functions; print and parse give back the same module.
void renumber(ir::Module& module);

}  // namespace isoshade::passes
