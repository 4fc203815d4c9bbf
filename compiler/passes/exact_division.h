// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Replaces `/` and `sqrt` by the library's div_exact and sqrt_exact, for devices that round them otherwise:
/// the same bits from + - * and integer ops. Needs: nothing. Leaves: no fdiv and no fsqrt; declarations where
/// the module had not the two functions.
void exact_division(ir::Module& module);

}  // namespace isoshade::passes
