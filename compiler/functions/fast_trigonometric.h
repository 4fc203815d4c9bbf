// SPDX-License-Identifier: Apache-2.0
// Sine and cosine of the fast tier: one polynomial for half a turn, and half turns taken off in one step and a rest.
// Angles beyond near_angle are those of the default tier.
#pragma once

#include "compiler/functions/trigonometric.h"

namespace isoshade::functions::fast {

/// (-1)^n sin(x - n pi) where the float nearest to x / pi + whole - quarters / 2 tells n, in its last bits: n is
/// whole (quarters = 0, whole even: the sine of x), or half of an odd number (quarters = 1, whole odd: the cosine).
/// |x| <= near_angle.
/// Source: polynomial on a quarter turn by Sollya's fpminimax, absolute error 9e-7; pi in 8 + 24 bits.
template <class F>
F sine_of_half_turn(F x, int quarters) {
  const float whole = quarters == 0 ? 0x1.8p23f : 0x1.8p23f + 1.0f;
  const F turns = quarters == 0 ? x * 0.318309873f : x * 0.318309873f - 0.5f;
  const F marked = turns + whole;
  const F n = quarters == 0 ? marked - whole : (marked - whole) + 0.5f;
  const F r = (x - n * 0x1.92p1f) - n * 0x1.fb5444p-11f;
  const F z = r * r;
  const F sine = (z * polynomial(z, {-0x1.83ce98p-13f, 0x1.106126p-7f, -0x1.55502ap-3f})) * r + r;
  return from_bits_normal(bits_nonnan(sine) ^ shift_left(bits_nonnan(marked), 31));
}

template <class F>
F sine(F x, int quarters) {
  return by_size_of_angle(
      x, [&] { return sine_of_half_turn(x, quarters); },
      [&] { return sine_of(angle_of(reduce_far(x)), quarters); });
}

/// The sine of x in radians.
/// Domain: all floats; infinities and NaN give NaN. -0 gives 0.
/// Error: 9 ULP of 1, 1.1e-6.
template <class F>
F sin(F x) {
  return fast::sine(x, 0);
}

/// The cosine of x in radians.
/// Domain: all floats; infinities and NaN give NaN.
/// Error: 9 ULP of 1, 1.1e-6.
template <class F>
F cos(F x) {
  return fast::sine(x, 1);
}

}  // namespace isoshade::functions::fast
