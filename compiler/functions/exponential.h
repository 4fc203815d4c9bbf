// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/functions/body.h"

namespace isoshade::functions {

/// p * 2^n for an integer n. The result must be normal or infinite.
template <class F>
F scale_by_power_of_two(F p, F n) {
  return from_bits_normal(bits_nonnan(p) + shift_left(to_int(n), 23));
}

/// 2^f for f in [-0.5, 0.5]: the kernel of exp2 and pow.
/// Source: polynomial by Sollya's fpminimax, relative error 2^-27.
template <class F>
F exp2_of_fraction(F f) {
  return polynomial(f, {0x1.41fbbcp-13f, 0x1.5f3e52p-10f, 0x1.3b2d4cp-7f, 0x1.c6aee8p-5f, 0x1.ebfbdcp-3f,
                        0x1.62e43p-1f, 1.0f});
}

/// 2^x.
/// Domain: all floats; x >= 128 gives +inf, x < -126 gives 0, NaN gives NaN.
/// Error: 1.25 ULP.
template <class F>
F exp2(F x) {
  const F above = select(x < -126.0f, F(-126.0f), x);
  const F within = select(above < 128.0f, above, F(127.0f));  // replaces NaN, too
  const F n = floor(within + 0.5f);
  const F power = scale_by_power_of_two(exp2_of_fraction(within - n), n);
  const F finite = select(x < -126.0f, F(0.0f), power);
  return select(x < 128.0f, finite, x + infinity);
}

/// e^x.
/// Domain: all floats; x > 88.7228317 gives +inf, x < -87.3365402 gives 0, NaN gives NaN.
/// Error: 1.1 ULP.
/// Source: Cody and Waite's reduction by 9 + 24 bits of log(2); polynomial by Sollya's fpminimax.
template <class F>
F exp(F x) {
  constexpr float lowest = -87.3365402f;
  constexpr float highest = 88.7228317f;
  const F above = select(x < lowest, F(lowest), x);
  const F within = select(above <= highest, above, F(highest));
  const F n = floor(within * 1.44269502f + 0.5f);
  const F r = (within - n * 0.693359375f) - n * -2.12194442e-4f;
  const F q = polynomial(r, {0x1.6d4bfcp-10f, 0x1.120c06p-7f, 0x1.5554eap-5f, 0x1.5554dcp-3f, 0.5f});
  const F power = scale_by_power_of_two((r * r * q + r) + 1.0f, n);
  const F finite = select(x < lowest, F(0.0f), power);
  return select(x <= highest, finite, x + infinity);
}

}  // namespace isoshade::functions
