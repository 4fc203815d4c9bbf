// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "compiler/functions/tier.h"
#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Replaces what is known before run time:
/// - ops and calls on constants, by the interpreter (calls that read buffers or take very long remain), but
/// not
///   where a precondition fails;
/// - what equals one of its operands, or a cheaper op, for every value of the language: NaN, infinities and
/// both
///   zeros included (identities.h);
/// - ops on constants chosen by one select by a select of their results; a branch's results that are constants on
///   both sides by a select;
/// - a branch whose condition is constant by its side; results that both sides yield alike; a loop that runs
/// never
///   or once by its initial values or its body.
/// In the functions from index `first` on. Calls of library functions that have no body yet are evaluated with those
/// of the tier; without one they stay.
/// Needs: a valid module. Leaves: the replaced instructions in no block (renumber drops them).
void fold(ir::Module& module, std::optional<functions::Tier> tier = {}, size_t first = 0);

}  // namespace isoshade::passes
