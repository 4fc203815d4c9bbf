// SPDX-License-Identifier: Apache-2.0
// Inverse square root and vector geometry. Sums run over the components in order.
#pragma once

#include "compiler/functions/comparison.h"

namespace isoshade::functions {

/// 1 / sqrt(x) for normal positive x, without special cases: the kernel of rsqrt and normalize.
/// Source: first step by Moroz et al., "Fast calculation of inverse square root with the use of magic
/// constant", 2018; then a third-order Householder step.
template <class F>
F rsqrt_positive(F x) {
  F y = from_bits_normal(0x5f1ffff9 - shift_right(bits_nonnan(x), 1));
  y = (y * 0.703952253f) * (2.38924456f - (x * y) * y);
  const F error = 1.0f - (x * y) * y;
  return y + y * (error * (error * 0.375f + 0.5f));
}

/// 1 / sqrt(x).
/// Domain: all floats. Zeros give +inf, +inf gives +0, negative numbers and NaN give NaN.
/// Error: 1.5 ULP.
template <class F>
F rsqrt(F x) {
  const auto positive = x > 0.0f;
  const F finite = rsqrt_positive(select(positive & (x < infinity), x, F(1.0f)));
  const F result = select(x < infinity, finite, F(0.0f));
  return select(positive, result, select(x == 0.0f, F(infinity), F(not_a_number)));
}

/// x . y
/// Domain: all floats; sums of products that overflow give infinities or NaN.
/// Error: 2 ULP of the sum of |x_i y_i|.
template <class F, int N>
F dot(vec<F, N> x, vec<F, N> y) {
  F sum = x[0] * y[0];
  for (int i = 1; i < N; ++i) sum = sum + x[i] * y[i];
  return sum;
}

/// x x y, right-handed.
/// Domain: all floats; products that overflow give infinities or NaN.
/// Error: 1.5 ULP of the sum of the two products' magnitudes, in each component.
template <class F>
vec<F, 3> cross(vec<F, 3> x, vec<F, 3> y) {
  const F a = x[1] * y[2] - x[2] * y[1];
  const F b = x[2] * y[0] - x[0] * y[2];
  const F c = x[0] * y[1] - x[1] * y[0];
  return {a, b, c};
}

/// The largest |component|, at least 2^-126. NaN counts as zero.
template <class F, int N>
F largest_magnitude(vec<F, N> v) {
  F largest = max(F(smallest_normal), abs(v[0]));
  for (int i = 1; i < N; ++i) largest = max(largest, abs(v[i]));
  return largest;
}

/// v times the power of two that scales a magnitude with these exponent bits into [2, 4), so that squares neither
/// overflow nor underflow. For an infinite magnitude, the factor is 0.
template <class F, int N>
vec<F, N> scale_to_unity(vec<F, N> v, int_of<F> exponent) {
  return v * splat<N>(from_bits_normal(exponent_bits - exponent));
}

/// v / |v|. Scaling v by a power of two does not change the result.
/// Domain: all floats; a zero vector gives zeros with its signs. Infinite and NaN components give NaN, and the other
/// components are then unspecified.
/// Error: 3 ULP in each component.
template <class F, int N>
vec<F, N> normalize(vec<F, N> v) {
  const auto exponent = bits_nonnan(largest_magnitude(v)) & exponent_bits;
  const vec<F, N> scaled = scale_to_unity(v, exponent);
  const F square = max(F(1.0f), dot(scaled, scaled));  // below 1 only for a zero vector; replaces NaN, too
  return scaled * splat<N>(rsqrt_positive(square));
}

/// |v|, without intermediate overflow or underflow.
/// Domain: all floats. +inf if a component is infinite; NaN if one is NaN.
/// Error: 2 ULP.
template <class F, int N>
F length(vec<F, N> v) {
  const auto exponent = bits_nonnan(min(largest_magnitude(v), F(largest_finite))) & exponent_bits;
  const vec<F, N> scaled = scale_to_unity(v, exponent);
  return (sqrt(dot(scaled, scaled)) * 0.5f) * from_bits_normal(exponent);
}

/// |x - y|
/// Domain: all floats. A difference that overflows gives +inf, NaN gives NaN.
/// Error: 3 ULP.
template <class F, int N>
F distance(vec<F, N> x, vec<F, N> y) {
  return length(x - y);
}

/// Reflects `incident` at the plane with unit normal `normal`: incident - 2 dot(normal, incident) normal.
/// Domain: all floats; products that overflow give infinities or NaN. The normal is not normalised.
/// Error: 4 ULP of |i| + 2 |n| sum |n_j i_j|, in each component.
template <class F, int N>
vec<F, N> reflect(vec<F, N> incident, vec<F, N> normal) {
  return incident - splat<N>(2.0f * dot(normal, incident)) * normal;
}

/// The direction of a refracted ray. `incident` and `normal` are unit vectors; `eta` is the ratio of the indices of
/// refraction, incident side over transmitted side. Total internal reflection gives zeros.
/// Domain: all floats; NaN gives zeros, overflow gives infinities. Errors grow without bound near total reflection.
/// Error: 6 ULP of |eta i| + |n| (eta sum |n_j i_j| + sqrt(k)), in each component, for eta <= 0.9; k is the
/// squared cosine of the refracted ray.
template <class F, int N>
vec<F, N> refract(vec<F, N> incident, vec<F, N> normal, F eta) {
  const F d = dot(normal, incident);
  const F k = 1.0f - (eta * eta) * ((1.0f - d) * (1.0f + d));
  const auto passes = k >= 0.0f;
  const F along_normal = eta * d + sqrt(select(passes, k, F(0.0f)));
  const vec<F, N> refracted = incident * splat<N>(eta) - normal * splat<N>(along_normal);
  return componentwise([&](F component) { return select(passes, component, F(0.0f)); }, refracted);
}

}  // namespace isoshade::functions
