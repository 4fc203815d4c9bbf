// SPDX-License-Identifier: Apache-2.0
// The bodies of the fast tier: shorter polynomials, and arguments clamped to their domain instead of special results.
#pragma once

#include "compiler/functions/comparison.h"
#include "compiler/functions/exponential.h"
#include "compiler/functions/logarithm.h"
#include "compiler/functions/trigonometric.h"
#include "compiler/functions/vector.h"

namespace isoshade::functions::fast {

/// 2^x.
/// Domain: [-126, 127.9999]; smaller arguments and NaN give 2^-126, larger ones 2^127.9999.
/// Error: 90 ULP, relative error 7.5e-6. Integer arguments are exact.
/// Source: polynomial of degree 4 by Sollya's fpminimax.
template <class F>
F exp2(F x) {
  const F within = min(max(F(-126.0f), x), F(127.9999f));
  const F n = floor(within + 0.5f);
  const F f = within - n;
  const F q = polynomial(f, {0x1.3d106cp-7f, 0x1.c96d34p-5f, 0x1.ebf958p-3f, 0x1.62e2d2p-1f});
  return scale_by_power_of_two(f * q + 1.0f, n);
}

/// e^x.
/// Domain: [-87.33654, 88.72276]; smaller arguments and NaN give 2^-126, larger ones 2^127.9999.
/// Error: 135 ULP, relative error 1.5e-5.
template <class F>
F exp(F x) {
  return exp2(x * 1.44269502f);
}

/// log2(x) of a normal positive number; +inf counts as 2^128.
/// Source: polynomial by Sollya's fpminimax.
template <class F>
F log2_of_positive(F x) {
  const Binary<F> b = split_binary(x);
  const F q = polynomial(b.rest, {0x1.5f6f62p-3f, -0x1.13c69cp-2f, 0x1.2ecd1p-2f, -0x1.6fff66p-2f,
                                  0x1.ec295ap-2f, -0x1.71569p-1f, 0x1.71548ep0f});
  return b.rest * q + b.exponent;
}

/// The base-2 logarithm.
/// Domain: all floats. Zeros, negative numbers and NaN count as 2^-126, +inf as 2^128.
/// Error: 19 ULP. Powers of two are exact.
template <class F>
F log2(F x) {
  return log2_of_positive(max(F(smallest_normal), x));
}

/// The natural logarithm.
/// Domain: all floats. Zeros, negative numbers and NaN count as 2^-126, +inf as 2^128.
/// Error: 19 ULP.
template <class F>
F log(F x) {
  return log2(x) * 0.693147182f;
}

/// x^y for x >= 0.
/// Domain: results in [2^-126, 2^127.9999]; other results are clamped, so 0 to a positive power is tiny but not 0. A
/// zero, negative or NaN `x` counts as 2^-126; a NaN `y` gives 2^-126. pow(x, 0) and pow(1, y) are 1.
/// Error: 250 ULP, relative error 3e-5, for x in [1e-4, 1e4] and |y| <= 8.
template <class F>
F pow(F x, F y) {
  return exp2(log2(x) * y);
}

/// Linear light to sRGB.
/// Domain: all floats; negative values and NaN give 0, values above 1 give 1. Exact at 0 and 1. Monotonic.
/// Error: 115 ULP, relative error 7e-6.
/// Source: one polynomial in the fourth root, taken from the lower end of the curve, by Sollya's fpminimax.
template <class F>
F srgb_encode(F x) {
  constexpr float joint = 0x1.4b5da4p-5f;
  const F curve = polynomial(sqrt(sqrt(x)) - 0x1.e4p-3f,
                             {0x1.85f5c2p-4f, -0x1.1e6a86p-2f, 0x1.894b7ep-2f, -0x1.a1c73cp-2f,
                              0x1.e3eaf2p-1f, 0x1.58298ep-1f, 0x1.4a2b3p-5f});
  const F within = select(x <= 0.0031308f, min(x * 12.92f, F(joint)), max(curve, F(joint)));
  const F below_one = select(x < 1.0f, min(within, F(1.0f)), F(1.0f));
  return select(x > 0.0f, below_one, F(0.0f));
}

/// sRGB to linear light.
/// Domain: all floats; negative values and NaN give 0, values above 1 give 1. Exact at 0 and 1. Monotonic.
/// Error: 35 ULP, relative error 2e-6.
/// Source: polynomial in sqrt(x + 0.055), whose power of 4.8 is the curve, by Sollya's fpminimax.
template <class F>
F srgb_decode(F x) {
  const F curve =
      polynomial(sqrt(x + 0.055f) - 0x1.3cp-2f, {-0x1.1c797cp-5f, 0x1.51ca2p-1f, 0x1.5260dep0f, 0x1.cd365p-1f,
                                                 0x1.3166e2p-2f, 0x1.8cb80ap-5f, 0x1.9818b6p-9f});
  const F within = select(x <= 0.04045f, x * 0x1.3d0722p-4f, max(curve, F(0x1.9a5c62p-9f)));
  const F below_one = select(x < 1.0f, min(within, F(1.0f)), F(1.0f));
  return select(x > 0.0f, below_one, F(0.0f));
}

/// The sine (quarters = 0) or cosine (quarters = 1) of x, |x| <= near_angle, as +-sin(x - n pi), where n is the integer
/// (sine) or half-integer (cosine) nearest to x / pi. Adding `whole` rounds to an integer whose lowest bit is the sign;
/// `whole` is odd for the cosine, which flips it.
/// Source: polynomial on a quarter turn by Sollya's fpminimax, absolute error 9e-7; pi in 8 + 24 bits. Half turns are
/// subtracted in one step and a rest.
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

/// 1 / sqrt(x).
/// Domain: [2^-126, 2^128). Zeros, negative numbers and NaN count as 2^-126, +inf as the largest float.
/// Error: 9 ULP.
/// Source: first step by Moroz et al., as in functions::rsqrt; then a Newton step with its error centred.
template <class F>
F rsqrt(F x) {
  const F within = min(max(F(smallest_normal), x), F(largest_finite));
  F y = from_bits_normal(0x5f1ffff9 - shift_right(bits_nonnan(within), 1));
  y = (y * 0.703952253f) * (2.38924456f - (within * y) * y);
  return y * (1.50000036f - ((within * y) * y) * 0.5f);
}

/// v / |v|.
/// Domain: lengths in [2^-62, 2^63]; squares may overflow and underflow. Shorter vectors give a shorter result with the
/// same direction, zeros give zeros; longer ones lose their direction. Infinite and NaN components give NaN.
/// Error: 10 ULP in each component.
template <class F, int N>
vec<F, N> normalize(vec<F, N> v) {
  return v * splat<N>(rsqrt(dot(v, v)));
}

/// |v|.
/// Domain: lengths in [2^-62, 2^63]; shorter vectors may give 0, longer ones +inf. NaN if a component is NaN.
/// Error: 2 ULP.
template <class F, int N>
F length(vec<F, N> v) {
  return sqrt(dot(v, v));
}

}  // namespace isoshade::functions::fast
