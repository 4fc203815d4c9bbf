// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/functions/tier.h"
#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Replaces what the ranges of parameters decide, in functions of documents: comparisons with a known outcome by
/// constants; min, max, clamp and saturate of values within the limits, and magnitudes of positive values, by the
/// operand that they return. Bit-exact. Relies on parameters being in range (scenes are checked when loaded); takes
/// NaN and the signs of zeros into account; ranges contain every float that the ops can give.
/// Needs: bodies for all calls. Leaves: comparisons that are constants, for fold.
void decide(ir::Module& module, functions::Tier tier);

}  // namespace isoshade::passes
