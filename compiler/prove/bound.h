// SPDX-License-Identifier: Apache-2.0
// Interval arithmetic with errors: a Bound says which floats a value may be, and how far it may lie from its value in
// exact arithmetic.
//
// For all operands within the given bounds, the float that an op computes lies within the resulting bound, and so does
// its error. Correctly rounded operations are monotone, so the ends of the operands' ranges give the ends of the
// result: the ranges of floats are as narrow as possible (ends.h). Errors are computed in double and rounded up.
//
// All of it needs lanes::FpGuard, because the ends are computed as the ops compute.
#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

#include "compiler/prove/ends.h"

namespace isoshade::prove {

inline constexpr double half_ulp = 0x1p-24;  ///< the relative error of a rounding
inline constexpr double largest = 0x1.fffffep127;
inline constexpr double smallest = 0x1p-126;  ///< below it results are zeros

/// A value and its error. The exact value `x` and the computed one, `y`, satisfy lo <= y <= hi,
/// |y - x| <= absolute and |y - x| <= relative * |x| + slack. For a boolean or an integer, `absolute` is 0 if it is the
/// same in exact arithmetic.
struct Bound {
  double lo = 0, hi = 0;  ///< never infinite or NaN; integers and booleans (0, 1) too
  double absolute = 0;
  double relative = 0;
  double slack = 0;
  /// What else is known of where the exact value lies.
  double exact_least = -HUGE_VAL, exact_most = HUGE_VAL;

  double exact_lo() const;  ///< the exact value lies between these
  double exact_hi() const;
  double exact_least_magnitude() const;
  double magnitude() const;        ///< the largest |y|
  double least_magnitude() const;  ///< the smallest |y|
  bool is_point() const { return lo == hi; }
  Ends ends() const { return {lo, hi}; }
  /// The least e for which |y - x| <= e |x| + slack is known, with a slack of at most 2^-100 (for flushing); infinite
  /// if there is none.
  struct Share {
    double error, slack;
  };
  Share share() const;
  double relative_error() const { return share().error; }
};

/// What an operation could not be proved to avoid.
enum class Breach : uint8_t {
  none,
  division_by_zero,
  root_of_negative,
  logarithm,  ///< of a number that is not positive
  power,      ///< of a negative base, or of 0 to a negative exponent
  arc,        ///< asin or acos of more than 1
  overflow,
  conversion,  ///< to an integer that does not exist
  domain,      ///< an argument outside the domain of a function of the fast tier
  unknown,     ///< the prover does not understand the operation
};
std::string_view words(Breach breach);  ///< "division by zero"

struct Outcome {
  Bound bound;
  Breach breach = Breach::none;  ///< `bound` holds for operands without the breach
};

Bound exactly(double value);
Bound between(double lo, double hi);
/// Any float, with an unknown error.
Bound anything();

Outcome add(const Bound& a, const Bound& b);
Outcome subtract(const Bound& a, const Bound& b);
Outcome multiply(const Bound& a, const Bound& b);
/// a * a
Outcome square(const Bound& a);
Outcome divide(const Bound& a, const Bound& b);
Outcome square_root(const Bound& a);
Bound negate(const Bound& a);
Bound magnitude(const Bound& a);
Bound floor_of(const Bound& a);
Bound lesser(const Bound& a, const Bound& b);
Bound greater(const Bound& a, const Bound& b);
Bound select(const Bound& condition, const Bound& then, const Bound& other);
/// Of any primitive op but select, by its range rule. `b` is not looked at where the op is unary; `same`: both operands
/// are one value.
Outcome bound_of(ir::Opcode op, const Bound& a, const Bound& b, bool same = false);
/// The sum of at most `count` values within `a`, starting from 0.
Outcome sum_of(const Bound& a, double count);

/// A result that lies within [lo, hi] if computed exactly from the computed operands, and that is then rounded with a
/// relative error; `carried`: how far the operands' errors move it.
Outcome approximate(double lo, double hi, double relative_error, double carried);

/// Records that the exact value lies between these, which were computed in double.
void place_exact(Bound& bound, double least, double most);

/// Tightens each bound of the error by the other, and makes ends beyond the largest float an overflow.
Outcome settled(Bound bound);

}  // namespace isoshade::prove
