// SPDX-License-Identifier: Apache-2.0
// Powers and logarithms of the fast tier: shorter polynomials, and arguments that are clamped to where these hold
// instead of results that are chosen.
#pragma once

#include "compiler/functions/comparison.h"
#include "compiler/functions/exponential.h"
#include "compiler/functions/logarithm.h"

namespace isoshade::functions::fast {

/// 2^x.
/// Domain: [-126, 127.9999]; below it and for NaN 2^-126, above it 2^127.9999.
/// Error: 90 ULP, 7.5e-6 of the result. Whole powers are exact.
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
/// Domain: [-87.33654, 88.72276]; below it and for NaN 2^-126, above it 2^127.9999.
/// Error: 135 ULP, 1.5e-5 of the result.
template <class F>
F exp(F x) {
  return exp2(x * 1.44269502f);
}

/// log2(x) of a normal positive number, an infinity being 2^128.
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
/// Domain: results in [2^-126, 2^127.9999], and clamped to it: 0 to a positive power is tiny, but not 0. Zeros,
/// negative numbers and NaN as `x` count as 2^-126; NaN as `y` gives 2^-126. pow(x, 0) and pow(1, y) are 1.
/// Error: 250 ULP for x in [1e-4, 1e4] and |y| <= 8, 3e-5 of the result.
template <class F>
F pow(F x, F y) {
  return exp2(log2(x) * y);
}

}  // namespace isoshade::functions::fast
