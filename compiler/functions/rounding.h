// SPDX-License-Identifier: Apache-2.0
// To whole numbers, and what is left over.
#pragma once

#include "compiler/functions/comparison.h"

namespace isoshade::functions {

/// The least whole number not below x.
/// Domain: all floats. Zeros, infinities and NaN give themselves; above -1 and below 0 it is -0.
/// Error: 0 ULP.
template <class F>
F ceil(F x) {
  return negate(floor(negate(x)));
}

/// The whole number nearest to x; halves go to the even one, as GLSL's roundEven and IEEE-754 have it.
/// Domain: all floats. Zeros, infinities and NaN give themselves; what rounds to zero keeps its sign.
/// Error: 0 ULP.
template <class F>
F round(F x) {
  constexpr float whole = 0x1p23f;  // from here on every float is whole
  const auto small = abs(x) < whole;
  const F within = select(small, x, F(0.0f));
  const F magnitude = (abs(within) + whole) - whole;
  return select(small, from_bits_normal(bits_nonnan(magnitude) | (bits_nonnan(within) & sign_bit)), x);
}

/// x - floor(x), in [0, 1): what would round to 1 is the float below.
/// Domain: all floats; infinities and NaN give NaN.
/// Error: 1 ULP.
template <class F>
F fract(F x) {
  return min(x - floor(x), F(0x1.fffffep-1f));
}

/// x - y * floor(x / y), with the sign of y.
/// Domain: |x / y| < 2^23, or the result may leave [0, |y|]. y = 0, infinities and NaN give NaN.
/// Error: 1 ULP of |x| + |y|; where x / y rounds to a whole number 0 and y are taken for each other.
template <class F>
F mod(F x, F y) {
  const F rest = x - y * floor(x / y);
  // A quotient just below a whole number may have been rounded up to it.
  return select((rest < 0.0f) ^ (y < 0.0f), select(rest == 0.0f, rest, rest + y), rest);
}

}  // namespace isoshade::functions
