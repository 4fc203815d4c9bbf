// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Gives each call with constant arguments a callee of its own that has those constants in its body, folded.
/// A driver inlines calls, and then folds what it sees of the constants by rules of its own (fold and
/// hide_foldables tell which); so nothing constant may cross a call. It also saves what they make needless:
/// pow(x, 2.4) splits no exponent. Callees without float arithmetic (min, clamp, ...) stay: choosing among
/// constants is exact.
/// Needs: a valid module whose functions have bodies. Leaves: no call that passes a constant to arithmetic; the
/// functions that are not called any more (dce drops them). A module that would grow by more than 200,000
/// instructions keeps its remaining calls.
void specialize(ir::Module& module);

}  // namespace isoshade::passes
