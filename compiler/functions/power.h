// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/functions/comparison.h"
#include "compiler/functions/exponential.h"
#include "compiler/functions/logarithm.h"

namespace isoshade::functions {

/// x^y for x >= 0.
/// Domain: all floats. As IEEE-754's powr, except that pow(x, 0) = 1 for every x, including NaN, and pow(1, y) = 1
/// for every y but NaN; x < 0 gives NaN even for integer y. Results below 2^-126 are 0.
/// Error: 2 ULP for x in [1e-6, 1e6] and |y| <= 64; at most about 6 ULP elsewhere.
/// Source: exp2(y * log2(x)), with the logarithm and the product as sums of two floats.
template <class F>
F pow(F x, F y) {
  const auto ordinary = (x > 0.0f) & (x < infinity);
  const Sum<F> log2_x = log2_sum(select(ordinary, x, F(1.0f)));
  const F l = log2_x.high + log2_x.low;
  const F l_rest = (log2_x.high - l) + log2_x.low;
  const F e = min(max(F(-0x1p100f), y), F(0x1p100f));  // avoids overflow; never NaN

  // e * (l + l_rest) = p + p_rest
  const F e_head = head(e);
  const F e_tail = e - e_head;
  const F l_head = head(l);
  const F l_tail = l - l_head;
  const F p = e * l;
  const F rounded_off = (((e_head * l_head - p) + e_head * l_tail) + e_tail * l_head) + e_tail * l_tail;
  const F p_rest = rounded_off + e * l_rest;

  const F within = min(max(p, F(-127.0f)), F(128.0f));
  const F n = floor(within + 0.5f);
  const F f = (within - n) + select(within == p, p_rest, F(0.0f));
  const auto power = bits_nonnan(exp2_of_fraction(f)) + shift_left(to_int(n), 23);
  const auto below_infinity = select(power < exponent_bits, power, int_of<F>(exponent_bits));
  const F finite = from_bits_normal(select(power < implicit_bit, int_of<F>(0), below_infinity));

  const F extreme = select((x > 0.0f) ^ (y < 0.0f), F(infinity), F(0.0f));  // x is 0 or infinite
  const F result = select((x >= 0.0f) & (y == y), select(ordinary, finite, extreme), F(not_a_number));
  return select(y == 0.0f, F(1.0f), result);
}

/// |x|^y with the sign of x.
/// Domain: all floats, as for pow in each tier. Zeros count as positive: 0^0 is 1, and 0 to a negative power is +inf.
/// Error: 2 ULP for |x| in [1e-6, 1e6] and |y| <= 64; at most about 6 ULP elsewhere.
template <class F>
F safepower(F x, F y) {
  const F magnitude = pow(abs(x), y);
  return select(x < 0.0f, negate(magnitude), magnitude);
}

}  // namespace isoshade::functions
