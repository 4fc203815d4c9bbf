// SPDX-License-Identifier: Apache-2.0
// The reference's number type: MPFR numbers of a fixed precision, with operators.
#pragma once

#include <concepts>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <mpfr.h>
#include <string>

namespace isoshade::reference {

/// A number of 192 bits, that is 57 decimal digits; every result is rounded to nearest. The exponent range is MPFR's,
/// so floats' overflow and underflow do not happen. Infinities, one NaN and signed zeros behave as in IEEE 754: 1 / 0
/// is infinite, 0 / 0 is NaN, and every comparison with NaN but != is false.
class Real {
 public:
  static constexpr mpfr_prec_t bits = 192;

  Real() : Real(0) {}
  template <std::integral T>
  Real(T x) {
    initialize();
    mpfr_set_si(value_, static_cast<long>(x), MPFR_RNDN);
  }
  template <std::floating_point T>
  Real(T x) {
    initialize();
    if constexpr (sizeof(T) <= sizeof(double))
      mpfr_set_d(value_, x, MPFR_RNDN);
    else
      mpfr_set_ld(value_, x, MPFR_RNDN);
  }
  /// Parses a decimal number; anything else becomes NaN.
  explicit Real(const std::string& decimal) {
    initialize();
    if (mpfr_set_str(value_, decimal.c_str(), 10, MPFR_RNDN) != 0) mpfr_set_nan(value_);
  }
  Real(const Real& other) {
    initialize();
    mpfr_set(value_, other.value_, MPFR_RNDN);
  }
  Real& operator=(const Real& other) {
    mpfr_set(value_, other.value_, MPFR_RNDN);
    return *this;
  }

  /// Truncates and saturates. NaN becomes 0.
  explicit operator int64_t() const { return mpfr_get_si(value_, MPFR_RNDZ); }
  explicit operator double() const { return mpfr_get_d(value_, MPFR_RNDN); }
  /// Rounds to nearest; the result may be infinite or denormal.
  explicit operator float() const { return mpfr_get_flt(value_, MPFR_RNDN); }

  bool is_nan() const { return mpfr_nan_p(value_) != 0; }
  bool is_finite() const { return mpfr_number_p(value_) != 0; }

  /// Decimal, of `digits` significant digits; "inf", "-inf", "nan".
  std::string text(int digits) const {
    char buffer[128];
    mpfr_snprintf(buffer, sizeof buffer, "%.*Rg", digits, value_);
    return buffer;
  }

  mpfr_ptr get() { return value_; }
  mpfr_srcptr get() const { return value_; }

 private:
  void initialize() {
    mpfr_custom_init(limbs_, bits);
    mpfr_custom_init_set(value_, MPFR_ZERO_KIND, 0, bits, limbs_);
  }

  mp_limb_t limbs_[bits / (8 * sizeof(mp_limb_t))];  // not on the heap: millions of numbers are made
  mpfr_t value_;
};

#define UNARY(name, function)        \
  inline Real name(const Real& a) {  \
    Real result;                     \
    function(result.get(), a.get()); \
    return result;                   \
  }
#define ROUNDED(name, function)                 \
  inline Real name(const Real& a) {             \
    Real result;                                \
    function(result.get(), a.get(), MPFR_RNDN); \
    return result;                              \
  }
#define BINARY(name, function)                           \
  inline Real name(const Real& a, const Real& b) {       \
    Real result;                                         \
    function(result.get(), a.get(), b.get(), MPFR_RNDN); \
    return result;                                       \
  }
#define COMPARISON(op, function) \
  inline bool operator op(const Real& a, const Real& b) { return function(a.get(), b.get()) != 0; }

BINARY(operator+, mpfr_add)
BINARY(operator-, mpfr_sub)
BINARY(operator*, mpfr_mul)
BINARY(operator/, mpfr_div)
BINARY(pow, mpfr_pow)
BINARY(atan2, mpfr_atan2)
BINARY(fmod, mpfr_fmod)
ROUNDED(operator-, mpfr_neg)
ROUNDED(abs, mpfr_abs)
ROUNDED(sqrt, mpfr_sqrt)
ROUNDED(exp, mpfr_exp)
ROUNDED(exp2, mpfr_exp2)
ROUNDED(log, mpfr_log)
ROUNDED(log2, mpfr_log2)
ROUNDED(sin, mpfr_sin)
ROUNDED(cos, mpfr_cos)
ROUNDED(tan, mpfr_tan)
ROUNDED(asin, mpfr_asin)
ROUNDED(acos, mpfr_acos)
ROUNDED(atan, mpfr_atan)
UNARY(floor, mpfr_floor)
UNARY(ceil, mpfr_ceil)
COMPARISON(==, mpfr_equal_p)
COMPARISON(<, mpfr_less_p)
COMPARISON(<=, mpfr_lessequal_p)
COMPARISON(>, mpfr_greater_p)
COMPARISON(>=, mpfr_greaterequal_p)
inline bool operator!=(const Real& a, const Real& b) { return !(a == b); }

#undef UNARY
#undef ROUNDED
#undef BINARY
#undef COMPARISON

inline Real& operator+=(Real& a, const Real& b) { return a = a + b; }
inline Real& operator-=(Real& a, const Real& b) { return a = a - b; }
inline Real& operator*=(Real& a, const Real& b) { return a = a * b; }
inline Real& operator/=(Real& a, const Real& b) { return a = a / b; }

/// The float that a backend would store: rounded to nearest, denormals flushed, NaN as 0x7fc00000.
float stored(const Real& x);

}  // namespace isoshade::reference

template <>
struct std::numeric_limits<isoshade::reference::Real> {
  static constexpr bool is_specialized = true;
  static constexpr int digits = isoshade::reference::Real::bits;
  static isoshade::reference::Real quiet_NaN() { return std::numeric_limits<double>::quiet_NaN(); }
};
