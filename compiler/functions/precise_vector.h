// SPDX-License-Identifier: Apache-2.0
// Roots and lengths of the precise tier.
#pragma once

#include "compiler/functions/sums.h"
#include "compiler/functions/vector.h"

namespace isoshade::functions::precise {

/// 1 / sqrt(s) for s in [1, 64] as y (1 + rest / 2), y near it and rest = 1 - s y^2: Newton's step.
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

/// v / |v|. The same for v times any power of two.
/// Domain: all floats; zeros give zeros (of their signs). Infinite and NaN components are NaN, others then any number.
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
        const auto tiny = abs(c) < 0x1p-60f;  // as it is, what it is exactly multiplied by would underflow
        const Sum<F> product = two_product(select(tiny, c * 0x1p60f, c), root.y);
        const F unit = product.high + (product.low + product.high * rest);
        const F component = select(tiny, unit * 0x1p-60f, unit);
        return select(original == 0.0f, original, component + (original - original));
      },
      harmless, scaled);
}

/// |v|, without overflow or underflow on the way.
/// Domain: all floats. +inf where a component is infinite; NaN where one is NaN.
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
