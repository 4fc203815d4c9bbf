// SPDX-License-Identifier: Apache-2.0
// What the reference column of functions.def is written in: numbers with 64 bits of significand and 15 of
// exponent, 2^40 times finer than a float, and the same geometry over them. Unaffected by FTZ and DAZ.
#pragma once

#include <cmath>
#include <limits>

namespace isoshade::reference {

using Real = long double;
static_assert(std::numeric_limits<Real>::digits >= 64);

using std::abs, std::ceil, std::floor, std::sqrt;
using std::acos, std::asin, std::atan, std::atan2, std::cos, std::sin, std::tan;
using std::exp, std::exp2, std::log, std::log2, std::pow;

template <int N>
struct Vector {
  Real c[N];
  Real operator[](int i) const { return c[i]; }
};

template <int N>
struct Matrix {
  Vector<N> column[N];
  const Vector<N>& operator[](int i) const { return column[i]; }
};

template <int N, class Element>
Vector<N> vector(Element element) {
  Vector<N> v;
  for (int i = 0; i < N; ++i) v.c[i] = element(i);
  return v;
}

template <int N, class Column>
Matrix<N> columns(Column column) {
  Matrix<N> m;
  for (int i = 0; i < N; ++i) m.column[i] = column(i);
  return m;
}

template <int N>
Vector<N> operator+(Vector<N> a, Vector<N> b) {
  return vector<N>([&](int i) { return a[i] + b[i]; });
}
template <int N>
Vector<N> operator-(Vector<N> a, Vector<N> b) {
  return vector<N>([&](int i) { return a[i] - b[i]; });
}
template <int N>
Vector<N> operator*(Vector<N> a, Real s) {
  return vector<N>([&](int i) { return a[i] * s; });
}
template <int N>
Vector<N> abs(Vector<N> a) {
  return vector<N>([&](int i) { return abs(a[i]); });
}
template <int N>
Matrix<N> abs(Matrix<N> m) {
  return columns<N>([&](int i) { return abs(m[i]); });
}

template <int N>
Real dot(Vector<N> a, Vector<N> b) {
  Real sum = 0;
  for (int i = 0; i < N; ++i) sum += a[i] * b[i];
  return sum;
}
template <int N>
Real length(Vector<N> a) {
  return sqrt(dot(a, a));
}
template <int N>
Vector<N> normalize(Vector<N> a) {
  const Real l = length(a);
  return l == 0 ? a : a * (1 / l);
}

inline Vector<3> cross(Vector<3> a, Vector<3> b) {
  return vector<3>([&](int i) { return a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]; });
}
inline Vector<3> cross_magnitude(Vector<3> a, Vector<3> b) {
  a = abs(a), b = abs(b);
  return vector<3>([&](int i) { return a[(i + 1) % 3] * b[(i + 2) % 3] + a[(i + 2) % 3] * b[(i + 1) % 3]; });
}

template <int N>
Vector<N> reflect(Vector<N> i, Vector<N> n) {
  return i - n * (2 * dot(n, i));
}
template <int N>
Vector<N> reflect_magnitude(Vector<N> i, Vector<N> n) {
  return abs(i) + abs(n) * (2 * dot(abs(n), abs(i)));
}

inline Real refract_root(Real d, Real eta) { return sqrt(1 - eta * eta * (1 - d * d)); }
template <int N>
Vector<N> refract(Vector<N> i, Vector<N> n, Real eta) {
  const Real d = dot(n, i);
  return i * eta - n * (eta * d + refract_root(d, eta));
}
template <int N>
Vector<N> refract_magnitude(Vector<N> i, Vector<N> n, Real eta) {
  return abs(i) * eta + abs(n) * (eta * dot(abs(n), abs(i)) + refract_root(dot(n, i), eta));
}

template <int N>
Vector<N> transform(Matrix<N> m, Vector<N> v) {
  Vector<N> sum{};
  for (int i = 0; i < N; ++i) sum = sum + m[i] * v[i];
  return sum;
}
template <int N>
Matrix<N> matmul(Matrix<N> a, Matrix<N> b) {
  return columns<N>([&](int i) { return transform(a, b[i]); });
}
template <int N>
Matrix<N> transpose(Matrix<N> m) {
  return columns<N>([&](int c) { return vector<N>([&](int r) { return m[r][c]; }); });
}

template <int N>
Matrix<3> upper_three(Matrix<N> m) {
  return columns<3>([&](int c) { return vector<3>([&](int r) { return m[c][r]; }); });
}
template <int N>
Matrix<3> normal_matrix(Matrix<N> m) {
  const Matrix<3> u = upper_three(m);
  const Real sign = dot(u[0], cross(u[1], u[2])) < 0 ? -1 : 1;
  return columns<3>([&](int i) { return cross(u[(i + 1) % 3], u[(i + 2) % 3]) * sign; });
}
/// NaN, for "not defined", where the determinant is too near zero for its sign to be known.
template <int N>
Matrix<3> cofactor_magnitude(Matrix<N> m) {
  const Matrix<3> u = upper_three(m);
  const Real determinant = dot(u[0], cross(u[1], u[2]));
  const Real terms = dot(abs(u[0]), cross_magnitude(u[1], u[2]));
  const Real defined = abs(determinant) < terms * 0x1p-18L ? NAN : 1;
  return columns<3>([&](int i) { return cross_magnitude(u[(i + 1) % 3], u[(i + 2) % 3]) * defined; });
}

/// NaN, for "not defined", where the quotient is nearly whole: 0 and y are taken for each other there.
inline Real mod_magnitude(Real x, Real y) {
  const Real quotient = x / y;
  return abs(quotient - std::round(quotient)) < abs(quotient) * 0x1p-23L ? NAN : abs(x) + abs(y);
}

inline Real round_half_even(Real x) { return std::nearbyint(x); }

inline Real smoothstep(Real low, Real high, Real x) {
  Real t = (x - low) / (high - low);
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  return t * t * (3 - 2 * t);
}

inline Real srgb_encode(Real x) { return x <= 0.0031308L ? x * 12.92L : 1.055L * pow(x, 1 / 2.4L) - 0.055L; }
inline Real srgb_decode(Real x) { return x <= 0.04045L ? x / 12.92L : pow((x + 0.055L) / 1.055L, 2.4L); }

inline Real luminance(Vector<3> c) { return 0.2126L * c[0] + 0.7152L * c[1] + 0.0722L * c[2]; }

}  // namespace isoshade::reference
