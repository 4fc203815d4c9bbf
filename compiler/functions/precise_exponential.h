// SPDX-License-Identifier: Apache-2.0
// Powers and logarithms of the precise tier: what is left of rounding is the last rounding.
#pragma once

#include "compiler/functions/comparison.h"
#include "compiler/functions/exponential.h"
#include "compiler/functions/sums.h"

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
/// Source: polynomial by Sollya's fpminimax; log(2) as 11/16 and a rest, so that the product's head is exact.
template <class F>
F exp2(F x) {
  const F above = select(x < -126.0f, F(-126.0f), x);
  const F within = select(above < 128.0f, above, F(127.0f));  // NaN too becomes harmless
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
/// Source: Cody and Waite's reduction by 9 + 24 bits of log(2), the rest kept.
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

/// log2 of a normal positive x, to 2^-40 of it.
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

/// A product p + p_rest as an exponent: 2^(p + p_rest), an infinity from 2^128 on, 0 below 2^-126.
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
/// Domain: all floats, with the default tier's special values: powr's, but that pow(x, 0) = 1 for every x, and
/// pow(1, y) = 1 for every y but NaN. A result below 2^-126 is 0.
/// Error: 0.7 ULP for x in [1e-6, 1e6] and |y| <= 8; 1.6 ULP for |y| <= 64.
template <class F>
F pow(F x, F y) {
  const auto ordinary = (x > 0.0f) & (x < infinity);
  const Sum<F> l = log2_sum(select(ordinary, x, F(1.0f)));
  const F e = min(max(F(-0x1p100f), y), F(0x1p100f));  // so that nothing overflows; not NaN
  const Sum<F> p = two_product(e, l.high);
  const F finite = exp2_of_sum(p.high, p.low + e * l.low);
  const F extreme = select((x > 0.0f) ^ (y < 0.0f), F(infinity), F(0.0f));  // x is 0 or infinite
  const F result = select((x >= 0.0f) & (y == y), select(ordinary, finite, extreme), F(not_a_number));
  return select(y == 0.0f, F(1.0f), result);
}

}  // namespace isoshade::functions::precise
