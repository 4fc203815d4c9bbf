// SPDX-License-Identifier: Apache-2.0
// Arithmetic on unevaluated sums of two floats: the error-free transformations of Dekker, "A floating-point technique
// for extending the available precision", 1971, and Knuth. The low parts of products must not underflow.
#pragma once

#include "compiler/functions/logarithm.h"

namespace isoshade::functions {

/// a + b, exactly.
template <class F>
Sum<F> two_sum(F a, F b) {
  const F high = a + b;
  const F b_part = high - a;
  return {high, (a - (high - b_part)) + (b - b_part)};
}

/// a + b, exactly, for |a| >= |b| or a = 0.
template <class F>
Sum<F> quick_two_sum(F a, F b) {
  const F high = a + b;
  return {high, b - (high - a)};
}

/// a * b, exactly.
template <class F>
Sum<F> two_product(F a, F b) {
  const F high = a * b;
  const F a_head = head(a);
  const F a_tail = a - a_head;
  const F b_head = head(b);
  const F b_tail = b - b_head;
  return {high, (((a_head * b_head - high) + a_head * b_tail) + a_tail * b_head) + a_tail * b_tail};
}

/// a * b, exactly, for a constant b.
template <class F>
Sum<F> two_product_by(F a, float b) {
  const float b_head = __builtin_bit_cast(float, __builtin_bit_cast(int, b) & ~0xfff);
  const float b_tail = b - b_head;
  const F high = a * b;
  const F a_head = head(a);
  const F a_tail = a - a_head;
  return {high, (((a_head * b_head - high) + a_head * b_tail) + a_tail * b_head) + a_tail * b_tail};
}

/// a * a, exactly.
template <class F>
Sum<F> two_square(F a) {
  const F high = a * a;
  const F a_head = head(a);
  const F a_tail = a - a_head;
  const F cross = a_head * a_tail;
  return {high, ((a_head * a_head - high) + (cross + cross)) + a_tail * a_tail};
}

}  // namespace isoshade::functions
