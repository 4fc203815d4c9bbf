// SPDX-License-Identifier: Apache-2.0
// To whole numbers, and what is left over.
#pragma once

#include <tuple>

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

/// What is left of |x| when divided by |y|, or else what is missing there, exactly, for finite |x| >= |y| > 0. Other
/// arguments give some number.
/// Long division of the significands, seven bits of the quotient at a time, which to_int can take.
template <class F>
F remainder_of_magnitudes(F x, F y, bool_of<F> missing) {
  using Int = int_of<F>;
  const auto exponent = [](Int pattern) { return shift_right(pattern, 23) & 255; };
  const Int x_bits = bits(x);
  const Int y_bits = bits(y);
  const Int divisor = (y_bits & fraction_mask) | implicit_bit;
  const Int dividend = (x_bits & fraction_mask) | implicit_bit;
  const Int places = exponent(x_bits) - exponent(y_bits);
  const F inverse = 1.0f / to_float(divisor);
  const auto more = [&](Int i, Int rest) {
    return branch(
        i * 7 < places,
        [&] {
          const Int left = places - i * 7;
          const Int dropped = select(left < 7, left, Int(7));
          const Int quotient = to_int(to_float(shift_left(rest, dropped)) * inverse);
          const Int estimate = shift_left(rest, dropped) - quotient * divisor;
          const Int above = select(estimate < 0, estimate + divisor, estimate);
          return std::tuple(select(above >= divisor, above - divisor, above));
        },
        [&] { return std::tuple(rest); });
  };
  const Int first = select(dividend >= divisor, dividend - divisor, dividend);
  const Int left = std::get<0>(loop(Int(37), more, first));
  const Int rest = select(missing & (left != 0), divisor - left, left);
  return (to_float(rest) * 0x1p-24f) * from_bits_normal(shift_left(exponent(y_bits) + 1, 23));
}

/// What is left of x when divided by y: x - y * floor(x / y), with the sign of y.
/// Domain: all floats. A divisor of 0, infinities and NaN give NaN.
/// Error: 1 ULP of |x| + |y|; where x / y rounds to a whole number 0 and y are taken for each other. From |x / y| =
/// 2^20 on it is 1 ULP of |y|.
template <class F>
F mod(F x, F y) {
  const F quotient = x / y;
  return branch(
      abs(quotient) < 0x1p20f,
      [&] {
        const F rest = x - y * floor(quotient);
        // A quotient just below a whole number may have been rounded up to it, and products round.
        const F turned = select((rest < 0.0f) ^ (y < 0.0f), select(rest == 0.0f, rest, rest + y), rest);
        return select(abs(turned) > abs(y), y, turned);
      },
      [&] {
        const auto x_is_finite = abs(x) < infinity;
        const auto y_is_finite = abs(y) < infinity;
        const auto defined = x_is_finite & y_is_finite & (y != 0.0f);
        const F magnitude = remainder_of_magnitudes(x, y, (x < 0.0f) ^ (y < 0.0f));
        return select(defined, select(y < 0.0f, negate(magnitude), magnitude), F(not_a_number));
      });
}

}  // namespace isoshade::functions
