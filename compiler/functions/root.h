// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/functions/body.h"

namespace isoshade::functions {

/// 1 / sqrt(x) for normal positive x, in the dozen operations that the rest of the library uses it in.
/// Source: first step by Moroz et al., "Fast calculation of inverse square root with the use of magic
/// constant", 2018; then one of Householder's of third order.
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

}  // namespace isoshade::functions
