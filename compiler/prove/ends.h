// SPDX-License-Identifier: Apache-2.0
// What an op gives at the ends of its operands' ranges: how ranges go, without errors. Needs lanes::FpGuard.
#pragma once

#include <optional>

#include "compiler/ir/op.h"

namespace isoshade::prove {

/// A range of floats, ints or truth values (0, 1), both ends within it.
struct Ends {
  double lo = 0, hi = 0;
  bool is_point() const { return lo == hi; }
};

/// The range of what an op computes from operands within these, by its range rule; a float that overflows is infinite.
/// The second range of a unary op is not looked at; `same`: both operands are one value. Nothing where nothing is known
/// of the result but its type: where a rule does not tell, a divisor may be 0, the operand of a root negative, an
/// integer beyond 32 bits. Of a choice: that of its two sides, whichever is taken.
std::optional<Ends> ends_of(ir::RangeRule rule, const Ends& a, const Ends& b, bool same = false);

/// The least and the greatest magnitude.
Ends magnitudes(const Ends& a);
/// Rounds to the nearest float.
double rounded(double value);

}  // namespace isoshade::prove
