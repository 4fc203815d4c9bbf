// SPDX-License-Identifier: Apache-2.0
// What the reference column of functions.def is written in: numbers with 64 bits of significand and 15 of
// exponent, 2^40 times finer than a float, and the same geometry over them. Unaffected by FTZ and DAZ.
#pragma once

#include <algorithm>
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
Vector<N> operator/(Vector<N> a, Vector<N> b) {
  return vector<N>([&](int i) { return a[i] / b[i]; });
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

inline Vector<3> transform_point(Matrix<4> m, Vector<3> p) {
  return transform(upper_three(m), p) + vector<3>([&](int i) { return m[3][i]; });
}

/// The sum of products of elements of the columns from `column` on, one of each of these rows (bits), without
/// column `left_out`. The terms' signs alternate (sign = -1: a determinant) or not (1).
template <int N>
Real sum_of_products(const Matrix<N>& m, Real sign, unsigned rows = (1u << N) - 1, int left_out = -1,
                     int column = 0) {
  if (column == left_out) ++column;
  if (column == N) return 1;
  Real sum = 0, factor = 1;
  for (int r = 0; r < N; ++r) {
    if ((rows >> r & 1) == 0) continue;
    sum += factor * m[column][r] * sum_of_products(m, sign, rows & ~(1u << r), left_out, column + 1);
    factor *= sign;
  }
  return sum;
}
/// Element (c, r) of the adjugate, up to its sign.
template <int N>
Real cofactor(const Matrix<N>& m, Real sign, int c, int r) {
  return sum_of_products(m, sign, ((1u << N) - 1) & ~(1u << c), r);
}

template <int N>
Real determinant(Matrix<N> m) {
  return sum_of_products(m, -1);
}
/// NaN, for "not defined", where terms may underflow.
template <int N>
Real determinant_magnitude(Matrix<N> m) {
  const Real magnitude = sum_of_products(abs(m), 1);
  return magnitude < 0x1p-80L ? NAN : magnitude;
}
template <int N>
Matrix<N> inverse(Matrix<N> m) {
  const Real d = determinant(m);
  return columns<N>([&](int c) {
    return vector<N>([&](int r) { return ((c + r) % 2 != 0 ? -1 : 1) * cofactor(m, -1, c, r) / d; });
  });
}
/// NaN, for "not defined", where the matrix is too near to a singular one, or terms may underflow.
template <int N>
Matrix<N> inverse_magnitude(Matrix<N> m) {
  const Real d = abs(determinant(m));
  const Real terms = determinant_magnitude(m);
  const Real defined = d < terms * 0x1p-18L || d < 0x1p-80L ? NAN : 1;
  const Matrix<N> exact = inverse(m);
  return columns<N>([&](int c) {
    return vector<N>(
        [&](int r) { return (cofactor(abs(m), 1, c, r) + abs(exact[c][r]) * terms) / d * defined; });
  });
}

inline Vector<2> rotate2d(Vector<2> v, Real degrees) {
  const Real angle = std::remainder(degrees, 360.0L) * 3.14159265358979323846L / 180;
  return {{cos(angle) * v[0] + sin(angle) * v[1], cos(angle) * v[1] - sin(angle) * v[0]}};
}
inline Vector<2> rotate2d_magnitude(Vector<2> v) {
  const Real sum = abs(v[0]) + abs(v[1]);
  return {{sum, sum}};
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

/// The textbook's six cases.
inline Vector<3> hsv_to_rgb(Vector<3> hsv) {
  const Real h = 6 * (hsv[0] - floor(hsv[0])), s = hsv[1], v = hsv[2];
  const int sixth = static_cast<int>(h);
  const Real f = h - sixth;
  const Real p = v * (1 - s), q = v * (1 - s * f), t = v * (1 - s * (1 - f));
  switch (sixth) {
    case 0: return {{v, t, p}};
    case 1: return {{q, v, p}};
    case 2: return {{p, v, t}};
    case 3: return {{p, q, v}};
    case 4: return {{t, p, v}};
    default: return {{v, p, q}};
  }
}
inline Vector<3> hsv_magnitude(Vector<3> hsv) {
  return vector<3>([&](int) { return abs(hsv[2]); });
}
inline Vector<3> rgb_to_hsv(Vector<3> c) {
  const Real most = std::max({c[0], c[1], c[2]}), least = std::min({c[0], c[1], c[2]});
  if (most == least) return {{0, 0, most}};
  const int k = c[0] == most ? 0 : c[1] == most ? 1 : 2;
  const Real h = (2 * k + (c[(k + 1) % 3] - c[(k + 2) % 3]) / (most - least)) / 6;
  return {{h < 0 ? h + 1 : h, (most - least) / most, most}};
}

}  // namespace isoshade::reference
