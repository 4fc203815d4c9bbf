// SPDX-License-Identifier: Apache-2.0
// Ops that some devices and languages lack, built from ops that all compute exactly. fdiv and fsqrt, for devices that do not
// round them correctly: both approximate by Newton's method and then correct the last bit with the exact integer remainder,
// which fits in 32 bits because only its low bits are unknown. imulhi and umulhi, for languages without a product of 64 bits.
#pragma once

#include "compiler/functions/body.h"

namespace isoshade::functions {

/// a / b, rounded to nearest even.
/// Domain: all floats; as IEEE-754 with denormals flushed before and after.
/// Error: 0 ULP.
template <class F>
F div_exact(F a, F b) {
  using Int = int_of<F>;
  const Int a_bits = bits(a);
  const Int b_bits = bits(b);
  const Int a_exponent = shift_right(a_bits, 23) & 255;
  const Int b_exponent = shift_right(b_bits, 23) & 255;
  const Int a_fraction = a_bits & fraction_mask;
  const Int b_fraction = b_bits & fraction_mask;

  // Significands in [1, 2); the dividend's is doubled if it is the smaller one, so that the quotient is in [1, 2), too.
  const auto doubled = a_fraction < b_fraction;
  const F x = from_bits_normal(a_fraction | select(doubled, Int(0x40000000), Int(one_bits)));
  const F y = from_bits_normal(b_fraction | one_bits);
  F r = from_bits_normal(0x7ef311c7 - bits_nonnan(y));
  r = r * (2.0f - y * r);
  r = r * (2.0f - y * r);
  r = r * (2.0f - y * r);

  // quotient * 2^23 as an integer, and 2^23 times the remainder, modulo 2^32.
  const Int divisor = b_fraction | implicit_bit;
  const Int dividend = shift_left(a_fraction | implicit_bit, select(doubled, Int(24), Int(23)));
  const Int estimate = to_int((x * r) * 0x1p23f);
  const Int estimate_rest = dividend - estimate * divisor;
  const Int correction = to_int(floor((to_float(estimate_rest) * r) * 0x1p-23f + 0.5f));
  const Int near = estimate + correction;
  const Int near_rest = estimate_rest - correction * divisor;
  const auto up = near_rest + near_rest > divisor;
  const Int raised = near + select(up, Int(1), Int(0));
  const Int rest = near_rest - select(up, divisor, Int(0));
  const auto down = rest + rest < 0 - divisor;
  const Int quotient = raised - select(down, Int(1), Int(0));

  const Int exponent = (a_exponent - b_exponent) + select(doubled, Int(126), Int(127));
  const Int finite = shift_left(exponent - 1, 23) + quotient;
  const Int flushed = select(finite < implicit_bit, Int(0), finite);
  const Int magnitude = select(exponent >= 255, Int(exponent_bits), flushed);

  const auto a_zero = a_exponent == 0;
  const auto b_zero = b_exponent == 0;
  const auto a_huge = a_exponent == 255;  // infinite or NaN
  const auto b_huge = b_exponent == 255;
  const Int below = select(a_zero | b_huge, Int(0), magnitude);
  const Int above = select(b_zero | a_huge, Int(exponent_bits), below);
  const Int signed_bits = above | ((a_bits ^ b_bits) & sign_bit);
  const auto a_nan = a_huge & (a_fraction != 0);
  const auto b_nan = b_huge & (b_fraction != 0);
  const auto invalid = (a_zero & b_zero) | (a_huge & b_huge);
  return from_bits_normal(select(a_nan | b_nan | invalid, Int(canonical_nan), signed_bits));
}

/// The square root, rounded to nearest even.
/// Domain: all floats; as IEEE-754 with denormals flushed: -0 gives -0, negative numbers give NaN.
/// Error: 0 ULP.
template <class F>
F sqrt_exact(F a) {
  using Int = int_of<F>;
  const Int a_bits = bits(a);
  const Int biased = shift_right(a_bits, 23) & 255;
  const Int fraction = a_bits & fraction_mask;
  const Int exponent = biased - 127;
  const Int odd = exponent & 1;

  // The significand, in [1, 4), and its inverse square root.
  const F x = from_bits_normal(fraction | shift_left(odd + 127, 23));
  const F half = x * 0.5f;
  F r = from_bits_normal(0x5f3759df - shift_right(bits_nonnan(x), 1));
  r = r * (1.5f - (half * r) * r);
  r = r * (1.5f - (half * r) * r);
  r = r * (1.5f - (half * r) * r);

  // root * 2^23 as an integer, and 2^46 times the remainder, modulo 2^32.
  const Int square = shift_left(shift_left(fraction | implicit_bit, odd), 23);
  const Int estimate = to_int((x * r) * 0x1p23f);
  const Int estimate_rest = square - estimate * estimate;
  const Int correction = to_int(floor((to_float(estimate_rest) * r) * 0x1p-24f + 0.5f));
  const Int near = estimate + correction;
  const Int near_rest = estimate_rest - (estimate + near) * correction;
  const auto up = near_rest > near;
  const Int rest = near_rest - select(up, (near + near) + 1, Int(0));
  const Int raised = near + select(up, Int(1), Int(0));
  const auto down = rest <= 0 - raised;
  const Int root = raised - select(down, Int(1), Int(0));

  const Int finite = shift_left(shift_right_signed(exponent, 1) + 126, 23) + root;
  const auto negative = a_bits < 0;
  const auto huge = biased == 255;  // infinite or NaN
  const Int positive = select(huge, a_bits, finite);
  const Int valid = select(negative, Int(canonical_nan), positive);
  return from_bits_normal(select(biased == 0, a_bits & sign_bit, valid));
}

/// The high word of the product of two unsigned words.
/// Domain: all ints, read as unsigned.
/// Error: exact.
/// Source: Knuth, The Art of Computer Programming 2, 4.3.1, algorithm M, with digits of 16 bits: no sum exceeds 32 bits.
template <class I>
I unsigned_mul_hi_by_halves(I a, I b) {
  const I a_low = a & 0xffff, a_high = shift_right(a, 16);
  const I b_low = b & 0xffff, b_high = shift_right(b, 16);
  const I middle = a_high * b_low + shift_right(a_low * b_low, 16);
  const I carried = a_low * b_high + (middle & 0xffff);
  return a_high * b_high + shift_right(middle, 16) + shift_right(carried, 16);
}

/// The high word of the product of two ints. As unsigned words, a negative operand is larger by 2^32, and the high word of the
/// product larger by the other operand.
/// Domain: all ints.
/// Error: exact.
template <class I>
I mul_hi_by_halves(I a, I b) {
  return unsigned_mul_hi_by_halves(a, b) - (shift_right_signed(a, 31) & b) - (shift_right_signed(b, 31) & a);
}

}  // namespace isoshade::functions
