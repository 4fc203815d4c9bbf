// SPDX-License-Identifier: Apache-2.0
// Vectors and matrices over any number type R, for the reference column of functions.def. Tests that measure every
// float use long double, which is 2^40 times finer than a float; the reference backend uses Real.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

namespace isoshade::reference {

// For built-in number types; real.h has them for Real.
using std::abs, std::ceil, std::floor, std::fmod, std::sqrt;
using std::acos, std::asin, std::atan, std::atan2, std::cos, std::sin, std::tan;
using std::exp, std::exp2, std::log, std::log2, std::pow;

template <class R>
R not_a_number() {
  return std::numeric_limits<R>::quiet_NaN();
}
template <class R>
R pi() {
  return 4 * atan(R(1));
}

template <class R>
R round_half_even(R x) {
  const R below = floor(x);
  const R twice = 2 * (x - below);
  if (twice == 1) return 2 * floor((below + 1) / 2);
  return twice < 1 ? below : below + 1;
}

template <class R>
R clamp(R x, R low, R high) {
  const R above = x < low ? low : x;
  return high < above ? high : above;
}
/// An infinity minus itself is NaN.
template <class R>
R finite_or_zero(R x) {
  return x - x == 0 ? x : R(0);
}
/// 0 for NaN.
template <class R>
R saturate(R x) {
  return x > 0 ? (x < 1 ? x : R(1)) : R(0);
}
template <class R>
R remap(R x, R in_low, R in_high, R out_low, R out_high) {
  if (in_high == in_low) return out_low;
  return out_low + (out_high - out_low) * ((x - in_low) / (in_high - in_low));
}
template <class R>
R smoothstep(R low, R high, R x) {
  const R t = saturate((x - low) / (high - low));
  return t * t * (3 - 2 * t);
}

/// Texture coordinates; infinities and NaN count as 0.
template <class R>
R wrap(R x) {
  return x - x == 0 ? x - floor(x) : R(0);
}
template <class R>
R mirror(R x) {
  const R in_two = x - x == 0 ? abs(x) - 2 * floor(abs(x) / 2) : R(0);
  return in_two > 1 ? 2 - in_two : in_two;
}

template <class R>
R sign(R x) {
  return x > 0 ? R(1) : x < 0 ? R(-1) : x;
}

/// x^y; NaN for negative x, unless y is 0.
template <class R>
R power(R x, R y) {
  if (y == 0) return 1;
  return x < 0 || y != y ? not_a_number<R>() : pow(abs(x), y);
}
template <class R>
R safe_power(R x, R y) {
  return x < 0 ? -power(-x, y) : power(x, y);
}

/// With the sign of y. NaN for infinities.
template <class R>
R modulo(R x, R y) {
  if (y - y != 0) return not_a_number<R>();
  const R rest = fmod(x, y);
  return (rest < 0 && y > 0) || (rest > 0 && y < 0) ? rest + y : rest;
}
/// NaN, for "not defined", where the quotient is nearly whole: rounding decides between 0 and y there.
template <class R>
R mod_magnitude(R x, R y) {
  const R quotient = x / y;
  const R off = abs(quotient - round_half_even(quotient));
  return off < abs(quotient) * 0x1p-23 ? not_a_number<R>() : abs(x) + abs(y);
}

template <class R, int N>
struct Vector {
  using Number = R;
  R c[N];
  R operator[](int i) const { return c[i]; }
};

template <class R, int N>
struct Matrix {
  Vector<R, N> column[N];
  const Vector<R, N>& operator[](int i) const { return column[i]; }
};

template <int N, class Element>
auto vector(Element element) {
  Vector<std::invoke_result_t<Element, int>, N> v;
  for (int i = 0; i < N; ++i) v.c[i] = element(i);
  return v;
}

template <int N, class Column>
auto columns(Column column) {
  Matrix<typename std::invoke_result_t<Column, int>::Number, N> m;
  for (int i = 0; i < N; ++i) m.column[i] = column(i);
  return m;
}

template <class R, int N>
Vector<R, N> operator+(Vector<R, N> a, Vector<R, N> b) {
  return vector<N>([&](int i) { return a[i] + b[i]; });
}
template <class R, int N>
Vector<R, N> operator-(Vector<R, N> a, Vector<R, N> b) {
  return vector<N>([&](int i) { return a[i] - b[i]; });
}
template <class R, int N>
Vector<R, N> operator*(Vector<R, N> a, std::type_identity_t<R> s) {
  return vector<N>([&](int i) { return a[i] * s; });
}
template <class R, int N>
Vector<R, N> operator/(Vector<R, N> a, Vector<R, N> b) {
  return vector<N>([&](int i) { return a[i] / b[i]; });
}
template <class R, int N>
Vector<R, N> abs(Vector<R, N> a) {
  return vector<N>([&](int i) { return abs(a[i]); });
}
template <class R, int N>
Matrix<R, N> abs(Matrix<R, N> m) {
  return columns<N>([&](int i) { return abs(m[i]); });
}

template <class R, int N>
R dot(Vector<R, N> a, Vector<R, N> b) {
  R sum = 0;
  for (int i = 0; i < N; ++i) sum += a[i] * b[i];
  return sum;
}
template <class R, int N>
R length(Vector<R, N> a) {
  return sqrt(dot(a, a));
}
template <class R, int N>
R mip_level(Vector<R, N> along_x, Vector<R, N> along_y) {
  const R across = dot(along_x, along_x), down = dot(along_y, along_y);
  return log2(across < down ? down : across) / 2;
}
template <class R, int N>
Vector<R, N> normalize(Vector<R, N> a) {
  const R l = length(a);
  return l == 0 ? a : a * (1 / l);
}

template <class R>
Vector<R, 3> cross(Vector<R, 3> a, Vector<R, 3> b) {
  return vector<3>([&](int i) { return a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]; });
}
template <class R>
Vector<R, 3> cross_magnitude(Vector<R, 3> a, Vector<R, 3> b) {
  a = abs(a), b = abs(b);
  return vector<3>([&](int i) { return a[(i + 1) % 3] * b[(i + 2) % 3] + a[(i + 2) % 3] * b[(i + 1) % 3]; });
}

template <class R, int N>
Vector<R, N> reflect(Vector<R, N> i, Vector<R, N> n) {
  return i - n * (2 * dot(n, i));
}
template <class R, int N>
Vector<R, N> reflect_magnitude(Vector<R, N> i, Vector<R, N> n) {
  return abs(i) + abs(n) * (2 * dot(abs(n), abs(i)));
}

/// The square of the refracted ray's cosine; not positive under total reflection.
template <class R>
R refract_square(R d, R eta) {
  return 1 - eta * eta * (1 - d * d);
}
template <class R, int N>
Vector<R, N> refract(Vector<R, N> i, Vector<R, N> n, R eta) {
  const R d = dot(n, i);
  const R square = refract_square(d, eta);
  return square >= 0 ? i * eta - n * (eta * d + sqrt(square)) : Vector<R, N>{};
}
template <class R, int N>
Vector<R, N> refract_magnitude(Vector<R, N> i, Vector<R, N> n, R eta) {
  return abs(i) * eta + abs(n) * (eta * dot(abs(n), abs(i)) + sqrt(refract_square(dot(n, i), eta)));
}

template <class R, int N>
Vector<R, N> transform(Matrix<R, N> m, Vector<R, N> v) {
  Vector<R, N> sum{};
  for (int i = 0; i < N; ++i) sum = sum + m[i] * v[i];
  return sum;
}
template <class R, int N>
Matrix<R, N> matmul(Matrix<R, N> a, Matrix<R, N> b) {
  return columns<N>([&](int i) { return transform(a, b[i]); });
}
template <class R, int N>
Matrix<R, N> transpose(Matrix<R, N> m) {
  return columns<N>([&](int c) { return vector<N>([&](int r) { return m[r][c]; }); });
}

template <class R, int N>
Matrix<R, 3> upper_three(Matrix<R, N> m) {
  return columns<3>([&](int c) { return vector<3>([&](int r) { return m[c][r]; }); });
}
template <class R, int N>
Matrix<R, 3> normal_matrix(Matrix<R, N> m) {
  const Matrix<R, 3> u = upper_three(m);
  const int sign = dot(u[0], cross(u[1], u[2])) < 0 ? -1 : 1;
  return columns<3>([&](int i) { return cross(u[(i + 1) % 3], u[(i + 2) % 3]) * sign; });
}
/// NaN, for "not defined", where the determinant is too near zero for its sign to be known.
template <class R, int N>
Matrix<R, 3> cofactor_magnitude(Matrix<R, N> m) {
  const Matrix<R, 3> u = upper_three(m);
  const R determinant = dot(u[0], cross(u[1], u[2]));
  const R terms = dot(abs(u[0]), cross_magnitude(u[1], u[2]));
  const R defined = abs(determinant) < terms * 0x1p-18 ? not_a_number<R>() : R(1);
  return columns<3>([&](int i) { return cross_magnitude(u[(i + 1) % 3], u[(i + 2) % 3]) * defined; });
}

template <class R>
Vector<R, 3> transform_point(Matrix<R, 4> m, Vector<R, 3> p) {
  return transform(upper_three(m), p) + vector<3>([&](int i) { return m[3][i]; });
}

/// The sum of products of elements of the columns from `column` on, one of each of these rows (bits), without
/// column `left_out`. The terms' signs alternate (sign = -1: a determinant) or not (1).
template <class R, int N>
R sum_of_products(const Matrix<R, N>& m, int sign, unsigned rows = (1u << N) - 1, int left_out = -1,
                  int column = 0) {
  if (column == left_out) ++column;
  if (column == N) return 1;
  R sum = 0;
  int factor = 1;
  for (int r = 0; r < N; ++r) {
    if ((rows >> r & 1) == 0) continue;
    sum += factor * m[column][r] * sum_of_products(m, sign, rows & ~(1u << r), left_out, column + 1);
    factor *= sign;
  }
  return sum;
}
/// Element (c, r) of the adjugate, up to its sign.
template <class R, int N>
R cofactor(const Matrix<R, N>& m, int sign, int c, int r) {
  return sum_of_products(m, sign, ((1u << N) - 1) & ~(1u << c), r);
}

template <class R, int N>
R determinant(Matrix<R, N> m) {
  return sum_of_products(m, -1);
}
/// NaN, for "not defined", where terms may underflow.
template <class R, int N>
R determinant_magnitude(Matrix<R, N> m) {
  const R magnitude = sum_of_products(abs(m), 1);
  return magnitude < 0x1p-80 ? not_a_number<R>() : magnitude;
}
template <class R, int N>
Matrix<R, N> inverse(Matrix<R, N> m) {
  const R d = determinant(m);
  return columns<N>([&](int c) {
    return vector<N>([&](int r) { return ((c + r) % 2 != 0 ? -1 : 1) * cofactor(m, -1, c, r) / d; });
  });
}
/// NaN, for "not defined", where the matrix is too near to a singular one, or terms may underflow.
template <class R, int N>
Matrix<R, N> inverse_magnitude(Matrix<R, N> m) {
  const R d = abs(determinant(m));
  const R terms = determinant_magnitude(m);
  const R defined = d < terms * 0x1p-18 || d < 0x1p-80 ? not_a_number<R>() : R(1);
  const Matrix<R, N> exact = inverse(m);
  return columns<N>([&](int c) {
    return vector<N>(
        [&](int r) { return (cofactor(abs(m), 1, c, r) + abs(exact[c][r]) * terms) / d * defined; });
  });
}

template <class R>
Vector<R, 2> rotate2d(Vector<R, 2> v, R degrees) {
  const R angle = fmod(degrees, R(360)) * pi<R>() / 180;
  return {{cos(angle) * v[0] + sin(angle) * v[1], cos(angle) * v[1] - sin(angle) * v[0]}};
}
template <class R>
Vector<R, 2> rotate2d_magnitude(Vector<R, 2> v) {
  const R sum = abs(v[0]) + abs(v[1]);
  return {{sum, sum}};
}

}  // namespace isoshade::reference
