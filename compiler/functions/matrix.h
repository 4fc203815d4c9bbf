// SPDX-License-Identifier: Apache-2.0
// Matrices of columns, acting on column vectors from the left.
#pragma once

#include <utility>

#include "compiler/functions/vector.h"

namespace isoshade::functions {

/// The matrix whose columns are column(0) ... column(N - 1).
template <int N, class Column>
auto make_columns(Column column) {
  using F = decltype(column(0)[0]);
  if constexpr (N == 3) return mat<F, 3>{{column(0), column(1), column(2)}};
  if constexpr (N == 4) return mat<F, 4>{{column(0), column(1), column(2), column(3)}};
}

/// The vector element(0) ... element(N - 1).
template <int N, class Element>
auto make_elements(Element element) {
  using F = decltype(element(0));
  if constexpr (N == 3) return vec<F, 3>{element(0), element(1), element(2)};
  if constexpr (N == 4) return vec<F, 4>{element(0), element(1), element(2), element(3)};
}

/// m * v
/// Domain: all floats; sums of products that overflow give infinities or NaN.
/// Error: 2 ULP of the sum of the products' magnitudes, in each component.
template <class F, int N>
vec<F, N> transform(mat<F, N> m, vec<F, N> v) {
  vec<F, N> sum = m[0] * splat<N>(v[0]);
  for (int i = 1; i < N; ++i) sum = sum + m[i] * splat<N>(v[i]);
  return sum;
}

/// a * b
/// Domain: all floats; sums of products that overflow give infinities or NaN.
/// Error: 2 ULP of the sum of the products' magnitudes, in each element.
template <class F, int N>
mat<F, N> matmul(mat<F, N> a, mat<F, N> b) {
  return make_columns<N>([&](int c) { return transform(a, b[c]); });
}

/// Rows become columns.
/// Domain: all floats.
/// Error: 0 ULP.
template <class F, int N>
mat<F, N> transpose(mat<F, N> m) {
  return make_columns<N>([&](int c) { return make_elements<N>([&](int r) { return m[r][c]; }); });
}

/// The matrix that takes normals where `m` takes points: a positive multiple of the inverse transpose of its
/// upper left 3 x 3, by cofactors and without a division. Normalise what it gives.
/// Domain: all floats; products that overflow give infinities or NaN. A singular matrix gives its cofactors.
/// Error: 1.5 ULP of the sum of the two products' magnitudes, in each element.
template <class F, int N>
mat<F, 3> normal_matrix(mat<F, N> m) {
  const auto upper = [&](int c) { return vec<F, 3>{m[c][0], m[c][1], m[c][2]}; };
  const vec<F, 3> x = upper(0);
  const vec<F, 3> y = upper(1);
  const vec<F, 3> z = upper(2);
  const vec<F, 3> first = cross(y, z);
  const auto mirrors = dot(x, first) < 0.0f;
  const auto outward = [&](vec<F, 3> cofactors) { return select(mirrors, negate(cofactors), cofactors); };
  return {{outward(first), outward(cross(z, x)), outward(cross(x, y))}};
}

}  // namespace isoshade::functions
