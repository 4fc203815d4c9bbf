// SPDX-License-Identifier: Apache-2.0
// From one value to another.
#pragma once

#include "compiler/functions/comparison.h"

namespace isoshade::functions {

/// a * (1 - t) + b * t: exactly `a` at t = 0 and exactly `b` at t = 1.
/// Domain: all floats; t outside [0, 1] extrapolates. An infinite end gives NaN at the other.
/// Error: 2 ULP of |a * (1 - t)| + |b * t|.
template <class F>
F mix(F a, F b, F t) {
  return a * (1.0f - t) + b * t;
}

/// 0 up to `low`, 1 from `high` on, 3t^2 - 2t^3 between. With low > high it falls instead.
/// Domain: all floats. Equal edges make a step: 0 up to the edge, 1 above. NaN gives 0; so do edges whose
/// difference overflows.
/// Error: 6 ULP.
template <class F>
F smoothstep(F low, F high, F x) {
  const F t = saturate((x - low) / (high - low));
  return (t * t) * (3.0f - 2.0f * t);
}

/// From the range [in_low, in_high] to [out_low, out_high]: exactly `out_low` at in_low, `out_high` at in_high.
/// Domain: all floats; x outside the range extrapolates. An empty range gives infinities or NaN.
/// Error: 3 ULP of |out_low| + |out_high| for x between in_low and in_high.
template <class F>
F remap(F x, F in_low, F in_high, F out_low, F out_high) {
  return mix(out_low, out_high, (x - in_low) / (in_high - in_low));
}

/// (x - pivot) * amount + pivot: farther from `pivot` for an amount above 1, nearer to it below.
/// Domain: all floats.
/// Error: 2 ULP of |(x - pivot) * amount| + |pivot|.
template <class F>
F contrast(F x, F amount, F pivot) {
  return (x - pivot) * amount + pivot;
}

}  // namespace isoshade::functions
