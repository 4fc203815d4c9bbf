// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/functions/body.h"

namespace isoshade::functions {

/// x = 2^exponent * (1 + rest), rest in [sqrt(1/2) - 1, sqrt(2) - 1).
template <class F>
struct Binary {
  F exponent;
  F rest;
};

/// Splits a normal positive x.
template <class F>
Binary<F> split_binary(F x) {
  constexpr int sqrt_half_bits = 0x3f3504f3;
  const auto offset = bits_nonnan(x) - sqrt_half_bits;
  const F significand = from_bits_normal((offset & fraction_mask) + sqrt_half_bits);
  return {to_float(shift_right_signed(offset, 23)), significand - 1.0f};
}

/// `finite` if x is finite and positive, else the special value of a logarithm.
template <class F>
F logarithm_or_special(F x, F finite) {
  const F nonpositive = select(x == 0.0f, F(-infinity), F(not_a_number));
  return select(x > 0.0f, select(x < infinity, finite, F(infinity)), nonpositive);
}

/// x with its significand truncated to 12 bits: the product of two heads is exact.
template <class F>
F head(F x) {
  return from_bits_normal(bits_nonnan(x) & ~0xfff);
}

/// A number as an unevaluated sum; |low| is at most a few ULP of high.
template <class F>
struct Sum {
  F high;
  F low;
};

/// log2 of a normal positive x, relative error 2^-30: the kernel of log2 and pow.
/// With the significand 1 + r and s = r / (2 + r), it is log2((1 + s) / (1 - s)) = c s + s^3 P(s^2), where c s is
/// computed with more than float precision. Source: polynomials by Sollya's fpminimax.
template <class F>
Sum<F> log2_sum(F x) {
  constexpr float c_head = 0x1.716p1f;  // 2 / log(2) to 12 bits
  constexpr float c_tail = -0x1.7135a8p-12f;
  const Binary<F> b = split_binary(x);
  const F r = b.rest;

  // s = s_head + s_tail; the tail is computed from the remainder r - s_head * divisor.
  const F divisor = r + 2.0f;
  const F estimate = polynomial(divisor, {0x1.deaba2p-4f, -0x1.71e43ap-1f, 0x1.7a4e3ep0f});
  const F reciprocal = estimate * (2.0f - divisor * estimate);
  const F s_head = head(r * reciprocal);
  const F divisor_head = head(divisor);
  const F divisor_tail = r - (divisor_head - 2.0f);
  const F s_tail = ((r - s_head * divisor_head) - s_head * divisor_tail) * reciprocal;

  const F s = s_head + s_tail;
  const F z = s * s;
  const F p = polynomial(z, {0x1.558d06p-2f, 0x1.a5f2a8p-2f, 0x1.2776b2p-1f, 0x1.ec709ep-1f});
  const F high = s_head * c_head;
  const F low = (s * z) * p + (s_tail * c_head + s * c_tail);
  const F sum = b.exponent + high;
  return {sum, ((b.exponent - sum) + high) + low};
}

/// The base-2 logarithm.
/// Domain: all floats; zeros give -inf, +inf gives +inf, negative numbers and NaN give NaN.
/// Error: 0.6 ULP. Powers of two are exact.
template <class F>
F log2(F x) {
  const Sum<F> sum = log2_sum(select(x > 0.0f, x, F(1.0f)));
  return logarithm_or_special(x, sum.high + sum.low);
}

/// The natural logarithm.
/// Domain: all floats; zeros give -inf, +inf gives +inf, negative numbers and NaN give NaN.
/// Error: 1 ULP.
/// Source: log(2) in 14 + 24 bits; polynomial by Sollya's fpminimax.
template <class F>
F log(F x) {
  const Binary<F> b = split_binary(select(x > 0.0f, x, F(1.0f)));
  const F r = b.rest;
  const F q = polynomial(r, {0x1.2cb2eap-4f, -0x1.ddb2e2p-4f, 0x1.dc7636p-4f, -0x1.fbbf2ep-4f, 0x1.23de3ep-3f,
                             -0x1.556288p-3f, 0x1.999d2ap-3f, -0x1.ffffe6p-3f, 0x1.555554p-2f});
  const F square = r * r;
  const F low = ((square * r) * q + b.exponent * -0x1.e8082ep-16f) - square * 0.5f;
  return logarithm_or_special(x, b.exponent * 0x1.62e8p-1f + (r + low));
}

}  // namespace isoshade::functions
