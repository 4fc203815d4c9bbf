// SPDX-License-Identifier: Apache-2.0
//
// The operations on one lane: plain float, int and bool. These are also the uniform values of wider code.
// + - * / on float and + - * & | ^ and comparisons on int are the language's own.
#ifndef ISOSHADE_LANES_SCALAR_H
#define ISOSHADE_LANES_SCALAR_H

#include "float_rules.h"

#if !defined(__GNUC__)
#include <cmath>
#endif

namespace isoshade::lanes {

/// The family a type belongs to: its float, int and bool type of the same lanes. Specialise it to run the
/// function library over a type of your own.
template <class T>
struct traits;

template <class FloatType, class IntType, class BoolType, int lanes>
struct family {
  using Float = FloatType;
  using Int = IntType;
  using Bool = BoolType;
  static constexpr int count = lanes;
};

template <>
struct traits<float> : family<float, int, bool, 1> {};
template <>
struct traits<int> : family<float, int, bool, 1> {};
template <>
struct traits<bool> : family<float, int, bool, 1> {};

template <class T>
using float_of = typename traits<T>::Float;
template <class T>
using int_of = typename traits<T>::Int;
template <class T>
using bool_of = typename traits<T>::Bool;
template <class T>
inline constexpr int lane_count = traits<T>::count;

inline constexpr int sign_bit = static_cast<int>(0x80000000u);
inline constexpr int exponent_bits = 0x7f800000;
inline constexpr int canonical_nan = 0x7fc00000;
inline constexpr int two_to_the_23 = 0x4b000000;  // as a float: from here on every float is whole

/// Whether any lane is true.
ISOSHADE_INLINE bool any(bool value) { return value; }
/// Whether all lanes are true.
ISOSHADE_INLINE bool all(bool value) { return value; }

/// One of two values, bit for bit; the other is never looked at.
template <class T>
ISOSHADE_INLINE T select(bool condition, T then, T other) {
  return condition ? then : other;
}

/// The bits of a float, without canonicalising NaN.
ISOSHADE_INLINE int bits_nonnan(float x) { return __builtin_bit_cast(int, x); }
/// The bits of a float; every NaN gives 0x7fc00000.
ISOSHADE_INLINE int bits(float x) { return x == x ? bits_nonnan(x) : canonical_nan; }
/// The float of these bits, which are not those of a denormal.
ISOSHADE_INLINE float from_bits_normal(int x) { return __builtin_bit_cast(float, x); }
/// The float of these bits; a denormal gives the zero of its sign.
ISOSHADE_INLINE float from_bits(int x) {
  return from_bits_normal((x & exponent_bits) == 0 ? x & sign_bit : x);
}

/// Toward zero. x within the range of int; otherwise the least int.
ISOSHADE_INLINE int to_int(float x) {
#if ISOSHADE_SIMD
  typedef float Floats __attribute__((vector_size(16)));
  return __builtin_ia32_cvttss2si(Floats{x, 0, 0, 0});
#else
  return x >= -2147483648.0f && x < 2147483648.0f ? static_cast<int>(x) : sign_bit;
#endif
}
/// To nearest even.
ISOSHADE_INLINE float to_float(int x) { return static_cast<float>(x); }

ISOSHADE_INLINE float negate(float x) { return -x; }
ISOSHADE_INLINE float abs(float x) {
#if defined(__GNUC__)
  return __builtin_fabsf(x);
#else
  return from_bits_normal(bits_nonnan(x) & ~sign_bit);
#endif
}

/// Correctly rounded; the square root of a negative number is NaN, of -0 it is -0.
ISOSHADE_INLINE float sqrt(float x) {
  // Not __builtin_sqrtf where there is another way: it calls the C library to set errno.
#if ISOSHADE_SIMD
  typedef float Floats __attribute__((vector_size(16)));
  return __builtin_ia32_sqrtss(Floats{x, 0, 0, 0})[0];
#elif defined(__aarch64__) && defined(__GNUC__)
  float root;
  asm("fsqrt %s0, %s1" : "=w"(root) : "w"(x));
  return root;
#elif defined(__GNUC__)
  return __builtin_sqrtf(x);
#else
  return std::sqrt(x);
#endif
}

/// The largest whole number not above x; keeps -0, infinities and NaN.
ISOSHADE_INLINE float floor(float x) {
#if ISOSHADE_SIMD && defined(__SSE4_1__)
  typedef float Floats __attribute__((vector_size(16)));
  constexpr int down_and_quiet = 9;
  const Floats lanes = {x, 0, 0, 0};
  return __builtin_ia32_roundss(lanes, lanes, down_and_quiet)[0];
#else
  const int pattern = bits_nonnan(x);
  if ((pattern & ~sign_bit) >= two_to_the_23) return x;
  const float truncated = to_float(to_int(x));
  const float result = truncated - (truncated > x ? 1.0f : 0.0f);
  return from_bits_normal(bits_nonnan(result) | (pattern & sign_bit));
#endif
}

// Shifts by 0 to 31.

ISOSHADE_INLINE int shift_left(int x, int amount) {
  return static_cast<int>(static_cast<unsigned>(x) << (amount & 31));
}
/// Zeros come in.
ISOSHADE_INLINE int shift_right(int x, int amount) {
  return static_cast<int>(static_cast<unsigned>(x) >> (amount & 31));
}
/// The sign comes in.
ISOSHADE_INLINE int shift_right_signed(int x, int amount) { return x >> (amount & 31); }

/// The high 32 bits of the signed 64-bit product.
ISOSHADE_INLINE int mul_hi(int a, int b) { return static_cast<int>((static_cast<long long>(a) * b) >> 32); }
/// The high 32 bits of the unsigned 64-bit product.
ISOSHADE_INLINE int unsigned_mul_hi(int a, int b) {
  const unsigned long long product =
      static_cast<unsigned long long>(static_cast<unsigned>(a)) * static_cast<unsigned>(b);
  return static_cast<int>(product >> 32);
}
ISOSHADE_INLINE bool unsigned_less(int a, int b) {
  return static_cast<unsigned>(a) < static_cast<unsigned>(b);
}

}  // namespace isoshade::lanes

#endif
