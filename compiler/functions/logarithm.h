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

/// What a logarithm gives where x is not finite and positive, and `finite` where it is.
template <class F>
F logarithm_or_special(F x, F finite) {
  const F nonpositive = select(x == 0.0f, F(-infinity), F(not_a_number));
  return select(x > 0.0f, select(x < infinity, finite, F(infinity)), nonpositive);
}

/// The 12 high bits of a significand: products of two heads are exact.
template <class F>
F head(F x) {
  return from_bits_normal(bits_nonnan(x) & ~0xfff);
}

/// A number as a sum, not carried out; |low| is at most a few ULP of high.
template <class F>
struct Sum {
  F high;
  F low;
};

/// log2 of a normal positive x, to about 2^-26 of it: the kernel of log2 and pow.
/// Source: polynomial by Sollya's fpminimax; its linear term is split to keep its product exact.
template <class F>
Sum<F> log2_sum(F x) {
  const Binary<F> b = split_binary(x);
  const F r = b.rest;
  const F q =
      polynomial(r, {-0x1.dea7aep-4f, 0x1.7d28e6p-3f, -0x1.81908ap-3f, 0x1.a2d476p-3f, -0x1.eb6aa8p-3f,
                     0x1.2780dp-2f, -0x1.7156c8p-2f, 0x1.ec708ap-2f, -0x1.715476p-1f});
  const F r_head = head(r);
  const F high = r_head * 0x1.716p0f;  // log2(e) to 12 bits
  const F low = ((r - r_head) * 0x1.716p0f + r * -0x1.7135a8p-13f) + (r * r) * q;
  const F sum = b.exponent + high;
  return {sum, ((b.exponent - sum) + high) + low};
}

/// The base-2 logarithm.
/// Domain: all floats; zeros give -inf, +inf gives +inf, negative numbers and NaN give NaN.
/// Error: 1.25 ULP. Powers of two are exact.
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
