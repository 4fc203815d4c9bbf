// SPDX-License-Identifier: Apache-2.0
// Functions that choose.
#pragma once

#include "compiler/functions/body.h"

namespace isoshade::functions {

/// The lesser.
/// Domain: all floats. If either is NaN, or they are zeros of different sign, it is the first.
/// Error: 0 ULP.
template <class F>
F min(F a, F b) {
  return select(b < a, b, a);
}

/// The greater.
/// Domain: all floats. If either is NaN, or they are zeros of different sign, it is the first.
/// Error: 0 ULP.
template <class F>
F max(F a, F b) {
  return select(a < b, b, a);
}

/// The nearest value to `x` in [low, high].
/// Domain: all floats. With `low` above `high` it is `high`. NaN gives NaN; as an end it counts as none.
/// Error: 0 ULP.
template <class F>
F clamp(F x, F low, F high) {
  return min(max(x, low), high);
}

/// The nearest value to `x` in [0, 1].
/// Domain: all floats. NaN and -0 give +0.
/// Error: 0 ULP.
template <class F>
F saturate(F x) {
  const F below_one = select(x < 1.0f, x, F(1.0f));
  return select(x > 0.0f, below_one, F(0.0f));
}

/// `x`, or 0 where it is infinite or NaN.
/// Domain: all floats.
/// Error: 0 ULP.
template <class F>
F finite_or_zero(F x) {
  return select(abs(x) <= 3.4028234663852886e38f, x, F(0.0f));
}

/// 1, 0 or -1.
/// Domain: all floats. Zeros and NaN give themselves.
/// Error: 0 ULP.
template <class F>
F sign(F x) {
  const F below_zero = select(x < 0.0f, F(-1.0f), x);
  return select(x > 0.0f, F(1.0f), below_zero);
}

/// 0 below `edge`, 1 from there on.
/// Domain: all floats. If either is NaN it is 1.
/// Error: 0 ULP.
template <class F>
F step(F edge, F x) {
  return select(x < edge, F(0.0f), F(1.0f));
}

}  // namespace isoshade::functions
