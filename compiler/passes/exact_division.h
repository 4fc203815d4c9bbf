// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Replaces `/` and `sqrt` by the library's div_exact and sqrt_exact, for devices that do not round them correctly:
/// these compute the same bits by + - * and integer ops.
/// Leaves: no fdiv and no fsqrt; declarations of the two functions if the module did not have them.
void exact_division(ir::Module& module);

}  // namespace isoshade::passes
