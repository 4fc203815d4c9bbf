// SPDX-License-Identifier: Apache-2.0
// Sine and cosine of the precise tier: the reduced angle as a sum.
#pragma once

#include "compiler/functions/trigonometric.h"

namespace isoshade::functions::precise {

/// Reduces an angle in radians, |x| <= near_angle.
/// Source: as functions::reduce_near.
template <class F>
Reduced<F> reduce_near(F x) {
  const F turns = floor(x * 0.636619747f + 0.5f);
  const F coarse = (x - turns * 0x1.92p0f) - turns * 0x1.fb4p-12f;
  const Sum<F> third = two_sum(coarse, turns * -0x1.444p-24f);
  const Sum<F> r = quick_two_sum(third.high, third.low - turns * 0x1.68c234p-39f);
  return {to_int(turns), r.high, r.low};
}

/// Source: polynomials by Sollya's fpminimax.
template <class F>
Angle<F> angle_of(const Reduced<F>& reduced) {
  const F r = reduced.r;
  const F r_low = reduced.r_low;
  const F z = r * r;
  const F half = z * 0.5f;
  const F sine_rest = sine_excess(z) * r + (r_low - r_low * half);
  const F cosine_head = 1.0f - half;
  const F cosine_rest =
      (z * z) * polynomial(z, {0x1.9bc77ap-16f, -0x1.6c129ep-10f, 0x1.555554p-5f}) - r * r_low;
  return {reduced.quadrant, r + sine_rest, cosine_head + (((1.0f - cosine_head) - half) + cosine_rest)};
}

template <class F>
F sine(F x, int quarters) {
  return by_size_of_angle(
      x, [&] { return sine_of(precise::angle_of(precise::reduce_near(x)), quarters); },
      [&] { return sine_of(precise::angle_of(reduce_far(x)), quarters); });
}

/// The sine of x in radians.
/// Domain: all floats; infinities and NaN give NaN.
/// Error: 0.97 ULP.
template <class F>
F sin(F x) {
  return precise::sine(x, 0);
}

/// The cosine of x in radians.
/// Domain: all floats; infinities and NaN give NaN.
/// Error: 0.97 ULP.
template <class F>
F cos(F x) {
  return precise::sine(x, 1);
}

}  // namespace isoshade::functions::precise
