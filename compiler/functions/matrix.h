// SPDX-License-Identifier: Apache-2.0
// Column-major matrices, which multiply column vectors from the left.
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

/// The transpose.
/// Domain: all floats, unchanged.
/// Error: 0 ULP.
template <class F, int N>
mat<F, N> transpose(mat<F, N> m) {
  return make_columns<N>([&](int c) { return make_elements<N>([&](int r) { return m[r][c]; }); });
}

/// The first three components of a column.
template <class F, int N>
vec<F, 3> upper_three(vec<F, N> column) {
  return {column[0], column[1], column[2]};
}

/// m * (v, 0) without its last component: transforms a direction.
/// Domain: all floats; sums of products that overflow give infinities or NaN. Ignores the last row of the matrix.
/// Error: 2 ULP of the sum of the products' magnitudes, in each component.
template <class F>
vec<F, 3> transform_vector(mat<F, 4> m, vec<F, 3> v) {
  return transform(mat<F, 3>{{upper_three(m[0]), upper_three(m[1]), upper_three(m[2])}}, v);
}

/// m * (p, 1) without its last component: transforms a point by an affine matrix.
/// Domain: all floats; sums of products that overflow give infinities or NaN. Ignores the last row of the matrix.
/// Error: 2.5 ULP of the sum of the terms' magnitudes, in each component.
template <class F>
vec<F, 3> transform_point(mat<F, 4> m, vec<F, 3> p) {
  return transform_vector(m, p) + upper_three(m[3]);
}

/// The matrix that transforms normals: a positive multiple of the inverse transpose of the upper left 3 x 3 block of
/// `m`, computed from cofactors without a division. The transformed normals need normalisation.
/// Domain: all floats; products that overflow give infinities or NaN. A singular matrix gives its cofactors.
/// Error: 1.5 ULP of the sum of the two products' magnitudes, in each element.
template <class F, int N>
mat<F, 3> normal_matrix(mat<F, N> m) {
  const vec<F, 3> x = upper_three(m[0]);
  const vec<F, 3> y = upper_three(m[1]);
  const vec<F, 3> z = upper_three(m[2]);
  const vec<F, 3> first = cross(y, z);
  const auto mirrors = dot(x, first) < 0.0f;
  const auto outward = [&](vec<F, 3> cofactors) { return select(mirrors, negate(cofactors), cofactors); };
  return {{outward(first), outward(cross(z, x)), outward(cross(x, y))}};
}

/// normal_matrix(m) * n: transforms a normal. The result is not normalised.
/// Domain: all floats; products that overflow give infinities or NaN.
/// Error: 3 ULP of the sum of the terms' magnitudes, in each component.
template <class F>
vec<F, 3> transform_normal(mat<F, 4> m, vec<F, 3> n) {
  return transform(normal_matrix(m), n);
}

/// The rows of the adjugate, which is the inverse times the determinant.
template <class F>
mat<F, 3> adjugate_rows(mat<F, 3> m) {
  return {{cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])}};
}

/// The six 2 x 2 minors of a 4 x 2 matrix with columns a and b; xy is that of the first two rows.
template <class F>
struct Minors {
  F xy, xz, xw, yz, yw, zw;

  Minors(vec<F, 4> a, vec<F, 4> b)
      : xy(a[0] * b[1] - a[1] * b[0]),
        xz(a[0] * b[2] - a[2] * b[0]),
        xw(a[0] * b[3] - a[3] * b[0]),
        yz(a[1] * b[2] - a[2] * b[1]),
        yw(a[1] * b[3] - a[3] * b[1]),
        zw(a[2] * b[3] - a[3] * b[2]) {}

  /// The vector whose dot product with any x is the determinant of the matrix (x, v, a, b).
  vec<F, 4> with(vec<F, 4> v) const {
    return {(v[1] * zw - v[2] * yw) + v[3] * yz, (v[2] * xw - v[0] * zw) - v[3] * xz,
            (v[0] * yw - v[1] * xw) + v[3] * xy, (v[1] * xz - v[0] * yz) - v[2] * xy};
  }
};

template <class F>
mat<F, 4> adjugate_rows(mat<F, 4> m) {
  const Minors<F> first(m[0], m[1]);
  const Minors<F> last(m[2], m[3]);
  return {{last.with(m[1]), negate(last.with(m[0])), first.with(m[3]), negate(first.with(m[2]))}};
}

/// The determinant.
/// Domain: all floats; products of N elements that overflow give infinities or NaN.
/// Error: 4 ULP of the sum of the terms' magnitudes.
template <class F, int N>
F determinant(mat<F, N> m) {
  return dot(adjugate_rows(m)[0], m[0]);  // the other rows are dead code
}

/// The inverse.
/// Domain: all floats; wrong if products of N elements overflow or underflow. A singular matrix gives infinities and
/// NaN.
/// Error: 4 ULP of (C + |element| * D) / |determinant|, where C and D are the sums of the terms' magnitudes of the
/// element's cofactor and of the determinant.
/// Source: Cramer's rule.
template <class F, int N>
mat<F, N> inverse(mat<F, N> m) {
  const mat<F, N> rows = adjugate_rows(m);
  const F scale = 1.0f / dot(rows[0], m[0]);
  return transpose(make_columns<N>([&](int r) { return rows[r] * splat<N>(scale); }));
}

}  // namespace isoshade::functions
