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

/// The sine of r in [-pi/4, pi/4] is r + r * this, z being r * r.
/// Source: polynomials by Sollya's fpminimax.
template <class F>
F sine_excess(F z) {
  return z * polynomial(z, {-0x1.9ab41ap-13f, 0x1.110be6p-7f, -0x1.555552p-3f});
}

/// The cosine of r in [-pi/4, pi/4], z being r * r.
template <class F>
F cosine_of_square(F z) {
  return (z * z) * polynomial(z, {0x1.9bc77ap-16f, -0x1.6c129ep-10f, 0x1.555554p-5f}) + (1.0f - z * 0.5f);
}

/// Splits an angle in radians. Beyond 2^17, infinities and NaN count as 0.
/// Source: Cody and Waite's reduction by pi/2 in four parts, the first three of which give exact products.
template <class F>
Angle<F> split_angle(F x) {
  const F within = select(abs(x) <= 0x1p17f, x, F(0.0f));
  const F turns = floor(within * 0.636619747f + 0.5f);
  const F coarse = (within - turns * 0x1.92p0f) - turns * 0x1.fb4p-12f;
  const F third = turns * 0x1.444p-24f;
  const F r = coarse - third;
  const F r_low = ((coarse - r) - third) - turns * 0x1.68c234p-39f;
  const F z = r * r;
  return {to_int(turns), (sine_excess(z) * r + r_low) + r, cosine_of_square(z)};
}

/// Splits an angle in degrees; quarter turns leave no rest. Beyond 2^22, infinities and NaN count as 0.
template <class F>
Angle<F> split_degrees(F x) {
  const F within = select(abs(x) <= 0x1p22f, x, F(0.0f));
  const F turns = floor(within * 0.0111111114f + 0.5f);
  const F r = (within - turns * 90.0f) * 0.0174532924f;
  const F z = r * r;
  return {to_int(turns), sine_excess(z) * r + r, cosine_of_square(z)};
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

/// v, turned clockwise (from +y to +x) by an angle in degrees. Quarter turns are exact.
/// Domain: all floats. Beyond 2^22 degrees, for infinities and NaN the angle counts as 0.
/// Error: 2.5 ULP of |v.x| + |v.y|, in each component.
template <class F>
vec<F, 2> rotate2d(vec<F, 2> v, F degrees) {
  const Angle<F> angle = split_degrees(degrees);
  const F s = sine_of(angle, 0);
  const F c = sine_of(angle, 1);
  return {v[0] * c + v[1] * s, v[1] * c - v[0] * s};
}

/// Texture coordinates that place a picture: turned clockwise by `degrees` and enlarged by `scale` about `pivot`,
/// then moved by `offset`; ((texcoord - pivot) / scale, rotated) - offset + pivot.
/// Domain: all floats. A zero in `scale` gives infinities or NaN.
/// Error: 4 ULP of the sum of the terms' magnitudes, in each component.
template <class F>
vec<F, 2> place2d(vec<F, 2> texcoord, vec<F, 2> pivot, vec<F, 2> scale, F degrees, vec<F, 2> offset) {
  return (rotate2d((texcoord - pivot) / scale, degrees) - offset) + pivot;
}

}  // namespace isoshade::functions
