// SPDX-License-Identifier: Apache-2.0
//
// Sixteen lanes: AVX-512 F, VL, DQ and BW. Masks live in mask registers, one bit a lane.
#ifndef ISOSHADE_LANES_REGISTER_AVX512_H
#define ISOSHADE_LANES_REGISTER_AVX512_H

#include "register.h"

#if ISOSHADE_SIMD && defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__) && defined(__AVX512BW__)

namespace isoshade::lanes {

template <>
struct Register<16> : Vectors<16> {
  using Mask = unsigned short;

  ISOSHADE_INLINE static Floats splat(float x) {
    return Floats{x, x, x, x, x, x, x, x, x, x, x, x, x, x, x, x};
  }
  ISOSHADE_INLINE static Ints splat(int x) { return Ints{x, x, x, x, x, x, x, x, x, x, x, x, x, x, x, x}; }
  ISOSHADE_INLINE static Ints lane_index() {
    return Ints{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  }

#if ISOSHADE_SHUFFLES
  // In each group of four lanes: the first or the last two of `a` and of `b`, in turn or one pair after the other.
  ISOSHADE_INLINE static Floats low_pairs(Floats a, Floats b) {
    return __builtin_shufflevector(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
  }
  ISOSHADE_INLINE static Floats high_pairs(Floats a, Floats b) {
    return __builtin_shufflevector(a, b, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
  }
  ISOSHADE_INLINE static Floats low_halves(Floats a, Floats b) {
    return __builtin_shufflevector(a, b, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29);
  }
  ISOSHADE_INLINE static Floats high_halves(Floats a, Floats b) {
    return __builtin_shufflevector(a, b, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
  }
#endif

  ISOSHADE_INLINE static Mask mask(bool value) { return value ? 0xffff : 0; }
  ISOSHADE_INLINE static bool any(Mask mask) { return mask != 0; }
  ISOSHADE_INLINE static bool all(Mask mask) { return mask == 0xffff; }

  // The predicates of cmpps (0 equal, 1 less, 2 less or equal: false on NaN; 4 not equal: true on NaN) and of
  // cmpd have the same numbers. The last operand says: in the current rounding mode.
  ISOSHADE_INLINE static Mask equal(Floats a, Floats b) {
    return __builtin_ia32_cmpps512_mask(a, b, 0, 0xffff, 4);
  }
  ISOSHADE_INLINE static Mask less(Floats a, Floats b) {
    return __builtin_ia32_cmpps512_mask(a, b, 1, 0xffff, 4);
  }
  ISOSHADE_INLINE static Mask less_equal(Floats a, Floats b) {
    return __builtin_ia32_cmpps512_mask(a, b, 2, 0xffff, 4);
  }
  ISOSHADE_INLINE static Mask not_equal(Floats a, Floats b) {
    return __builtin_ia32_cmpps512_mask(a, b, 4, 0xffff, 4);
  }
  ISOSHADE_INLINE static Mask equal(Ints a, Ints b) { return __builtin_ia32_cmpd512_mask(a, b, 0, 0xffff); }
  ISOSHADE_INLINE static Mask less(Ints a, Ints b) { return __builtin_ia32_cmpd512_mask(a, b, 1, 0xffff); }
  ISOSHADE_INLINE static Mask less_equal(Ints a, Ints b) {
    return __builtin_ia32_cmpd512_mask(a, b, 2, 0xffff);
  }
  ISOSHADE_INLINE static Mask not_equal(Ints a, Ints b) {
    return __builtin_ia32_cmpd512_mask(a, b, 4, 0xffff);
  }
  ISOSHADE_INLINE static Mask unsigned_less(Ints a, Ints b) {
    return __builtin_ia32_ucmpd512_mask(a, b, 1, 0xffff);
  }

#if defined(__clang__)
  ISOSHADE_INLINE static Floats blend(Mask mask, Floats then, Floats other) {
    return __builtin_ia32_selectps_512(mask, then, other);
  }
  ISOSHADE_INLINE static Ints blend(Mask mask, Ints then, Ints other) {
    return __builtin_ia32_selectd_512(mask, then, other);
  }
  ISOSHADE_INLINE static Floats sqrt(Floats x) { return __builtin_ia32_sqrtps512(x, 4); }
  ISOSHADE_INLINE static Longs multiply_even(Ints a, Ints b) {
    return (Longs)__builtin_ia32_pmuludq512(a, b);
  }
#else
  ISOSHADE_INLINE static Floats blend(Mask mask, Floats then, Floats other) {
    return __builtin_ia32_blendmps_512_mask(other, then, mask);
  }
  ISOSHADE_INLINE static Ints blend(Mask mask, Ints then, Ints other) {
    return __builtin_ia32_blendmd_512_mask(other, then, mask);
  }
  ISOSHADE_INLINE static Floats sqrt(Floats x) { return __builtin_ia32_sqrtps512_mask(x, x, -1, 4); }
  ISOSHADE_INLINE static Longs multiply_even(Ints a, Ints b) {
    typedef long long SignedLongs __attribute__((vector_size(64)));
    return (Longs)__builtin_ia32_pmuludq512_mask(a, b, SignedLongs{}, -1);
  }
#endif
  ISOSHADE_INLINE static Floats floor(Floats x) { return __builtin_ia32_rndscaleps_mask(x, 9, x, -1, 4); }
  ISOSHADE_INLINE static Ints truncate(Floats x) {
    return (Ints)__builtin_ia32_cvttps2dq512_mask(x, Ints{}, -1, 4);
  }

  ISOSHADE_INLINE static Floats gather(const float* data, Ints index) {
    return __builtin_ia32_gathersiv16sf(Floats{}, data, index, -1, 4);
  }
  ISOSHADE_INLINE static Ints gather(const int* data, Ints index) {
    return __builtin_ia32_gathersiv16si(Ints{}, data, index, -1, 4);
  }
};

}  // namespace isoshade::lanes

#endif

#endif
