// SPDX-License-Identifier: Apache-2.0
//
// Float, Int and Bool of two registers: everything is done to the low and to the high half. The two chains of
// instructions are independent, which keeps the processor busy while one of them waits.
// (A vector type twice as wide as a register is no substitute: compilers pass it through memory.)
#pragma once

#include "runtime/lanes/vector.h"

namespace isoshade::lanes {

template <int W>
struct Bool<W, 2> {
  using Half = Bool<W, 1>;
  using F = Float<W, 2>;
  using I = Int<W, 2>;

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
  ISOSHADE_INLINE friend I select(Bool c, int a, int b) { return select(c, I(a), I(b)); }
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

}  // namespace isoshade::lanes
