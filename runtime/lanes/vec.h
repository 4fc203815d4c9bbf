// SPDX-License-Identifier: Apache-2.0
//
// Vectors of 2 to 4 components of a float type: float, or lanes. Arithmetic is componentwise. A uniform
// vector (vec<float, N>) converts to one of lanes.
// (The definitions say `requires` so that a type of your own can have vectors of its own: vec<Mine, N> is
// then the more special one.)
#ifndef ISOSHADE_LANES_VEC_H
#define ISOSHADE_LANES_VEC_H

#include "vector.h"

namespace isoshade::lanes {

template <class T, int N>
struct vec;

template <class T>
using vec2 = vec<T, 2>;
template <class T>
using vec3 = vec<T, 3>;
template <class T>
using vec4 = vec<T, 4>;

template <class T>
inline constexpr bool is_float = false;
template <>
inline constexpr bool is_float<float> = true;

/// A vector of the first type is a uniform value among vectors of the second.
template <class From, class To>
concept Broadcasts = is_float<From> && !is_float<To>;

template <class T, int N>
requires(N == 2) struct vec<T, N> {
  using B = bool_of<T>;

  T x, y;

  vec() = default;
  ISOSHADE_INLINE explicit vec(T all) : x(all), y(all) {}
  ISOSHADE_INLINE vec(T x_, T y_) : x(x_), y(y_) {}
  template <Broadcasts<T> Uniform>
  ISOSHADE_INLINE vec(const vec<Uniform, 2>& uniform) : x(uniform.x), y(uniform.y) {}

  ISOSHADE_INLINE T operator[](int i) const { return i == 0 ? x : y; }

  ISOSHADE_INLINE friend vec operator+(vec a, vec b) { return {a.x + b.x, a.y + b.y}; }
  ISOSHADE_INLINE friend vec operator-(vec a, vec b) { return {a.x - b.x, a.y - b.y}; }
  ISOSHADE_INLINE friend vec operator*(vec a, vec b) { return {a.x * b.x, a.y * b.y}; }
  ISOSHADE_INLINE friend vec operator/(vec a, vec b) { return {a.x / b.x, a.y / b.y}; }
  ISOSHADE_INLINE friend vec operator+(vec a, T b) { return a + vec(b); }
  ISOSHADE_INLINE friend vec operator+(T a, vec b) { return vec(a) + b; }
  ISOSHADE_INLINE friend vec operator-(vec a, T b) { return a - vec(b); }
  ISOSHADE_INLINE friend vec operator-(T a, vec b) { return vec(a) - b; }
  ISOSHADE_INLINE friend vec operator*(vec a, T b) { return a * vec(b); }
  ISOSHADE_INLINE friend vec operator*(T a, vec b) { return vec(a) * b; }
  ISOSHADE_INLINE friend vec operator/(vec a, T b) { return a / vec(b); }
  ISOSHADE_INLINE friend vec operator/(T a, vec b) { return vec(a) / b; }
  ISOSHADE_INLINE friend vec negate(vec a) { return {negate(a.x), negate(a.y)}; }
  ISOSHADE_INLINE friend vec abs(vec a) { return {abs(a.x), abs(a.y)}; }
  ISOSHADE_INLINE friend vec sqrt(vec a) { return {sqrt(a.x), sqrt(a.y)}; }
  ISOSHADE_INLINE friend vec floor(vec a) { return {floor(a.x), floor(a.y)}; }
  ISOSHADE_INLINE friend vec select(B c, vec a, vec b) { return {select(c, a.x, b.x), select(c, a.y, b.y)}; }
};

template <class T, int N>
requires(N == 3) struct vec<T, N> {
  using B = bool_of<T>;

  T x, y, z;

  vec() = default;
  ISOSHADE_INLINE explicit vec(T all) : x(all), y(all), z(all) {}
  ISOSHADE_INLINE vec(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  ISOSHADE_INLINE vec(const vec<T, 2>& xy, T z_) : x(xy.x), y(xy.y), z(z_) {}
  template <Broadcasts<T> Uniform>
  ISOSHADE_INLINE vec(const vec<Uniform, 3>& uniform) : x(uniform.x), y(uniform.y), z(uniform.z) {}

  ISOSHADE_INLINE T operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }

  ISOSHADE_INLINE friend vec operator+(vec a, vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  ISOSHADE_INLINE friend vec operator-(vec a, vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  ISOSHADE_INLINE friend vec operator*(vec a, vec b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  ISOSHADE_INLINE friend vec operator/(vec a, vec b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }
  ISOSHADE_INLINE friend vec operator+(vec a, T b) { return a + vec(b); }
  ISOSHADE_INLINE friend vec operator+(T a, vec b) { return vec(a) + b; }
  ISOSHADE_INLINE friend vec operator-(vec a, T b) { return a - vec(b); }
  ISOSHADE_INLINE friend vec operator-(T a, vec b) { return vec(a) - b; }
  ISOSHADE_INLINE friend vec operator*(vec a, T b) { return a * vec(b); }
  ISOSHADE_INLINE friend vec operator*(T a, vec b) { return vec(a) * b; }
  ISOSHADE_INLINE friend vec operator/(vec a, T b) { return a / vec(b); }
  ISOSHADE_INLINE friend vec operator/(T a, vec b) { return vec(a) / b; }
  ISOSHADE_INLINE friend vec negate(vec a) { return {negate(a.x), negate(a.y), negate(a.z)}; }
  ISOSHADE_INLINE friend vec abs(vec a) { return {abs(a.x), abs(a.y), abs(a.z)}; }
  ISOSHADE_INLINE friend vec sqrt(vec a) { return {sqrt(a.x), sqrt(a.y), sqrt(a.z)}; }
  ISOSHADE_INLINE friend vec floor(vec a) { return {floor(a.x), floor(a.y), floor(a.z)}; }
  ISOSHADE_INLINE friend vec select(B c, vec a, vec b) {
    return {select(c, a.x, b.x), select(c, a.y, b.y), select(c, a.z, b.z)};
  }
};

template <class T, int N>
requires(N == 4) struct vec<T, N> {
  using B = bool_of<T>;

  T x, y, z, w;

  vec() = default;
  ISOSHADE_INLINE explicit vec(T all) : x(all), y(all), z(all), w(all) {}
  ISOSHADE_INLINE vec(T x_, T y_, T z_, T w_) : x(x_), y(y_), z(z_), w(w_) {}
  ISOSHADE_INLINE vec(const vec<T, 3>& xyz, T w_) : x(xyz.x), y(xyz.y), z(xyz.z), w(w_) {}
  ISOSHADE_INLINE vec(const vec<T, 2>& xy, T z_, T w_) : x(xy.x), y(xy.y), z(z_), w(w_) {}
  template <Broadcasts<T> Uniform>
  ISOSHADE_INLINE vec(const vec<Uniform, 4>& uniform)
      : x(uniform.x), y(uniform.y), z(uniform.z), w(uniform.w) {}

  ISOSHADE_INLINE T operator[](int i) const { return i == 0 ? x : i == 1 ? y : i == 2 ? z : w; }

  ISOSHADE_INLINE friend vec operator+(vec a, vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w}; }
  ISOSHADE_INLINE friend vec operator-(vec a, vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w}; }
  ISOSHADE_INLINE friend vec operator*(vec a, vec b) { return {a.x * b.x, a.y * b.y, a.z * b.z, a.w * b.w}; }
  ISOSHADE_INLINE friend vec operator/(vec a, vec b) { return {a.x / b.x, a.y / b.y, a.z / b.z, a.w / b.w}; }
  ISOSHADE_INLINE friend vec operator+(vec a, T b) { return a + vec(b); }
  ISOSHADE_INLINE friend vec operator+(T a, vec b) { return vec(a) + b; }
  ISOSHADE_INLINE friend vec operator-(vec a, T b) { return a - vec(b); }
  ISOSHADE_INLINE friend vec operator-(T a, vec b) { return vec(a) - b; }
  ISOSHADE_INLINE friend vec operator*(vec a, T b) { return a * vec(b); }
  ISOSHADE_INLINE friend vec operator*(T a, vec b) { return vec(a) * b; }
  ISOSHADE_INLINE friend vec operator/(vec a, T b) { return a / vec(b); }
  ISOSHADE_INLINE friend vec operator/(T a, vec b) { return vec(a) / b; }
  ISOSHADE_INLINE friend vec negate(vec a) { return {negate(a.x), negate(a.y), negate(a.z), negate(a.w)}; }
  ISOSHADE_INLINE friend vec abs(vec a) { return {abs(a.x), abs(a.y), abs(a.z), abs(a.w)}; }
  ISOSHADE_INLINE friend vec sqrt(vec a) { return {sqrt(a.x), sqrt(a.y), sqrt(a.z), sqrt(a.w)}; }
  ISOSHADE_INLINE friend vec floor(vec a) { return {floor(a.x), floor(a.y), floor(a.z), floor(a.w)}; }
  ISOSHADE_INLINE friend vec select(B c, vec a, vec b) {
    return {select(c, a.x, b.x), select(c, a.y, b.y), select(c, a.z, b.z), select(c, a.w, b.w)};
  }
};

/// A uniform vector with a number for each lane.
#define ISOSHADE_WITH_NUMBER(op)                                                    \
  template <int W, int R, int N>                                                    \
  ISOSHADE_INLINE vec<Float<W, R>, N> operator op(vec<float, N> a, Float<W, R> b) { \
    return vec<Float<W, R>, N>(a) op b;                                             \
  }                                                                                 \
  template <int W, int R, int N>                                                    \
  ISOSHADE_INLINE vec<Float<W, R>, N> operator op(Float<W, R> a, vec<float, N> b) { \
    return a op vec<Float<W, R>, N>(b);                                             \
  }
ISOSHADE_WITH_NUMBER(+)
ISOSHADE_WITH_NUMBER(-)
ISOSHADE_WITH_NUMBER(*)
ISOSHADE_WITH_NUMBER(/)
#undef ISOSHADE_WITH_NUMBER

/// Between two uniform vectors, lane by lane.
template <int W, int R, int N>
ISOSHADE_INLINE vec<Float<W, R>, N> select(Bool<W, R> c, vec<float, N> a, vec<float, N> b) {
  return select(c, vec<Float<W, R>, N>(a), vec<Float<W, R>, N>(b));
}

}  // namespace isoshade::lanes

#endif
