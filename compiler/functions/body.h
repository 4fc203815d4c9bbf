// SPDX-License-Identifier: Apache-2.0
// The vocabulary of function bodies: the ops of runtime/lanes, and helpers for vectors, polynomials and loops.
//
// A body is a template over a float type F. With F = float it computes; with F = traced::Float it builds IR. It must
// not branch on values; it may use ops, `select`, and other bodies. Float literals convert to F.
#pragma once

#include <cstddef>
#include <tuple>

#include "runtime/lanes/lanes.h"

namespace isoshade::functions {

using namespace lanes;

inline constexpr float infinity = __builtin_inff();
inline constexpr float not_a_number = __builtin_nanf("");
inline constexpr float smallest_normal = 0x1p-126f;
inline constexpr float largest_finite = 0x1.fffffep127f;
inline constexpr int one_bits = 0x3f800000;  // of 1.0f
inline constexpr int fraction_mask = 0x7fffff;
inline constexpr int implicit_bit = 0x800000;

/// An N x N matrix of columns; m[c][r] is column c, row r.
template <class F, int N>
struct mat {
  vec<F, N> column[N];
  const vec<F, N>& operator[](int i) const { return column[i]; }
};

/// All components equal `s`.
template <int N, class F>
vec<F, N> splat(F s) {
  if constexpr (N == 2) return {s, s};
  if constexpr (N == 3) return {s, s, s};
  if constexpr (N == 4) return {s, s, s, s};
}

/// Applies f to each component of its arguments.
template <class Function, class F, int N, class... Rest>
vec<F, N> componentwise(Function f, vec<F, N> first, Rest... rest) {
  const auto component = [&](int i) { return f(first[i], rest[i]...); };
  if constexpr (N == 2) return {component(0), component(1)};
  if constexpr (N == 3) return {component(0), component(1), component(2)};
  if constexpr (N == 4) return {component(0), component(1), component(2), component(3)};
}

/// c[0] * x^(n-1) + ... + c[n-2] * x + c[n-1] by Horner's rule. n >= 2.
template <class F, size_t n>
F polynomial(F x, const float (&c)[n]) {
  F p = c[0] * x + c[1];
  for (size_t i = 2; i < n; ++i) p = p * x + c[i];
  return p;
}

/// Iterates states = body(index, states...) for index 0 .. count-1, starting with `initial`.
template <class Body, class... State>
std::tuple<State...> loop(int count, Body body, State... initial) {
  std::tuple<State...> states(initial...);
  for (int i = 0; i < count; ++i)
    states = std::apply([&](State... state) { return body(i, state...); }, states);
  return states;
}

}  // namespace isoshade::functions
