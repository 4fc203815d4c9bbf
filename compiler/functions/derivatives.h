// SPDX-License-Identifier: Apache-2.0
// The DERIVATIVE and FLAT rows of functions.def as IR.
#pragma once

#include <array>
#include <span>

#include "compiler/functions/library.h"

namespace isoshade::functions {

/// Makes what a result changes by where one argument changes by `change`.
using Contribution = ir::ValueId (*)(ir::Builder&, std::span<const ir::ValueId> arguments,
                                     ir::ValueId change);

/// Of each argument; null: the result does not change with it.
using DerivativeRule = std::array<Contribution, 2>;

/// The rule of a variant, which has one result then; null: its body tells.
const DerivativeRule* find_derivative(const Variant& variant);

}  // namespace isoshade::functions
