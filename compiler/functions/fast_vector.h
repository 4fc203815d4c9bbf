// SPDX-License-Identifier: Apache-2.0
// Roots and lengths of the fast tier: squares may overflow and underflow.
#pragma once

#include "compiler/functions/comparison.h"
#include "compiler/functions/vector.h"

namespace isoshade::functions::fast {

/// 1 / sqrt(x).
/// Domain: [2^-126, 2^128). Zeros, negative numbers and NaN count as 2^-126, +inf as the largest float.
/// Error: 9 ULP.
/// Source: first step by Moroz et al., as in functions::rsqrt; then one of Newton's, centred.
template <class F>
F rsqrt(F x) {
  const F within = min(max(F(smallest_normal), x), F(largest_finite));
  F y = from_bits_normal(0x5f1ffff9 - shift_right(bits_nonnan(within), 1));
  y = (y * 0.703952253f) * (2.38924456f - (within * y) * y);
  return y * (1.50000036f - ((within * y) * y) * 0.5f);
}

/// v / |v|.
/// Domain: lengths in [2^-62, 2^63]: shorter vectors keep their direction and get shorter than 1, zeros give zeros;
/// longer ones lose it. Infinite and NaN components give NaN.
/// Error: 10 ULP in each component.
template <class F, int N>
vec<F, N> normalize(vec<F, N> v) {
  return v * splat<N>(rsqrt(dot(v, v)));
}

/// |v|.
/// Domain: lengths in [2^-62, 2^63]: shorter vectors may give 0, longer ones +inf. NaN where a component is NaN.
/// Error: 2 ULP.
template <class F, int N>
F length(vec<F, N> v) {
  return sqrt(dot(v, v));
}

}  // namespace isoshade::functions::fast
