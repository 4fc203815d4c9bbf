// SPDX-License-Identifier: Apache-2.0
// Rounding to integers, fractions and remainders.
#pragma once

#include <tuple>

#include "compiler/functions/comparison.h"

namespace isoshade::functions {

/// The smallest integer not below x.
/// Domain: all floats. Zeros, infinities and NaN are returned unchanged; x in (-1, 0) gives -0.
/// Error: 0 ULP.
template <class F>
F ceil(F x) {
  return negate(floor(negate(x)));
}

/// The integer nearest to x, ties to even, like GLSL's roundEven.
/// Domain: all floats. Zeros, infinities and NaN are returned unchanged; a zero result keeps the sign of x.
/// Error: 0 ULP.
template <class F>
F round(F x) {
  constexpr float whole = 0x1p23f;  // all floats from here are integers
  const auto small = abs(x) < whole;
  const F within = select(small, x, F(0.0f));
  const F magnitude = (abs(within) + whole) - whole;
  return select(small, from_bits_normal(bits_nonnan(magnitude) | (bits_nonnan(within) & sign_bit)), x);
}

/// x - floor(x), in [0, 1): a difference that rounds to 1 gives the largest float below 1.
/// Domain: all floats; infinities and NaN give NaN.
/// Error: 1 ULP.
template <class F>
F fract(F x) {
  return min(x - floor(x), F(0x1.fffffep-1f));
}

/// The exact remainder of |x| divided by |y|, or, if `complement`, |y| minus the remainder (0 stays 0), for finite
/// |x| >= |y| > 0. Other arguments give an unspecified number.
/// Long division of the significands, 7 bits of the quotient per step, so that quotients convert to int exactly.
template <class F>
F remainder_of_magnitudes(F x, F y, bool_of<F> complement) {
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
  const Int rest = select(complement & (left != 0), divisor - left, left);
  return (to_float(rest) * 0x1p-24f) * from_bits_normal(shift_left(exponent(y_bits) + 1, 23));
}

/// The floored remainder x - y * floor(x / y), with the sign of y.
/// Domain: all floats. A divisor of 0, infinities and NaN give NaN.
/// Error: 1 ULP of |x| + |y|, where 0 and y count as equal if x / y rounds to an integer; 1 ULP of |y| for
/// |x / y| >= 2^20.
template <class F>
F mod(F x, F y) {
  const F quotient = x / y;
  return branch(
      abs(quotient) < 0x1p20f,
      [&] {
        const F rest = x - y * floor(quotient);
        // The quotient may have been rounded up to an integer, and the product is rounded.
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
