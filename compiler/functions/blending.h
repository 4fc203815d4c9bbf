// SPDX-License-Identifier: Apache-2.0
// From one value to another.
#pragma once

#include "compiler/functions/comparison.h"

namespace isoshade::functions {

/// a * (1 - t) + b * t: exactly `a` at t = 0 and exactly `b` at t = 1.
/// Domain: all floats; a share outside [0, 1] extrapolates. An infinite end gives NaN at the other, as overflow may.
/// Error: 2 ULP of |a * (1 - t)| + |b * t|.
template <class F>
F mix(F a, F b, F t) {
  return a * (1.0f - t) + b * t;
}

/// 0 up to `low`, 1 from `high` on, 3t^2 - 2t^3 between.
/// Domain: all floats. With `low` above `high` it falls from 1 to 0. Equal edges make a step: 0 up to the edge, 1
/// above. NaN gives 0; so do edges whose difference overflows.
/// Error: 6 ULP.
template <class F>
F smoothstep(F low, F high, F x) {
  const F t = saturate((x - low) / (high - low));
  return (t * t) * (3.0f - 2.0f * t);
}

/// From the range [in_low, in_high] to [out_low, out_high]: exactly `out_low` at in_low, `out_high` at in_high.
/// Domain: all floats; values outside the range extrapolate. An empty range gives the lower end of the other. What
/// overflows is infinite or NaN.
/// Error: 3 ULP of |out_low| + |out_high| for x between in_low and in_high.
template <class F>
F remap(F x, F in_low, F in_high, F out_low, F out_high) {
  const F range = in_high - in_low;
  const auto empty = range == 0.0f;
  const F share = (x - in_low) / select(empty, F(1.0f), range);
  return mix(out_low, out_high, select(empty, F(0.0f), share));
}

/// (x - pivot) * amount + pivot: farther from `pivot` for an amount above 1, nearer to it below.
/// Domain: all floats. What overflows is infinite; infinities that cancel and NaN give NaN.
/// Error: 2 ULP of |(x - pivot) * amount| + |pivot|.
template <class F>
F contrast(F x, F amount, F pivot) {
  return (x - pivot) * amount + pivot;
}

}  // namespace isoshade::functions
