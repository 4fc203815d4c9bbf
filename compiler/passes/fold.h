// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "compiler/functions/tier.h"
#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Constant folding. Replaces
/// - ops and calls on constants by their results, as the interpreter computes them; not where a precondition
///   fails, nor calls that read buffers or take very long;
/// - ops that equal an operand, or a cheaper op, for every value including NaN, infinities and both zeros
///   (identities.h);
/// - ops on constants that one select chooses by a select of the results; a branch's result that is constant on
///   both sides by a select;
/// - a branch with a constant condition by the side taken; results that both sides yield alike by that value; a
///   loop that runs never or once by its initial values or its body.
/// Works on the functions from index `first` on. Calls of library functions that have no body yet are evaluated
/// with the bodies of the tier; without a tier they stay.
/// Needs: a valid module. Leaves: the replaced instructions in no block (renumber drops them).
void fold(ir::Module& module, std::optional<functions::Tier> tier = {}, size_t first = 0);

}  // namespace isoshade::passes
