// SPDX-License-Identifier: Apache-2.0
//
// One SIMD register: the vector types of the compiler, and under one name the few instructions that its
// operators do not reach. Register<W> exists where the instruction set that the file is compiled for has
// registers of W lanes.
#ifndef ISOSHADE_LANES_REGISTER_H
#define ISOSHADE_LANES_REGISTER_H

#include "scalar.h"

namespace isoshade::lanes {

template <int W>
struct Register;

#if ISOSHADE_SIMD

// g++ has them from version 12 on.
#if defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define ISOSHADE_SHUFFLES 1
#endif
#endif
#ifndef ISOSHADE_SHUFFLES
#define ISOSHADE_SHUFFLES 0
#endif

template <int W>
struct Vectors {
  typedef float Floats __attribute__((vector_size(4 * W)));
  typedef int Ints __attribute__((vector_size(4 * W)));
  typedef unsigned Uints __attribute__((vector_size(4 * W)));
  typedef unsigned long long Longs __attribute__((vector_size(4 * W)));
};

/// Masks as vectors: each lane all ones or all zeros.
template <int W>
struct VectorMasks : Vectors<W> {
  using typename Vectors<W>::Floats;
  using typename Vectors<W>::Ints;
  using typename Vectors<W>::Uints;
  using Mask = Ints;

  ISOSHADE_INLINE static Mask mask(bool value) { return Register<W>::splat(value ? -1 : 0); }

  ISOSHADE_INLINE static Mask less(Floats a, Floats b) { return (Mask)(a < b); }
  ISOSHADE_INLINE static Mask less_equal(Floats a, Floats b) { return (Mask)(a <= b); }
  ISOSHADE_INLINE static Mask equal(Floats a, Floats b) { return (Mask)(a == b); }
  ISOSHADE_INLINE static Mask not_equal(Floats a, Floats b) { return (Mask)(a != b); }

  ISOSHADE_INLINE static Mask less(Ints a, Ints b) { return (Mask)(a < b); }
  ISOSHADE_INLINE static Mask less_equal(Ints a, Ints b) { return (Mask)(a <= b); }
  ISOSHADE_INLINE static Mask equal(Ints a, Ints b) { return (Mask)(a == b); }
  ISOSHADE_INLINE static Mask not_equal(Ints a, Ints b) { return (Mask)(a != b); }
  ISOSHADE_INLINE static Mask unsigned_less(Ints a, Ints b) { return (Mask)((Uints)a < (Uints)b); }

  ISOSHADE_INLINE static Ints blend(Mask mask, Ints then, Ints other) {
    return (mask & then) | (~mask & other);
  }
  ISOSHADE_INLINE static Floats blend(Mask mask, Floats then, Floats other) {
    return (Floats)blend(mask, (Ints)then, (Ints)other);
  }
};

/// Four lanes: SSE2, what every x86-64 has.
template <>
struct Register<4> : VectorMasks<4> {
  using VectorMasks<4>::blend;

  ISOSHADE_INLINE static Floats splat(float x) { return Floats{x, x, x, x}; }
  ISOSHADE_INLINE static Ints splat(int x) { return Ints{x, x, x, x}; }
  ISOSHADE_INLINE static Ints lane_index() { return Ints{0, 1, 2, 3}; }

#if ISOSHADE_SHUFFLES
  // In each group of four lanes: the first or the last two of `a` and of `b`, in turn or one pair after the other.
  ISOSHADE_INLINE static Floats low_pairs(Floats a, Floats b) {
    return __builtin_shufflevector(a, b, 0, 4, 1, 5);
  }
  ISOSHADE_INLINE static Floats high_pairs(Floats a, Floats b) {
    return __builtin_shufflevector(a, b, 2, 6, 3, 7);
  }
  ISOSHADE_INLINE static Floats low_halves(Floats a, Floats b) {
    return __builtin_shufflevector(a, b, 0, 1, 4, 5);
  }
  ISOSHADE_INLINE static Floats high_halves(Floats a, Floats b) {
    return __builtin_shufflevector(a, b, 2, 3, 6, 7);
  }
#endif

  ISOSHADE_INLINE static bool any(Mask mask) { return __builtin_ia32_movmskps((Floats)mask) != 0; }
  ISOSHADE_INLINE static bool all(Mask mask) { return __builtin_ia32_movmskps((Floats)mask) == 0xf; }

  ISOSHADE_INLINE static Floats sqrt(Floats x) { return __builtin_ia32_sqrtps(x); }
  ISOSHADE_INLINE static Ints truncate(Floats x) { return (Ints)__builtin_ia32_cvttps2dq(x); }
  ISOSHADE_INLINE static Longs multiply_even(Ints a, Ints b) {
    return (Longs)__builtin_ia32_pmuludq128(a, b);
  }

#if defined(__SSE4_1__)
  ISOSHADE_INLINE static Floats blend(Mask mask, Floats then, Floats other) {
    return __builtin_ia32_blendvps(other, then, (Floats)mask);
  }
  ISOSHADE_INLINE static Floats floor(Floats x) { return __builtin_ia32_roundps(x, 9); }
#else
  ISOSHADE_INLINE static Floats floor(Floats x) {
    const Ints pattern = (Ints)x;
    const Floats truncated = __builtin_convertvector(truncate(x), Floats);
    const Floats one_if_above = (Floats)((Ints)(truncated > x) & (Ints)splat(1.0f));
    const Ints result = (Ints)(truncated - one_if_above) | (pattern & sign_bit);
    return (Floats)blend((Mask)((pattern & ~sign_bit) < two_to_the_23), result, pattern);
  }
#endif

#if defined(__AVX2__) && defined(__clang__)
  ISOSHADE_INLINE static Floats gather(const float* data, Ints index) {
    return __builtin_ia32_gatherd_ps(Floats{}, data, index, (Floats)mask(true), 4);
  }
  ISOSHADE_INLINE static Ints gather(const int* data, Ints index) {
    return __builtin_ia32_gatherd_d(Ints{}, data, index, mask(true), 4);
  }
#elif defined(__AVX2__)
  ISOSHADE_INLINE static Floats gather(const float* data, Ints index) {
    return __builtin_ia32_gathersiv4sf(Floats{}, data, index, (Floats)mask(true), 4);
  }
  ISOSHADE_INLINE static Ints gather(const int* data, Ints index) {
    return __builtin_ia32_gathersiv4si(Ints{}, data, index, mask(true), 4);
  }
#else
  ISOSHADE_INLINE static Floats gather(const float* data, Ints index) {
    return Floats{data[index[0]], data[index[1]], data[index[2]], data[index[3]]};
  }
  ISOSHADE_INLINE static Ints gather(const int* data, Ints index) {
    return Ints{data[index[0]], data[index[1]], data[index[2]], data[index[3]]};
  }
#endif
};

#endif

}  // namespace isoshade::lanes

#endif
