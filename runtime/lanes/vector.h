// SPDX-License-Identifier: Apache-2.0
//
// Float, Int and Bool of one register, and of two. Every function takes uniform values for lanes, for they
// convert implicitly; the overloads that take a bool condition test it once and not in every lane.
#ifndef ISOSHADE_LANES_VECTOR_H
#define ISOSHADE_LANES_VECTOR_H

#include "register.h"
#include "register_avx2.h"
#include "register_avx512.h"

namespace isoshade::lanes {

template <int W, int R>
struct Float;
template <int W, int R>
struct Int;
template <int W, int R>
struct Bool;

template <int W, int R>
struct traits<Float<W, R>> : family<Float<W, R>, Int<W, R>, Bool<W, R>, W * R> {};
template <int W, int R>
struct traits<Int<W, R>> : traits<Float<W, R>> {};
template <int W, int R>
struct traits<Bool<W, R>> : traits<Float<W, R>> {};

#if ISOSHADE_SIMD

// ---- One register.

template <int W>
struct Bool<W, 1> {
  using Raw = typename Register<W>::Mask;
  using F = Float<W, 1>;
  using Ints = Int<W, 1>;

  Raw raw;

  Bool() = default;
  ISOSHADE_INLINE Bool(bool uniform) : raw(Register<W>::mask(uniform)) {}
  ISOSHADE_INLINE static Bool of(Raw raw) {
    Bool result;
    result.raw = raw;
    return result;
  }

  ISOSHADE_INLINE friend Bool operator&(Bool a, Bool b) { return of((Raw)(a.raw & b.raw)); }
  ISOSHADE_INLINE friend Bool operator|(Bool a, Bool b) { return of((Raw)(a.raw | b.raw)); }
  ISOSHADE_INLINE friend Bool operator^(Bool a, Bool b) { return of((Raw)(a.raw ^ b.raw)); }
  ISOSHADE_INLINE friend Bool operator!(Bool a) { return of((Raw)~a.raw); }

  ISOSHADE_INLINE friend bool any(Bool a) { return Register<W>::any(a.raw); }
  ISOSHADE_INLINE friend bool all(Bool a) { return Register<W>::all(a.raw); }

  ISOSHADE_INLINE friend Bool select(Bool c, Bool a, Bool b) {
    return of((Raw)((c.raw & a.raw) | (~c.raw & b.raw)));
  }
  ISOSHADE_INLINE friend Bool select(bool c, Bool a, Bool b) { return c ? a : b; }
  ISOSHADE_INLINE friend Bool select(Bool c, bool a, bool b) { return select(c, Bool(a), Bool(b)); }
  ISOSHADE_INLINE friend F select(Bool c, float a, float b) { return select(c, F(a), F(b)); }
  ISOSHADE_INLINE friend Ints select(Bool c, int a, int b) { return select(c, Ints(a), Ints(b)); }
};

template <int W>
struct Float<W, 1> {
  using Raw = typename Vectors<W>::Floats;
  using Bits = typename Vectors<W>::Ints;
  using B = Bool<W, 1>;

  Raw raw;

  Float() = default;
  ISOSHADE_INLINE Float(float uniform) : raw(Register<W>::splat(uniform)) {}
  ISOSHADE_INLINE static Float of(Raw raw) {
    Float result;
    result.raw = raw;
    return result;
  }

  ISOSHADE_INLINE friend Float operator+(Float a, Float b) { return of(a.raw + b.raw); }
  ISOSHADE_INLINE friend Float operator-(Float a, Float b) { return of(a.raw - b.raw); }
  ISOSHADE_INLINE friend Float operator*(Float a, Float b) { return of(a.raw * b.raw); }
  ISOSHADE_INLINE friend Float operator/(Float a, Float b) { return of(a.raw / b.raw); }

  ISOSHADE_INLINE friend B operator<(Float a, Float b) { return B::of(Register<W>::less(a.raw, b.raw)); }
  ISOSHADE_INLINE friend B operator<=(Float a, Float b) {
    return B::of(Register<W>::less_equal(a.raw, b.raw));
  }
  ISOSHADE_INLINE friend B operator>(Float a, Float b) { return b < a; }
  ISOSHADE_INLINE friend B operator>=(Float a, Float b) { return b <= a; }
  ISOSHADE_INLINE friend B operator==(Float a, Float b) { return B::of(Register<W>::equal(a.raw, b.raw)); }
  ISOSHADE_INLINE friend B operator!=(Float a, Float b) {
    return B::of(Register<W>::not_equal(a.raw, b.raw));
  }

  ISOSHADE_INLINE friend Float negate(Float x) { return of((Raw)((Bits)x.raw ^ sign_bit)); }
  ISOSHADE_INLINE friend Float abs(Float x) { return of((Raw)((Bits)x.raw & ~sign_bit)); }
  ISOSHADE_INLINE friend Float sqrt(Float x) { return of(Register<W>::sqrt(x.raw)); }
  ISOSHADE_INLINE friend Float floor(Float x) { return of(Register<W>::floor(x.raw)); }

  ISOSHADE_INLINE friend Float select(B c, Float a, Float b) {
    return of(Register<W>::blend(c.raw, a.raw, b.raw));
  }
  ISOSHADE_INLINE friend Float select(bool c, Float a, Float b) { return c ? a : b; }
};

template <int W>
struct Int<W, 1> {
  using Raw = typename Vectors<W>::Ints;
  using Uints = typename Vectors<W>::Uints;
  using Longs = typename Vectors<W>::Longs;
  using B = Bool<W, 1>;
  using F = Float<W, 1>;

  Raw raw;

  Int() = default;
  ISOSHADE_INLINE Int(int uniform) : raw(Register<W>::splat(uniform)) {}
  ISOSHADE_INLINE static Int of(Raw raw) {
    Int result;
    result.raw = raw;
    return result;
  }

  // Unsigned inside: the compilers may assume that signed lanes do not overflow.
  ISOSHADE_INLINE friend Int operator+(Int a, Int b) { return of((Raw)((Uints)a.raw + (Uints)b.raw)); }
  ISOSHADE_INLINE friend Int operator-(Int a, Int b) { return of((Raw)((Uints)a.raw - (Uints)b.raw)); }
  ISOSHADE_INLINE friend Int operator*(Int a, Int b) { return of((Raw)((Uints)a.raw * (Uints)b.raw)); }
  ISOSHADE_INLINE friend Int operator&(Int a, Int b) { return of(a.raw & b.raw); }
  ISOSHADE_INLINE friend Int operator|(Int a, Int b) { return of(a.raw | b.raw); }
  ISOSHADE_INLINE friend Int operator^(Int a, Int b) { return of(a.raw ^ b.raw); }

  ISOSHADE_INLINE friend Int shift_left(Int x, Int n) { return of((Raw)((Uints)x.raw << (Uints)n.raw)); }
  ISOSHADE_INLINE friend Int shift_left(Int x, int n) { return of((Raw)((Uints)x.raw << (unsigned)n)); }
  ISOSHADE_INLINE friend Int shift_right(Int x, Int n) { return of((Raw)((Uints)x.raw >> (Uints)n.raw)); }
  ISOSHADE_INLINE friend Int shift_right(Int x, int n) { return of((Raw)((Uints)x.raw >> (unsigned)n)); }
  ISOSHADE_INLINE friend Int shift_right_signed(Int x, Int n) { return of(x.raw >> n.raw); }
  ISOSHADE_INLINE friend Int shift_right_signed(Int x, int n) { return of(x.raw >> n); }

  /// Products of even and of odd lanes, 64 bits each; the high halves are put together again.
  ISOSHADE_INLINE friend Int unsigned_mul_hi(Int a, Int b) {
    const Raw a_odd = (Raw)((Longs)a.raw >> 32), b_odd = (Raw)((Longs)b.raw >> 32);
    const Longs even = Register<W>::multiply_even(a.raw, b.raw) >> 32;
    const Longs odd = Register<W>::multiply_even(a_odd, b_odd) & 0xffffffff00000000ull;
    return of((Raw)(even | odd));
  }
  /// A negative operand counts as 2^32 too much, and the other once too often in the high half.
  ISOSHADE_INLINE friend Int mul_hi(Int a, Int b) {
    return unsigned_mul_hi(a, b) - (shift_right_signed(a, 31) & b) - (shift_right_signed(b, 31) & a);
  }

  ISOSHADE_INLINE friend B operator<(Int a, Int b) { return B::of(Register<W>::less(a.raw, b.raw)); }
  ISOSHADE_INLINE friend B operator<=(Int a, Int b) { return B::of(Register<W>::less_equal(a.raw, b.raw)); }
  ISOSHADE_INLINE friend B operator>(Int a, Int b) { return b < a; }
  ISOSHADE_INLINE friend B operator>=(Int a, Int b) { return b <= a; }
  ISOSHADE_INLINE friend B operator==(Int a, Int b) { return B::of(Register<W>::equal(a.raw, b.raw)); }
  ISOSHADE_INLINE friend B operator!=(Int a, Int b) { return B::of(Register<W>::not_equal(a.raw, b.raw)); }
  ISOSHADE_INLINE friend B unsigned_less(Int a, Int b) {
    return B::of(Register<W>::unsigned_less(a.raw, b.raw));
  }

  ISOSHADE_INLINE friend Int select(B c, Int a, Int b) { return of(Register<W>::blend(c.raw, a.raw, b.raw)); }
  ISOSHADE_INLINE friend Int select(bool c, Int a, Int b) { return c ? a : b; }
};

template <int W>
ISOSHADE_INLINE Int<W, 1> to_int(Float<W, 1> x) {
  return Int<W, 1>::of(Register<W>::truncate(x.raw));
}
template <int W>
ISOSHADE_INLINE Float<W, 1> to_float(Int<W, 1> x) {
  return Float<W, 1>::of(__builtin_convertvector(x.raw, typename Vectors<W>::Floats));
}
template <int W>
ISOSHADE_INLINE Int<W, 1> bits_nonnan(Float<W, 1> x) {
  return Int<W, 1>::of((typename Vectors<W>::Ints)x.raw);
}
template <int W>
ISOSHADE_INLINE Float<W, 1> from_bits_normal(Int<W, 1> x) {
  return Float<W, 1>::of((typename Vectors<W>::Floats)x.raw);
}

// ---- Two registers: everything is done to the low and to the high half. The two chains of instructions
// are independent, which keeps the processor busy while one of them waits. (A vector type twice as wide as a
// register is no substitute: compilers pass it through memory.)

template <int W>
struct Bool<W, 2> {
  using Half = Bool<W, 1>;
  using F = Float<W, 2>;
  using Ints = Int<W, 2>;

  Half low, high;

  Bool() = default;
  ISOSHADE_INLINE Bool(bool uniform) : low(uniform), high(uniform) {}
  ISOSHADE_INLINE Bool(Half l, Half h) : low(l), high(h) {}

  ISOSHADE_INLINE friend Bool operator&(Bool a, Bool b) { return {a.low & b.low, a.high & b.high}; }
  ISOSHADE_INLINE friend Bool operator|(Bool a, Bool b) { return {a.low | b.low, a.high | b.high}; }
  ISOSHADE_INLINE friend Bool operator^(Bool a, Bool b) { return {a.low ^ b.low, a.high ^ b.high}; }
  ISOSHADE_INLINE friend Bool operator!(Bool a) { return {!a.low, !a.high}; }

  ISOSHADE_INLINE friend bool any(Bool a) { return any(a.low | a.high); }
  ISOSHADE_INLINE friend bool all(Bool a) { return all(a.low & a.high); }

  ISOSHADE_INLINE friend Bool select(Bool c, Bool a, Bool b) {
    return {select(c.low, a.low, b.low), select(c.high, a.high, b.high)};
  }
  ISOSHADE_INLINE friend Bool select(bool c, Bool a, Bool b) { return c ? a : b; }
  ISOSHADE_INLINE friend Bool select(Bool c, bool a, bool b) { return select(c, Bool(a), Bool(b)); }
  ISOSHADE_INLINE friend F select(Bool c, float a, float b) { return select(c, F(a), F(b)); }
  ISOSHADE_INLINE friend Ints select(Bool c, int a, int b) { return select(c, Ints(a), Ints(b)); }
};

template <int W>
struct Float<W, 2> {
  using Half = Float<W, 1>;
  using B = Bool<W, 2>;

  Half low, high;

  Float() = default;
  ISOSHADE_INLINE Float(float uniform) : low(uniform), high(uniform) {}
  ISOSHADE_INLINE Float(Half l, Half h) : low(l), high(h) {}

  ISOSHADE_INLINE friend Float operator+(Float a, Float b) { return {a.low + b.low, a.high + b.high}; }
  ISOSHADE_INLINE friend Float operator-(Float a, Float b) { return {a.low - b.low, a.high - b.high}; }
  ISOSHADE_INLINE friend Float operator*(Float a, Float b) { return {a.low * b.low, a.high * b.high}; }
  ISOSHADE_INLINE friend Float operator/(Float a, Float b) { return {a.low / b.low, a.high / b.high}; }

  ISOSHADE_INLINE friend B operator<(Float a, Float b) { return {a.low < b.low, a.high < b.high}; }
  ISOSHADE_INLINE friend B operator<=(Float a, Float b) { return {a.low <= b.low, a.high <= b.high}; }
  ISOSHADE_INLINE friend B operator>(Float a, Float b) { return {a.low > b.low, a.high > b.high}; }
  ISOSHADE_INLINE friend B operator>=(Float a, Float b) { return {a.low >= b.low, a.high >= b.high}; }
  ISOSHADE_INLINE friend B operator==(Float a, Float b) { return {a.low == b.low, a.high == b.high}; }
  ISOSHADE_INLINE friend B operator!=(Float a, Float b) { return {a.low != b.low, a.high != b.high}; }

  ISOSHADE_INLINE friend Float negate(Float x) { return {negate(x.low), negate(x.high)}; }
  ISOSHADE_INLINE friend Float abs(Float x) { return {abs(x.low), abs(x.high)}; }
  ISOSHADE_INLINE friend Float sqrt(Float x) { return {sqrt(x.low), sqrt(x.high)}; }
  ISOSHADE_INLINE friend Float floor(Float x) { return {floor(x.low), floor(x.high)}; }

  ISOSHADE_INLINE friend Float select(B c, Float a, Float b) {
    return {select(c.low, a.low, b.low), select(c.high, a.high, b.high)};
  }
  ISOSHADE_INLINE friend Float select(bool c, Float a, Float b) { return c ? a : b; }
};

template <int W>
struct Int<W, 2> {
  using Half = Int<W, 1>;
  using B = Bool<W, 2>;

  Half low, high;

  Int() = default;
  ISOSHADE_INLINE Int(int uniform) : low(uniform), high(uniform) {}
  ISOSHADE_INLINE Int(Half l, Half h) : low(l), high(h) {}

  ISOSHADE_INLINE friend Int operator+(Int a, Int b) { return {a.low + b.low, a.high + b.high}; }
  ISOSHADE_INLINE friend Int operator-(Int a, Int b) { return {a.low - b.low, a.high - b.high}; }
  ISOSHADE_INLINE friend Int operator*(Int a, Int b) { return {a.low * b.low, a.high * b.high}; }
  ISOSHADE_INLINE friend Int operator&(Int a, Int b) { return {a.low & b.low, a.high & b.high}; }
  ISOSHADE_INLINE friend Int operator|(Int a, Int b) { return {a.low | b.low, a.high | b.high}; }
  ISOSHADE_INLINE friend Int operator^(Int a, Int b) { return {a.low ^ b.low, a.high ^ b.high}; }

  ISOSHADE_INLINE friend Int shift_left(Int x, Int n) {
    return {shift_left(x.low, n.low), shift_left(x.high, n.high)};
  }
  ISOSHADE_INLINE friend Int shift_left(Int x, int n) {
    return {shift_left(x.low, n), shift_left(x.high, n)};
  }
  ISOSHADE_INLINE friend Int shift_right(Int x, Int n) {
    return {shift_right(x.low, n.low), shift_right(x.high, n.high)};
  }
  ISOSHADE_INLINE friend Int shift_right(Int x, int n) {
    return {shift_right(x.low, n), shift_right(x.high, n)};
  }
  ISOSHADE_INLINE friend Int shift_right_signed(Int x, Int n) {
    return {shift_right_signed(x.low, n.low), shift_right_signed(x.high, n.high)};
  }
  ISOSHADE_INLINE friend Int shift_right_signed(Int x, int n) {
    return {shift_right_signed(x.low, n), shift_right_signed(x.high, n)};
  }

  ISOSHADE_INLINE friend Int unsigned_mul_hi(Int a, Int b) {
    return {unsigned_mul_hi(a.low, b.low), unsigned_mul_hi(a.high, b.high)};
  }
  ISOSHADE_INLINE friend Int mul_hi(Int a, Int b) { return {mul_hi(a.low, b.low), mul_hi(a.high, b.high)}; }

  ISOSHADE_INLINE friend B operator<(Int a, Int b) { return {a.low < b.low, a.high < b.high}; }
  ISOSHADE_INLINE friend B operator<=(Int a, Int b) { return {a.low <= b.low, a.high <= b.high}; }
  ISOSHADE_INLINE friend B operator>(Int a, Int b) { return {a.low > b.low, a.high > b.high}; }
  ISOSHADE_INLINE friend B operator>=(Int a, Int b) { return {a.low >= b.low, a.high >= b.high}; }
  ISOSHADE_INLINE friend B operator==(Int a, Int b) { return {a.low == b.low, a.high == b.high}; }
  ISOSHADE_INLINE friend B operator!=(Int a, Int b) { return {a.low != b.low, a.high != b.high}; }
  ISOSHADE_INLINE friend B unsigned_less(Int a, Int b) {
    return {unsigned_less(a.low, b.low), unsigned_less(a.high, b.high)};
  }

  ISOSHADE_INLINE friend Int select(B c, Int a, Int b) {
    return {select(c.low, a.low, b.low), select(c.high, a.high, b.high)};
  }
  ISOSHADE_INLINE friend Int select(bool c, Int a, Int b) { return c ? a : b; }
};

template <int W>
ISOSHADE_INLINE Int<W, 2> to_int(Float<W, 2> x) {
  return {to_int(x.low), to_int(x.high)};
}
template <int W>
ISOSHADE_INLINE Float<W, 2> to_float(Int<W, 2> x) {
  return {to_float(x.low), to_float(x.high)};
}
template <int W>
ISOSHADE_INLINE Int<W, 2> bits_nonnan(Float<W, 2> x) {
  return {bits_nonnan(x.low), bits_nonnan(x.high)};
}
template <int W>
ISOSHADE_INLINE Float<W, 2> from_bits_normal(Int<W, 2> x) {
  return {from_bits_normal(x.low), from_bits_normal(x.high)};
}

// ---- The same text for any number of registers.

template <int W, int R>
ISOSHADE_INLINE Int<W, R> bits(Float<W, R> x) {
  return select(x == x, bits_nonnan(x), canonical_nan);
}
template <int W, int R>
ISOSHADE_INLINE Float<W, R> from_bits(Int<W, R> x) {
  return from_bits_normal(select((x & exponent_bits) == 0, x & sign_bit, x));
}

#endif

}  // namespace isoshade::lanes

#endif
