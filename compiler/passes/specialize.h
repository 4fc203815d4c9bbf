// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Gives each call with constant arguments a clone of its callee in which the constants are folded. A driver
/// inlines calls and then folds constants by rules of its own (see hide_foldables), so no constant may cross a
/// call. It also saves work: pow(x, 2.4) need not split the exponent. Callees without float arithmetic (min,
/// clamp, ...) stay, because choosing among constants is exact.
/// Needs: a valid module whose functions have bodies. Leaves: no call that passes a constant to arithmetic;
/// functions that are no longer called (dce drops them). A module that would grow by more than 200,000
/// instructions keeps its remaining calls.
void specialize(ir::Module& module);

}  // namespace isoshade::passes
