// SPDX-License-Identifier: Apache-2.0
// exp2, log2 and what is made of them.
#pragma once

#include "compiler/functions/comparison.h"

namespace isoshade::functions {

/// 2^x.
/// Domain: all floats; x >= 128 gives +inf, x < -126 gives 0, NaN gives NaN.
/// Error: 1.2 ULP.
/// Source: polynomial of degree 6 on [-0.5, 0.5] by Sollya's fpminimax.
template <class F>
F exp2(F x) {
  F within = select(x < F(-150.0f), F(-150.0f), x);
  within = select(within < F(150.0f), within, F(150.0f));  // NaN too becomes harmless
  const F n = floor(within + F(0.5f));
  const F f = within - n;
  F p = F(0.000153533620f) * f + F(0.00133988739f);
  p = p * f + F(0.00961843692f);
  p = p * f + F(0.0555033237f);
  p = p * f + F(0.240226477f);
  p = p * f + F(0.693147182f);
  p = p * f + F(1.0f);
  F result = from_bits(bits_nonnan(p) + shift_left(to_int(n), 23));
  result = select(x >= F(128.0f), F(__builtin_inff()), result);
  result = select(x < F(-126.0f), F(0.0f), result);
  return select(x == x, result, x);
}

}  // namespace isoshade::functions
