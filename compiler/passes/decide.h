// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/functions/tier.h"
#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Replaces what the ranges of parameters decide, in functions that documents have: comparisons whose outcome is known
/// by it, min, max, clamp and saturate of what lies within, and magnitudes of what is positive, by what they choose.
/// Never a bit changes: parameters are of their ranges (a scene with others is refused), NaN and the signs of zeros are
/// minded, and ranges hold every float that the ops give.
/// Needs: bodies for all calls. Leaves: comparisons that are constants, for fold.
void decide(ir::Module& module, functions::Tier tier);

}  // namespace isoshade::passes
