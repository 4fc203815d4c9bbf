// SPDX-License-Identifier: Apache-2.0
// Functions built from comparisons.
#pragma once

#include "compiler/functions/body.h"

namespace isoshade::functions {

/// The smaller of a and b.
/// Domain: all floats. Returns `a` if either is NaN or both are zeros.
/// Error: 0 ULP.
template <class F>
F min(F a, F b) {
  return select(b < a, b, a);
}

/// The larger of a and b.
/// Domain: all floats. Returns `a` if either is NaN or both are zeros.
/// Error: 0 ULP.
template <class F>
F max(F a, F b) {
  return select(a < b, b, a);
}

/// The value in [low, high] nearest to `x`.
/// Domain: all floats. Returns `high` if `low` is above it. A NaN `x` gives NaN; a NaN bound is ignored.
/// Error: 0 ULP.
template <class F>
F clamp(F x, F low, F high) {
  return min(max(x, low), high);
}

/// The value in [0, 1] nearest to `x`.
/// Domain: all floats. NaN and -0 give +0.
/// Error: 0 ULP.
template <class F>
F saturate(F x) {
  const F below_one = select(x < 1.0f, x, F(1.0f));
  return select(x > 0.0f, below_one, F(0.0f));
}

/// `x`, or 0 if it is infinite or NaN.
/// Domain: all floats.
/// Error: 0 ULP.
template <class F>
F finite_or_zero(F x) {
  return select(abs(x) <= 3.4028234663852886e38f, x, F(0.0f));
}

/// 1, 0 or -1.
/// Domain: all floats. Zeros and NaN are returned unchanged.
/// Error: 0 ULP.
template <class F>
F sign(F x) {
  const F below_zero = select(x < 0.0f, F(-1.0f), x);
  return select(x > 0.0f, F(1.0f), below_zero);
}

/// 0 for x < edge, 1 for x >= edge.
/// Domain: all floats. 1 if either is NaN.
/// Error: 0 ULP.
template <class F>
F step(F edge, F x) {
  return select(x < edge, F(0.0f), F(1.0f));
}

}  // namespace isoshade::functions
