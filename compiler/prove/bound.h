// SPDX-License-Identifier: Apache-2.0
// What is known of a value: which floats it may be, and how far it may lie from the value that exact arithmetic
// would have given it.
//
// The operations here are those of the language on such knowledge: for all operands within the given bounds, the
// float that the language computes lies within the resulting one, and so does its error. Correctly rounded
// operations are monotone, so the floats at the ends of a range give the ends of the result: float ranges are as
// narrow as they can be. Errors are computed in double and rounded up.
//
// All of it needs lanes::FpGuard: the ends are computed as the language computes.
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
/// |y - x| <= absolute and |y - x| <= relative * |x| + slack. Of a boolean, `absolute` is 0 if exact arithmetic
/// gives it too, and of an integer as well.
struct Bound {
  double lo = 0, hi = 0;  ///< never infinite or NaN; integers and booleans (0, 1) too
  double absolute = 0;
  double relative = 0;
  double slack = 0;
  double exact_least = -HUGE_VAL,
         exact_most = HUGE_VAL;  ///< what else is known of where the exact value lies

  double exact_lo() const;  ///< the exact value lies between these
  double exact_hi() const;
  double exact_least_magnitude() const;
  double magnitude() const;        ///< the largest |y|
  double least_magnitude() const;  ///< the smallest |y|
  bool is_point() const { return lo == hi; }
  Ends ends() const { return {lo, hi}; }
  /// The least e for which |y - x| <= e |x| + slack is known, with a slack of at most 2^-100 (what flushing takes);
  /// infinite where there is none.
  struct Share {
    double error, slack;
  };
  Share share() const;
  double relative_error() const { return share().error; }
};

/// What is not proved of an operation.
enum class Breach : uint8_t {
  none,
  division_by_zero,
  root_of_negative,
  logarithm,  ///< of a number that is not positive
  power,      ///< of a negative base, or of 0 to a negative exponent
  arc,        ///< asin or acos of more than 1
  overflow,
  conversion,  ///< to an integer that does not exist
  domain,      ///< of a function of the fast tier
  unknown,     ///< the operation is not understood
};
std::string_view words(Breach breach);  ///< "division by zero"

struct Outcome {
  Bound bound;
  Breach breach = Breach::none;  ///< `bound` holds where the breach does not happen
};

Bound exactly(double value);
Bound between(double lo, double hi);
/// Any float, error unknown.
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
/// The sum of at most `count` values within `a`, from 0 on.
Outcome sum_of(const Bound& a, double count);

/// A result that lies within [lo, hi] as exact arithmetic has it from the computed operands, and is then rounded
/// with a relative error; `carried`: how far the operands' errors moved it.
Outcome approximate(double lo, double hi, double relative_error, double carried);

/// Says that the exact value lies between what arithmetic on doubles made of ends.
void place_exact(Bound& bound, double least, double most);

/// Makes both bounds of the error as good as either is, and ends beyond the floats an overflow.
Outcome settled(Bound bound);

}  // namespace isoshade::prove
