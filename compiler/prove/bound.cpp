// SPDX-License-Identifier: Apache-2.0
#include "compiler/prove/bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isoshade::prove {
namespace {

using ir::RangeRule;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// An upper bound of the exact value, where `x` was computed by a few sums and products of positive doubles.
double up(double x) { return x * (1 + 0x1p-44); }
/// A product of errors, in which 0 * infinity is 0: an unknown error does no harm if its factor is 0.
double times(double a, double b) { return a == 0 || b == 0 ? 0 : a * b; }

/// The range of the result, for rules that give one for all operands.
Bound computed(ir::RangeRule rule, const Bound& a, const Bound& b, bool same = false) {
  const Ends ends = *ends_of(rule, a.ends(), b.ends(), same);
  return {ends.lo, ends.hi};
}

/// Lower and upper bounds of the exact value, where `x` was computed by a few operations on doubles.
double outward_down(double x) { return x - std::abs(x) * 0x1p-44 - 1e-300; }
double outward_up(double x) { return -outward_down(-x); }

/// place_exact for an operation that is monotone in both operands.
template <class Operation>
void place_exact_corners(Bound& r, const Bound& a, const Bound& b, Operation operation) {
  const double al = a.exact_lo(), ah = a.exact_hi(), bl = b.exact_lo(), bh = b.exact_hi();
  const std::initializer_list<double> ends = {operation(al, bl), operation(al, bh), operation(ah, bl),
                                              operation(ah, bh)};
  // If an end is unknown, infinity / infinity may be anything.
  if (std::ranges::any_of(ends, [](double end) { return std::isnan(end); })) return;
  const auto [lo, hi] = std::minmax(ends);
  place_exact(r, lo, hi);
}

bool same_sign(const Bound& a, const Bound& b) {
  return (a.lo >= 0 && b.lo >= 0) || (a.hi <= 0 && b.hi <= 0);
}

/// Whether a - b is exact by Sterbenz's lemma: both of one sign, neither more than twice the other.
bool difference_is_exact(const Bound& a, const Bound& b) {
  if (!same_sign(a, b)) return false;
  const double a_least = a.least_magnitude(), b_least = b.least_magnitude();
  return a.magnitude() <= 2 * b_least && b.magnitude() <= 2 * a_least;
}

/// The largest error by flushing of results in this range: 0 if it does not contain 0.
double flushed_from(const Bound& r) { return r.lo > 0 || r.hi < 0 ? 0 : smallest; }

/// How far beyond 0 the exact value may lie, on the other side than the computed one.
double beyond_zero(const Bound& a) {
  if (a.slack == 0 && a.relative < 1) return 0;
  return a.relative < 1 ? a.slack / (1 - a.relative) : infinity;
}

bool is_power_of_two(const Bound& a) {
  int exponent = 0;
  return a.is_point() && a.absolute == 0 && a.lo != 0 && std::abs(std::frexp(a.lo, &exponent)) == 0.5;
}

/// Completes the bound of a product; `r` has the range of the computed product.
Outcome product(const Bound& a, const Bound& b, Bound r, bool rounds) {
  place_exact_corners(r, a, b, times);
  const double u = rounds ? half_ulp : 0;
  const bool grows = !rounds && (a.least_magnitude() >= 1 || b.least_magnitude() >= 1);  // by a power of two
  const double flush = grows ? 0 : flushed_from(r);
  r.absolute = times(a.magnitude(), b.absolute) + times(b.magnitude(), a.absolute) +
               times(a.absolute, b.absolute) + times(u, r.magnitude()) + flush;
  const double carried = a.relative + b.relative + times(a.relative, b.relative);
  r.relative = carried + u * (1 + carried);
  const double a_exact = a.magnitude() + a.absolute, b_exact = b.magnitude() + b.absolute;
  r.slack = (times(times(a_exact, 1 + a.relative), b.slack) + times(times(b_exact, 1 + b.relative), a.slack) +
             times(a.slack, b.slack)) *
                (1 + u) +
            flush;
  if (a.lo == 0 && a.hi == 0 && a.absolute == 0) return {exactly(0)};
  if (b.lo == 0 && b.hi == 0 && b.absolute == 0) return {exactly(0)};
  return settled(r);
}

/// a / b where b is not 0; the error is unknown.
Bound quotient_by_nonzero(const Bound& a, const Bound& b) {
  Bound r = anything();
  if (b.lo == 0 && b.hi == 0) return r;
  Ends ends{infinity, -infinity};
  const auto take = [&](double lo, double hi) {
    const Bound part = computed(RangeRule::quotient, a, between(lo, hi));
    ends = {std::min(ends.lo, part.lo), std::max(ends.hi, part.hi)};
  };
  if (b.hi >= smallest) take(smallest, b.hi);
  if (b.lo <= -smallest) take(b.lo, -smallest);
  r.lo = std::clamp(ends.lo, -largest, largest);
  r.hi = std::clamp(ends.hi, -largest, largest);
  return r;
}

}  // namespace

double Bound::magnitude() const { return magnitudes(ends()).hi; }
double Bound::least_magnitude() const { return magnitudes(ends()).lo; }

double Bound::exact_lo() const {
  double least = std::max(exact_least, lo - absolute);
  if (relative < 1 && lo >= slack) least = std::max(least, outward_down((lo - slack) / (1 + relative)));
  if (relative < 1 && lo < slack) least = std::max(least, outward_down((lo - slack) / (1 - relative)));
  return least;
}
double Bound::exact_hi() const {
  const Bound mirrored{-hi, -lo, absolute, relative, slack, -exact_most, -exact_least};
  return -mirrored.exact_lo();
}
double Bound::exact_least_magnitude() const { return std::max({0.0, exact_lo(), -exact_hi()}); }

Bound::Share Bound::share() const {
  const double least = exact_least_magnitude();
  const double from_absolute = least > 0 ? up(absolute / least) : infinity;
  if (slack <= 0x1p-100 && relative < from_absolute) return {relative, slack};
  return {from_absolute, 0};
}

std::string_view words(Breach breach) {
  switch (breach) {
    case Breach::none: break;
    case Breach::division_by_zero: return "division by zero";
    case Breach::root_of_negative: return "root of a negative number";
    case Breach::logarithm: return "logarithm of a number that is not positive";
    case Breach::power: return "power of a negative number, or of zero to a negative exponent";
    case Breach::arc: return "arc sine or cosine of a number beyond 1";
    case Breach::overflow: return "overflow to infinity";
    case Breach::conversion: return "conversion to an integer that does not exist";
    case Breach::domain: return "argument for which the fast function promises nothing";
    case Breach::unknown: return "an operation that is not understood";
  }
  return "nothing";
}

void place_exact(Bound& r, double least, double most) {
  if (std::isnan(least) || std::isnan(most)) return;
  constexpr double far = 1e200;  // keeps ends within the doubles
  r.exact_least = outward_down(std::min(least, far));
  r.exact_most = outward_up(std::max(most, -far));
}

Outcome settled(Bound r) {
  // NaN comes from 0 times an unknown error.
  for (double* const error : {&r.absolute, &r.relative, &r.slack})
    if (std::isnan(*error)) *error = infinity;
  r.absolute = up(r.absolute);
  r.relative = up(r.relative);
  r.slack = up(r.slack);
  const Breach breach = r.lo < -largest || r.hi > largest ? Breach::overflow : Breach::none;
  r.lo = std::clamp(r.lo, -largest, largest);
  r.hi = std::clamp(r.hi, -largest, largest);
  r.absolute = std::min(r.absolute, up(std::max(r.hi - r.exact_least, r.exact_most - r.lo)));
  if (r.relative < 1) {
    const double exact = (r.magnitude() + r.slack) / (1 - r.relative);
    r.absolute = std::min(r.absolute, up(r.relative * exact + r.slack));
  }
  if (r.absolute == 0) {
    r.relative = r.slack = 0;
    return {r, breach};
  }
  const double least = r.exact_least_magnitude();
  const auto take = [&](double relative, double slack) {
    r.relative = relative;
    r.slack = slack;
  };
  if (least > 0 && r.slack / least <= 0.1 * r.relative) take(up(r.relative + r.slack / least), 0);
  if (least > 0 && up(r.absolute / least) <= r.relative) take(up(r.absolute / least), 0);
  if (r.relative == infinity || r.slack == infinity) take(0, r.absolute);
  return {r, breach};
}

Bound exactly(double value) { return {value, value}; }
Bound between(double lo, double hi) { return {lo, hi}; }
Bound anything() { return {-largest, largest, infinity, infinity, infinity}; }

Outcome approximate(double lo, double hi, double relative_error, double carried) {
  lo = std::clamp(lo, -4 * largest, 4 * largest);
  hi = std::clamp(hi, -4 * largest, 4 * largest);
  const double margin = std::max(std::abs(lo), std::abs(hi)) * relative_error + smallest;
  Bound r{lo - std::abs(lo) * relative_error - smallest, hi + std::abs(hi) * relative_error + smallest};
  if (lo >= 0) r.lo = std::max(r.lo, 0.0);  // results have the sign of the exact ones
  if (hi <= 0) r.hi = std::min(r.hi, 0.0);
  r.absolute = margin + carried * (1 + relative_error);
  r.relative = carried == 0 ? relative_error : infinity;
  r.slack = carried == 0 ? smallest : infinity;
  return settled(r);
}

Outcome add(const Bound& a, const Bound& b) {
  Bound r = computed(RangeRule::sum, a, b);
  const bool nothing_added =
      (a.magnitude() == 0 && a.absolute == 0) || (b.magnitude() == 0 && b.absolute == 0);
  const bool exact = nothing_added || difference_is_exact(a, negate(b));
  const double u = exact ? 0 : half_ulp;
  // A sum is a multiple of the last bit of its smaller operand.
  const bool coarse = std::min(a.least_magnitude(), b.least_magnitude()) >= 0x1p-102;
  const double flush = nothing_added || coarse ? 0 : flushed_from(r);
  r.absolute = a.absolute + b.absolute + times(u, r.magnitude()) + flush;
  place_exact(r, a.exact_lo() + b.exact_lo(), a.exact_hi() + b.exact_hi());
  r.relative = r.slack = infinity;
  if (a.absolute == 0 && b.absolute == 0) {
    r.relative = u;  // one rounding, of either sign
    r.slack = flush;
  } else if (same_sign(a, b)) {
    const double e = std::max(a.relative, b.relative);
    r.relative = e + u * (1 + e);
    r.slack = (a.slack + b.slack + 2 * times(e, beyond_zero(a) + beyond_zero(b))) * (1 + u);
  }
  return settled(r);
}

Outcome subtract(const Bound& a, const Bound& b) { return add(a, negate(b)); }

Outcome multiply(const Bound& a, const Bound& b) {
  const bool exact = is_power_of_two(a) || is_power_of_two(b);
  return product(a, b, computed(RangeRule::product, a, b), !exact);
}

Outcome square(const Bound& a) {
  Outcome squared = product(a, a, computed(RangeRule::product, a, a, true), true);
  Bound& r = squared.bound;
  const double exact = a.exact_least_magnitude();
  r.exact_least = std::max(r.exact_least, outward_down(exact * exact));
  squared.bound = settled(r).bound;
  return squared;
}

Outcome divide(const Bound& a, const Bound& b) {
  if (b.lo <= 0 && b.hi >= 0) return {quotient_by_nonzero(a, b), Breach::division_by_zero};
  Bound r = computed(RangeRule::quotient, a, b);
  const double u = is_power_of_two(b) ? 0 : half_ulp;
  const double b_least = b.least_magnitude();
  const double b_exact = b.exact_least_magnitude();
  if (b_exact > 0) place_exact_corners(r, a, b, [](double x, double y) { return x == 0 ? 0 : x / y; });
  const double before_rounding = r.magnitude() * (1 + 2 * half_ulp) + smallest;
  r.absolute = b_exact > 0 ? (times(before_rounding, b.absolute) + a.absolute) / b_exact : infinity;
  const double flush = flushed_from(r);
  r.absolute += times(u, r.magnitude()) + flush;
  const double e = b_exact > 0 ? b.relative + b.slack / b_exact : infinity;
  r.relative = r.slack = infinity;
  if (e < 1) {
    const double carried = (a.relative + e) / (1 - e);
    r.relative = carried + u * (1 + carried);
    r.slack = a.slack / b_least * (1 + u) + flush;
  }
  return settled(r);
}

Outcome square_root(const Bound& a) {
  const Breach breach = a.lo < 0 ? Breach::root_of_negative : Breach::none;
  const Bound positive = between(std::max(a.lo, 0.0), std::max(a.hi, 0.0));
  Bound r = computed(RangeRule::root, positive, positive);
  const bool exists = a.absolute == 0 || a.exact_lo() >= 0;  // the exact root
  if (exists) place_exact(r, std::sqrt(std::max(a.exact_lo(), 0.0)), std::sqrt(std::max(a.exact_hi(), 0.0)));
  const auto moved = [&](double error) {
    return std::min(std::sqrt(error), r.lo > 0 ? error / r.lo * (1 + half_ulp) : infinity);
  };
  r.absolute = exists ? moved(a.absolute) + half_ulp * r.hi : infinity;
  r.relative = r.slack = infinity;
  if (exists && a.relative < 1) {
    const double carried = a.relative / (1 + std::sqrt(1 - a.relative));
    r.relative = carried + half_ulp * (1 + carried);
    r.slack = moved(a.slack) * (1 + half_ulp);
  }
  Outcome outcome = settled(r);
  outcome.breach = breach;
  return outcome;
}

Bound negate(const Bound& a) {
  return {-a.hi, -a.lo, a.absolute, a.relative, a.slack, -a.exact_most, -a.exact_least};
}

Bound magnitude(const Bound& a) {
  Bound r{a.least_magnitude(), a.magnitude(), a.absolute, a.relative, a.slack};
  place_exact(r, a.exact_least_magnitude(), std::max(a.exact_hi(), -a.exact_lo()));
  return r;
}

Bound floor_of(const Bound& a) {
  Bound r = computed(RangeRule::floor, a, a);
  place_exact(r, std::floor(a.exact_lo()), std::floor(a.exact_hi()));
  const bool same = a.absolute == 0 ||
                    (r.lo == r.hi && std::floor(a.exact_lo()) == r.lo && std::floor(a.exact_hi()) == r.lo);
  if (!same) r.absolute = r.relative = r.slack = a.absolute + 1;
  if (!same) r.relative = infinity;
  return settled(r).bound;
}

Outcome sum_of(const Bound& a, double count) {
  // Each addition rounds a sum of at most `count` times the largest term.
  const double growth = 1 + 2 * count * half_ulp;
  Bound r{std::min(0.0, a.lo * count * growth), std::max(0.0, a.hi * count * growth)};
  r.absolute = count * (a.absolute + half_ulp * r.magnitude() + smallest);
  place_exact(r, std::min(0.0, count * a.exact_lo()), std::max(0.0, count * a.exact_hi()));
  r.relative = r.slack = infinity;
  if (same_sign(a, exactly(0))) {
    r.relative = a.relative + 2 * count * half_ulp * (1 + a.relative);
    r.slack = growth * count * (a.slack + 2 * times(r.relative, beyond_zero(a)));
  }
  return settled(r);
}

}  // namespace isoshade::prove
