// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/functions/body.h"

namespace isoshade::functions {

/// An angle as a quadrant and a rest in [-pi/4, pi/4], of which these are sine and cosine.
template <class F>
struct Angle {
  int_of<F> quadrant;
  F sine;
  F cosine;
};

/// Splits an angle in radians. Beyond 2^17, infinities and NaN count as 0.
/// Source: Cody and Waite's reduction by pi/2 in four parts, the first three of which give exact products;
/// polynomials by Sollya's fpminimax.
template <class F>
Angle<F> split_angle(F x) {
  const F within = select(abs(x) <= 0x1p17f, x, F(0.0f));
  const F turns = floor(within * 0.636619747f + 0.5f);
  const F coarse = (within - turns * 0x1.92p0f) - turns * 0x1.fb4p-12f;
  const F third = turns * 0x1.444p-24f;
  const F r = coarse - third;
  const F r_low = ((coarse - r) - third) - turns * 0x1.68c234p-39f;
  const F z = r * r;
  const F sine = ((z * polynomial(z, {-0x1.9ab41ap-13f, 0x1.110be6p-7f, -0x1.555552p-3f})) * r + r_low) + r;
  const F cosine =
      (z * z) * polynomial(z, {0x1.9bc77ap-16f, -0x1.6c129ep-10f, 0x1.555554p-5f}) + (1.0f - z * 0.5f);
  return {to_int(turns), sine, cosine};
}

/// Sine (quarters = 0) or cosine (quarters = 1).
template <class F>
F sine_of(const Angle<F>& angle, int quarters) {
  const auto q = quarters == 0 ? angle.quadrant : angle.quadrant + quarters;
  const F magnitude = select((q & 1) == 0, angle.sine, angle.cosine);
  return from_bits_normal(bits_nonnan(magnitude) ^ shift_left(q & 2, 30));
}

/// The sine of x in radians.
/// Domain: |x| <= 8192. To 2^17 = 131072 the error grows to 0.01; beyond, for infinities and for NaN it is 0.
/// Error: 1.75 ULP.
template <class F>
F sin(F x) {
  return sine_of(split_angle(x), 0);
}

/// The cosine of x in radians.
/// Domain: |x| <= 8192. To 2^17 = 131072 the error grows to 0.01; beyond, for infinities and for NaN it is 1.
/// Error: 1.75 ULP.
template <class F>
F cos(F x) {
  return sine_of(split_angle(x), 1);
}

/// The tangent of x in radians.
/// Domain: |x| <= 8192. To 2^17 = 131072 less exact; beyond, for infinities and for NaN it is 0.
/// Error: 3.5 ULP.
template <class F>
F tan(F x) {
  const Angle<F> angle = split_angle(x);
  const auto even = (angle.quadrant & 1) == 0;
  return select(even, angle.sine, negate(angle.cosine)) / select(even, angle.cosine, angle.sine);
}

}  // namespace isoshade::functions
