// SPDX-License-Identifier: Apache-2.0
//
// Eight lanes: AVX2.
#ifndef ISOSHADE_LANES_REGISTER_AVX2_H
#define ISOSHADE_LANES_REGISTER_AVX2_H

#include "register.h"

#if ISOSHADE_SIMD && defined(__AVX2__)

namespace isoshade::lanes {

template <>
struct Register<8> : VectorMasks<8> {
  using VectorMasks<8>::blend;

  ISOSHADE_INLINE static Floats splat(float x) { return Floats{x, x, x, x, x, x, x, x}; }
  ISOSHADE_INLINE static Ints splat(int x) { return Ints{x, x, x, x, x, x, x, x}; }
  ISOSHADE_INLINE static Ints lane_index() { return Ints{0, 1, 2, 3, 4, 5, 6, 7}; }

#if ISOSHADE_SHUFFLES
  // In each group of four lanes: the first or the last two of `a` and of `b`, in turn or one pair after the other.
  ISOSHADE_INLINE static Floats low_pairs(Floats a, Floats b) {
    return __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  }
  ISOSHADE_INLINE static Floats high_pairs(Floats a, Floats b) {
    return __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  }
  ISOSHADE_INLINE static Floats low_halves(Floats a, Floats b) {
    return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
  }
  ISOSHADE_INLINE static Floats high_halves(Floats a, Floats b) {
    return __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
  }
#endif

  ISOSHADE_INLINE static bool any(Mask mask) { return __builtin_ia32_movmskps256((Floats)mask) != 0; }
  ISOSHADE_INLINE static bool all(Mask mask) { return __builtin_ia32_movmskps256((Floats)mask) == 0xff; }
  ISOSHADE_INLINE static Floats blend(Mask mask, Floats then, Floats other) {
    return __builtin_ia32_blendvps256(other, then, (Floats)mask);
  }

  ISOSHADE_INLINE static Floats sqrt(Floats x) { return __builtin_ia32_sqrtps256(x); }
  ISOSHADE_INLINE static Floats floor(Floats x) { return __builtin_ia32_roundps256(x, 9); }
  ISOSHADE_INLINE static Ints truncate(Floats x) { return (Ints)__builtin_ia32_cvttps2dq256(x); }
  ISOSHADE_INLINE static Longs multiply_even(Ints a, Ints b) {
    return (Longs)__builtin_ia32_pmuludq256(a, b);
  }

#if defined(__clang__)
  ISOSHADE_INLINE static Floats gather(const float* data, Ints index) {
    return __builtin_ia32_gatherd_ps256(Floats{}, data, index, (Floats)mask(true), 4);
  }
  ISOSHADE_INLINE static Ints gather(const int* data, Ints index) {
    return __builtin_ia32_gatherd_d256(Ints{}, data, index, mask(true), 4);
  }
#else
  ISOSHADE_INLINE static Floats gather(const float* data, Ints index) {
    return __builtin_ia32_gathersiv8sf(Floats{}, data, index, (Floats)mask(true), 4);
  }
  ISOSHADE_INLINE static Ints gather(const int* data, Ints index) {
    return __builtin_ia32_gathersiv8si(Ints{}, data, index, mask(true), 4);
  }
#endif
};

}  // namespace isoshade::lanes

#endif

#endif
