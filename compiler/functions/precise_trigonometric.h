// SPDX-License-Identifier: Apache-2.0
// Sine and cosine of the precise tier: the reduced angle as a sum.
#pragma once

#include "compiler/functions/sums.h"
#include "compiler/functions/trigonometric.h"

namespace isoshade::functions::precise {

/// Splits an angle in radians. Beyond 2^17, infinities and NaN count as 0.
/// Source: as functions::split_angle; polynomials by Sollya's fpminimax.
template <class F>
Angle<F> split_angle(F x) {
  const F within = select(abs(x) <= 0x1p17f, x, F(0.0f));
  const F turns = floor(within * 0.636619747f + 0.5f);
  const F coarse = (within - turns * 0x1.92p0f) - turns * 0x1.fb4p-12f;
  const Sum<F> third = two_sum(coarse, turns * -0x1.444p-24f);
  const Sum<F> r = quick_two_sum(third.high, third.low - turns * 0x1.68c234p-39f);
  const F z = r.high * r.high;
  const F half = z * 0.5f;
  const F sine_rest = sine_excess(z) * r.high + (r.low - r.low * half);
  const F cosine_head = 1.0f - half;
  const F cosine_rest =
      (z * z) * polynomial(z, {0x1.9bc77ap-16f, -0x1.6c129ep-10f, 0x1.555554p-5f}) - r.high * r.low;
  return {to_int(turns), r.high + sine_rest, cosine_head + (((1.0f - cosine_head) - half) + cosine_rest)};
}

/// The sine of x in radians.
/// Domain: |x| <= 8192. To 2^17 = 131072 the error grows to 0.01; beyond, for infinities and for NaN it is 0.
/// Error: 0.97 ULP.
template <class F>
F sin(F x) {
  return sine_of(precise::split_angle(x), 0);
}

/// The cosine of x in radians.
/// Domain: |x| <= 8192. To 2^17 = 131072 the error grows to 0.01; beyond, for infinities and for NaN it is 1.
/// Error: 0.97 ULP.
template <class F>
F cos(F x) {
  return sine_of(precise::split_angle(x), 1);
}

}  // namespace isoshade::functions::precise
