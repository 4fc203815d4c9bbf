// SPDX-License-Identifier: Apache-2.0
// The rows of functions.def as functions of numbers.
#pragma once

#include <span>

#include "backends/reference/real.h"
#include "compiler/functions/library.h"

namespace isoshade::reference {

/// Evaluates a variant by the reference column of its row. Arguments and results are flattened: vectors component by
/// component, matrices column by column.
void evaluate(const functions::Variant& variant, std::span<const Real> arguments, std::span<Real> results);

}  // namespace isoshade::reference
