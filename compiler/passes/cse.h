// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Computes once what is computed twice: replaces an instruction by an equal one before it in its block or in
/// one around it. Equal are instructions of the same op on the same operands, in either order where the op
/// commutes on all values; calls and loads too, since everything is pure. Not branches and loops. A name is
/// kept. Needs: a valid module. Leaves: the replaced instructions in no block (renumber drops them).
void cse(ir::Module& module);

}  // namespace isoshade::passes
