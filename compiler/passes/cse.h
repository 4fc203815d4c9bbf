// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Common subexpression elimination: replaces an instruction by an equal one before it, in its block or in an enclosing
/// one. Two instructions are equal if they have the same op and operands, in either order where the op commutes. Calls
/// and loads are merged, too, since everything is pure; branches and loops are not. A name is kept.
/// Needs: a valid module. Leaves: the replaced instructions in no block (renumber drops them).
void cse(ir::Module& module);

}  // namespace isoshade::passes
