// SPDX-License-Identifier: Apache-2.0
// The transfer function of sRGB in the precise tier: the powers of the standard, of sums. Both directions rise
// monotonically over all floats.
#pragma once

#include "compiler/functions/comparison.h"
#include "compiler/functions/precise_exponential.h"

namespace isoshade::functions::precise {

/// Linear light to sRGB.
/// Domain: all floats; below 0 and NaN give 0, above 1 gives 1. Exact at 0 and 1.
/// Error: 0.7 ULP; where the standard's pieces meet it falls by 8 ULP, and here both stop half-way: 4 ULP within 8 of
/// 0.0031308.
template <class F>
F srgb_encode(F x) {
  constexpr float joint = 0x1.4b5da4p-5f;
  // 1.055 x^(1/2.4) - 0.055, the constants in 24 + 24 bits
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
/// Domain: all floats; below 0 and NaN give 0, above 1 gives 1. Exact at 0 and 1.
/// Error: 0.7 ULP.
template <class F>
F srgb_decode(F x) {
  const F within = min(max(F(0.04f), x), F(1.0f));
  // ((x + 0.055) / 1.055)^2.4, the constants in 24 + 24 bits
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

}  // namespace isoshade::functions::precise
