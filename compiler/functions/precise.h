// SPDX-License-Identifier: Apache-2.0
// The bodies of the precise tier: intermediate results are sums of two floats (sums.h), so that little more than the
// final rounding remains.
#pragma once

#include "compiler/functions/comparison.h"
#include "compiler/functions/exponential.h"
#include "compiler/functions/sums.h"
#include "compiler/functions/trigonometric.h"
#include "compiler/functions/vector.h"

namespace isoshade::functions::precise {

/// (e^(r + r_rest) - 1) + 1 for |r| <= 0.35, as a sum.
/// Source: polynomial by Sollya's fpminimax.
template <class F>
Sum<F> exp_sum(F r, F r_rest) {
  const F q = polynomial(r, {0x1.6d4bfcp-10f, 0x1.120c06p-7f, 0x1.5554eap-5f, 0x1.5554dcp-3f, 0.5f});
  const Sum<F> linear = quick_two_sum(F(1.0f), r);
  return quick_two_sum(linear.high, linear.low + ((r_rest * r + r_rest) + (r * r) * q));
}

/// 2^(f + f_rest) for f in [-0.5, 0.5], as a sum. f_rest is at most a few ULP of 128.
/// Source: polynomial by Sollya's fpminimax; log(2) in 24 + 24 bits.
template <class F>
Sum<F> exp2_sum(F f, F f_rest) {
  const F q = polynomial(
      f, {0x1.e5b5b4p-17f, 0x1.44227cp-13f, 0x1.5da0f6p-10f, 0x1.3b2a4ap-7f, 0x1.c6b072p-5f, 0x1.ebfbep-3f});
  const Sum<F> p = two_product_by(f, 0x1.62e43p-1f);
  const Sum<F> linear = quick_two_sum(F(1.0f), p.high);
  const Sum<F> sum = quick_two_sum(linear.high, q * (f * f));
  const F rest = p.low + (f * -0x1.05c61p-29f + (f_rest * 0x1.62e43p-1f) * sum.high);
  return {sum.high, sum.low + (linear.low + rest)};
}

/// 2^x.
/// Domain: all floats; x >= 128 gives +inf, x < -126 gives 0, NaN gives NaN.
/// Error: 0.65 ULP.
/// Source: polynomial by Sollya's fpminimax; log(2) is split into 11/16 and a rest, so that the product with the head
/// is exact.
template <class F>
F exp2(F x) {
  const F above = select(x < -126.0f, F(-126.0f), x);
  const F within = select(above < 128.0f, above, F(127.0f));  // replaces NaN, too
  const F n = floor(within + 0.5f);
  const F f = within - n;
  const F q = polynomial(
      f, {0x1.3fa206p-13f, 0x1.5f0b82p-10f, 0x1.3b30ap-7f, 0x1.c6af76p-5f, 0x1.ebfbd8p-3f, 0x1.7217f8p-8f});
  const F f_head = head(f);
  const Sum<F> sum = quick_two_sum(F(1.0f), f_head * 0.6875f);
  const F rest = q * f + (f - f_head) * 0.6875f;
  const F power = scale_by_power_of_two(sum.high + (sum.low + rest), n);
  const F finite = select(x < -126.0f, F(0.0f), power);
  return select(x < 128.0f, finite, x + infinity);
}

/// e^x.
/// Domain: all floats; x > 88.7228317 gives +inf, x < -87.3365402 gives 0, NaN gives NaN.
/// Error: 0.68 ULP.
/// Source: Cody and Waite's reduction by 9 + 24 bits of log(2), keeping the rounding error.
template <class F>
F exp(F x) {
  constexpr float lowest = -87.3365402f;
  constexpr float highest = 88.7228317f;
  const F above = select(x < lowest, F(lowest), x);
  const F within = select(above <= highest, above, F(highest));
  const F n = floor(within * 1.44269502f + 0.5f);
  const F coarse = within - n * 0.693359375f;
  const Sum<F> step = two_product_by(n, -2.12194442e-4f);
  const Sum<F> r = two_sum(coarse, negate(step.high));
  const Sum<F> sum = exp_sum(r.high, r.low - step.low);
  const F power = scale_by_power_of_two(sum.high + sum.low, n);
  const F finite = select(x < lowest, F(0.0f), power);
  return select(x <= highest, finite, x + infinity);
}

/// log2 of a normal positive x, relative error 2^-40.
/// Source: log(1 + f) = f - f^2/2 + f^3 Q(f), the first two terms exact; Q by Sollya's fpminimax.
template <class F>
Sum<F> log2_sum(F x) {
  constexpr int two_thirds_bits = 0x3f2aaaab;
  const auto offset = bits_nonnan(x) - two_thirds_bits;
  const F f = from_bits_normal((offset & fraction_mask) + two_thirds_bits) - 1.0f;
  const F exponent = to_float(shift_right_signed(offset, 23));
  const F q =
      polynomial(f, {-0x1.caff72p-4f, 0x1.e0e4bap-4f, -0x1.8a6584p-4f, 0x1.bb3e26p-4f, -0x1.006bfcp-3f,
                     0x1.24d702p-3f, -0x1.5552e2p-3f, 0x1.999868p-3f, -0x1.000002p-2f, 0x1.555556p-2f});
  const Sum<F> square = two_square(f);
  const F half = square.high * 0.5f;
  const F high = f - half;
  const F low = ((f - high) - half) - square.low * 0.5f;
  const Sum<F> s = quick_two_sum(high, (square.high * f) * q);
  const F s_low = s.low + low;
  const Sum<F> product = two_product_by(s.high, 0x1.715476p0f);
  const F rest = product.low + (s.high * 0x1.4ae0cp-26f + s_low * 0x1.715476p0f);
  const Sum<F> sum = quick_two_sum(exponent, product.high);
  return quick_two_sum(sum.high, sum.low + rest);
}

/// 2^(p + p_rest); results from 2^128 are infinite, results below 2^-126 are 0.
template <class F>
F exp2_of_sum(F p, F p_rest) {
  const F within = min(max(p, F(-127.0f)), F(128.0f));
  const F n = floor(within + 0.5f);
  const Sum<F> sum = exp2_sum(within - n, select(within == p, p_rest, F(0.0f)));
  const auto power = bits_nonnan(sum.high + sum.low) + shift_left(to_int(n), 23);
  const auto below_infinity = select(power < exponent_bits, power, int_of<F>(exponent_bits));
  return from_bits_normal(select(power < implicit_bit, int_of<F>(0), below_infinity));
}

/// x^y for x >= 0.
/// Domain: all floats, with the special values of the default tier: those of IEEE-754's powr, except that pow(x, 0) = 1
/// for every x, and pow(1, y) = 1 for every y but NaN. Results below 2^-126 are 0.
/// Error: 0.7 ULP for x in [1e-6, 1e6] and |y| <= 8; 1.6 ULP for |y| <= 64.
template <class F>
F pow(F x, F y) {
  const auto ordinary = (x > 0.0f) & (x < infinity);
  const Sum<F> l = log2_sum(select(ordinary, x, F(1.0f)));
  const F e = min(max(F(-0x1p100f), y), F(0x1p100f));  // avoids overflow; never NaN
  const Sum<F> p = two_product(e, l.high);
  const F finite = exp2_of_sum(p.high, p.low + e * l.low);
  const F extreme = select((x > 0.0f) ^ (y < 0.0f), F(infinity), F(0.0f));  // x is 0 or infinite
  const F result = select((x >= 0.0f) & (y == y), select(ordinary, finite, extreme), F(not_a_number));
  return select(y == 0.0f, F(1.0f), result);
}

/// Linear light to sRGB.
/// Domain: all floats; negative values and NaN give 0, values above 1 give 1. Exact at 0 and 1. Monotonic.
/// Error: 0.7 ULP, but 4 ULP within 8 ULP of 0.0031308: the standard's curve falls by 8 ULP where its pieces meet, and
/// here both pieces are clamped to the middle of the gap.
template <class F>
F srgb_encode(F x) {
  constexpr float joint = 0x1.4b5da4p-5f;
  // 1.055 x^(1/2.4) - 0.055, with constants of 24 + 24 bits
  const F within = min(max(F(1e-3f), x), F(1.0f));
  const Sum<F> l = log2_sum(within);
  const Sum<F> p = two_product_by(l.high, 0x1.aaaaaap-2f);
  const F p_rest = p.low + (l.low * 0x1.aaaaaap-2f + l.high * 0x1.555556p-27f);
  const F n = floor(p.high + 0.5f);
  const Sum<F> root = exp2_sum(p.high - n, p_rest);
  const F scale = from_bits_normal(shift_left(to_int(n) + 127, 23));
  const F high = root.high * scale;
  const F low = root.low * scale;
  const Sum<F> product = two_product_by(high, 0x1.0e147ap0f);
  const Sum<F> sum = two_sum(product.high, F(-0x1.c28f5cp-5f));
  const F rest = product.low + ((low * 0x1.0e147ap0f + high * 0x1.c28f5cp-25f) + -0x1.47ae14p-32f);
  const F curve = sum.high + (sum.low + rest);

  const F value = select(x <= 0.0031308f, min(x * 12.92f, F(joint)), max(curve, F(joint)));
  const F below_one = select(x < 1.0f, min(value, F(1.0f)), F(1.0f));
  return select(x > 0.0f, below_one, F(0.0f));
}

/// sRGB to linear light.
/// Domain: all floats; negative values and NaN give 0, values above 1 give 1. Exact at 0 and 1. Monotonic.
/// Error: 0.7 ULP.
template <class F>
F srgb_decode(F x) {
  const F within = min(max(F(0.04f), x), F(1.0f));
  // ((x + 0.055) / 1.055)^2.4, with constants of 24 + 24 bits
  const Sum<F> scaled = two_product_by(within, 0x1.e54edcp-1f);
  const Sum<F> shifted = two_sum(scaled.high, F(0x1.ab1232p-5f));
  const Sum<F> t =
      quick_two_sum(shifted.high, shifted.low + (scaled.low + (within * 0x1.a15d6cp-26f + 0x1.ea294p-30f)));
  const Sum<F> l = log2_sum(t.high);
  const F l_rest = l.low + (t.low / t.high) * 0x1.715476p0f;
  const Sum<F> p = two_product_by(l.high, 0x1.333334p1f);
  const F curve = exp2_of_sum(p.high, p.low + (l_rest * 0x1.333334p1f + l.high * -0x1.99999ap-24f));

  const F value = select(x <= 0.04045f, x * 0x1.3d0722p-4f, curve);
  const F below_one = select(x < 1.0f, min(value, F(1.0f)), F(1.0f));
  return select(x > 0.0f, below_one, F(0.0f));
}

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

/// 1 / sqrt(s) for s in [1, 64] as y (1 + rest / 2): an approximation y and a Newton step with rest = 1 - s y^2.
template <class F>
struct InverseRoot {
  F y;
  F rest;
};
template <class F>
InverseRoot<F> inverse_root(F s) {
  const F y = rsqrt_positive(s);
  const Sum<F> square = two_square(y);
  const Sum<F> product = two_product(s, square.high);
  return {y, ((1.0f - product.high) - product.low) - s * square.low};
}

/// 1 / sqrt(x).
/// Domain: all floats. Zeros give +inf, +inf gives +0, negative numbers and NaN give NaN.
/// Error: 0.51 ULP.
template <class F>
F rsqrt(F x) {
  const auto positive = x > 0.0f;
  const auto bits = bits_nonnan(select(positive & (x < infinity), x, F(1.0f)));
  const auto exponent = shift_right(bits, 23) - 127;
  const auto odd = exponent & 1;
  const F within = from_bits_normal((bits & fraction_mask) | shift_left(odd + 127, 23));  // in [1, 4)
  const InverseRoot<F> root = inverse_root(within);
  const F scale = from_bits_normal(shift_left(127 - shift_right_signed(exponent, 1), 23));
  const F result = select(x < infinity, (root.y + root.y * (root.rest * 0.5f)) * scale, F(0.0f));
  return select(positive, result, select(x == 0.0f, F(infinity), F(not_a_number)));
}

/// The sum of the squares.
template <class F, int N>
Sum<F> square_sum(vec<F, N> v) {
  Sum<F> sum = two_square(v[0]);
  for (int i = 1; i < N; ++i) {
    const Sum<F> square = two_square(v[i]);
    const Sum<F> both = two_sum(sum.high, square.high);
    sum = quick_two_sum(both.high, both.low + (sum.low + square.low));
  }
  return sum;
}

/// v / |v|. Scaling v by a power of two does not change the result.
/// Domain: all floats; a zero vector gives zeros with its signs. Infinite and NaN components give NaN, and the other
/// components are then unspecified.
/// Error: 0.51 ULP in each component.
template <class F, int N>
vec<F, N> normalize(vec<F, N> v) {
  const auto exponent = bits_nonnan(largest_magnitude(v)) & exponent_bits;
  const vec<F, N> scaled = scale_to_unity(v, exponent);
  const vec<F, N> harmless = componentwise([](F c) { return select(abs(c) <= 4.0f, c, F(1.0f)); }, scaled);
  const Sum<F> sum = square_sum(harmless);
  const InverseRoot<F> root = inverse_root(max(F(1.0f), sum.high));
  const F rest = (root.rest - sum.low * (root.y * root.y)) * 0.5f;
  return componentwise(
      [&](F c, F original) {
        const auto tiny = abs(c) < 0x1p-60f;  // unscaled, two_product would underflow
        const Sum<F> product = two_product(select(tiny, c * 0x1p60f, c), root.y);
        const F unit = product.high + (product.low + product.high * rest);
        const F component = select(tiny, unit * 0x1p-60f, unit);
        return select(original == 0.0f, original, component + (original - original));
      },
      harmless, scaled);
}

/// |v|, without intermediate overflow or underflow.
/// Domain: all floats. +inf if a component is infinite; NaN if one is NaN.
/// Error: 0.51 ULP.
template <class F, int N>
F length(vec<F, N> v) {
  const auto exponent = bits_nonnan(min(largest_magnitude(v), F(largest_finite))) & exponent_bits;
  const vec<F, N> scaled = scale_to_unity(v, exponent);
  const F plain = dot(scaled, scaled);
  const vec<F, N> harmless = componentwise([](F c) { return select(abs(c) <= 4.0f, c, F(1.0f)); }, scaled);
  const Sum<F> sum = square_sum(harmless);
  const F root = sqrt(sum.high);
  const Sum<F> square = two_square(root);
  const F rest = ((sum.high - square.high) - square.low) + sum.low;
  const F exact = root + (rest * 0.5f) / max(root, F(1.0f));
  const F within = select(plain < infinity, exact, plain);
  return (within * 0.5f) * from_bits_normal(exponent);
}

}  // namespace isoshade::functions::precise
