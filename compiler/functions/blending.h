// SPDX-License-Identifier: Apache-2.0
// Interpolation and averages, and what a transparent colour makes of the colour behind it.
#pragma once

#include "compiler/functions/comparison.h"

namespace isoshade::functions {

/// a * (1 - t) + b * t: exactly `a` at t = 0 and exactly `b` at t = 1.
/// Domain: all floats; t outside [0, 1] extrapolates. NaN at one end if the other end is infinite; overflow may give
/// NaN, too.
/// Error: 2 ULP of |a * (1 - t)| + |b * t|.
template <class F>
F mix(F a, F b, F t) {
  return a * (1.0f - t) + b * t;
}

/// 0 for x <= low, 1 for x >= high, 3t^2 - 2t^3 in between.
/// Domain: all floats. If `low` is above `high`, falls from 1 to 0. Equal edges give a step: 0 up to the edge, 1
/// above it. NaN gives 0, and so does a difference of the edges that overflows.
/// Error: 6 ULP.
template <class F>
F smoothstep(F low, F high, F x) {
  const F t = saturate((x - low) / (high - low));
  return (t * t) * (3.0f - 2.0f * t);
}

/// Maps [in_low, in_high] linearly to [out_low, out_high]: exactly `out_low` at in_low, `out_high` at in_high.
/// Domain: all floats; values outside the range extrapolate. An empty input range gives `out_low`. Overflow gives
/// infinities or NaN.
/// Error: 3 ULP of |out_low| + |out_high| for x between in_low and in_high.
template <class F>
F remap(F x, F in_low, F in_high, F out_low, F out_high) {
  const F range = in_high - in_low;
  const auto empty = range == 0.0f;
  const F share = (x - in_low) / select(empty, F(1.0f), range);
  return mix(out_low, out_high, select(empty, F(0.0f), share));
}

/// (x - pivot) * amount + pivot: an amount above 1 increases the distance from `pivot`, one below 1 decreases it.
/// Domain: all floats. Overflow gives infinities; NaN and infinities that cancel give NaN.
/// Error: 2 ULP of |(x - pivot) * amount| + |pivot|.
template <class F>
F contrast(F x, F amount, F pivot) {
  return (x - pivot) * amount + pivot;
}

/// The mean of a 2 x 2 block of samples in row order, which reduces supersampled images.
/// Domain: all floats; finite samples have a finite mean. Infinities and NaN propagate; magnitudes below 2^-124 count
/// as 0.
/// Error: 2^-23 of the mean of the magnitudes: the quarters are exact, and each result has two rounded sums.
template <class F>
F mean_of_four(F a, F b, F c, F d) {
  const F quarter(0.25f);
  return (a * quarter + b * quarter) + (c * quarter + d * quarter);
}

// What a source with the color c and the alpha a makes of a backdrop with the color d and the alpha b: the ways to blend
// of interface::Blend. The rgb of a picture counts as multiplied by its alpha.

/// (c + d (1 - a), a + b (1 - a)), of a source whose color is multiplied by its alpha already.
/// Domain: all floats. At a = 1 exactly the source, at c = 0 and a = 0 exactly the backdrop, if both are finite.
template <class F>
vec<F, 4> blend_premultiplied(vec<F, 4> source, vec<F, 4> backdrop) {
  return source + backdrop * splat<4>(1.0f - source[3]);
}

/// (c a + d (1 - a), a + b (1 - a)).
/// Domain: all floats. At a = 1 exactly the source, at a = 0 exactly the backdrop, if both are finite.
template <class F>
vec<F, 4> blend_over(vec<F, 4> source, vec<F, 4> backdrop) {
  const F a = source[3];
  return blend_premultiplied(vec<F, 4>(source[0] * a, source[1] * a, source[2] * a, a), backdrop);
}

/// (d + c a, b): light is added, and what was covered stays covered.
/// Domain: all floats.
template <class F>
vec<F, 4> blend_add(vec<F, 4> source, vec<F, 4> backdrop) {
  const auto added = [&](int i) { return backdrop[i] + source[i] * source[3]; };
  return {added(0), added(1), added(2), backdrop[3]};
}

/// (d (c a + (1 - a)), b): light is filtered, and what was covered stays covered.
/// Domain: all floats.
template <class F>
vec<F, 4> blend_multiply(vec<F, 4> source, vec<F, 4> backdrop) {
  const F through = 1.0f - source[3];
  const auto filtered = [&](int i) { return backdrop[i] * (source[i] * source[3] + through); };
  return {filtered(0), filtered(1), filtered(2), backdrop[3]};
}

}  // namespace isoshade::functions
