// SPDX-License-Identifier: Apache-2.0
// Bounds of choices, comparisons, booleans and integers; the dispatch by range rule.
#include <algorithm>
#include <cmath>
#include <limits>

#include "compiler/prove/bound.h"

namespace isoshade::prove {
namespace {

using ir::RangeRule;

constexpr double infinity = std::numeric_limits<double>::infinity();
Bound any_integer() { return {-0x1p31, 0x1p31 - 1, infinity, infinity, infinity}; }

Bound integer(const Ends& ends, double absolute) {
  return {ends.lo, ends.hi, absolute, absolute == 0 ? 0 : infinity, absolute};
}

/// The bound of a result of which only the type is known.
Outcome any_of(ir::Rule rule, double differs) {
  switch (rule) {
    case ir::Rule::same:
    case ir::Rule::to_float:
    case ir::Rule::choose: return {anything(), Breach::unknown};
    case ir::Rule::integer:
    case ir::Rule::to_int: return {any_integer()};
    case ir::Rule::compare:
    case ir::Rule::icompare:
    case ir::Rule::logic: return {{0, 1, differs}};
  }
  return {anything(), Breach::unknown};
}

/// The bound of a result that is one of two values, computed and exactly.
Bound either(const Bound& a, const Bound& b, double lo, double hi) {
  Bound r{lo, hi, std::max(a.absolute, b.absolute), std::max(a.relative, b.relative),
          std::max(a.slack, b.slack)};
  return r;
}

bool surely_less(const Bound& a, const Bound& b) { return a.hi < b.lo && a.exact_hi() < b.exact_lo(); }
/// a >= b
bool surely_not_less(const Bound& a, const Bound& b) { return a.lo >= b.hi && a.exact_lo() >= b.exact_hi(); }

}  // namespace

Bound lesser(const Bound& a, const Bound& b) {
  if (surely_less(a, b)) return a;
  if (surely_less(b, a)) return b;
  Bound r = either(a, b, std::min(a.lo, b.lo), std::min(a.hi, b.hi));
  place_exact(r, std::min(a.exact_lo(), b.exact_lo()), std::min(a.exact_hi(), b.exact_hi()));
  return settled(r).bound;
}

Bound greater(const Bound& a, const Bound& b) { return negate(lesser(negate(a), negate(b))); }

Bound select(const Bound& condition, const Bound& then, const Bound& other) {
  const bool one_side = condition.is_point() && condition.absolute == 0;
  if (one_side) return condition.lo != 0 ? then : other;
  Bound r = either(then, other, std::min(then.lo, other.lo), std::max(then.hi, other.hi));
  place_exact(r, std::min(then.exact_lo(), other.exact_lo()), std::max(then.exact_hi(), other.exact_hi()));
  if (condition.is_point()) {
    r.lo = condition.lo != 0 ? then.lo : other.lo;
    r.hi = condition.lo != 0 ? then.hi : other.hi;
  }
  if (condition.absolute == 0) return r;
  // Exact arithmetic may take the other side.
  r.absolute += std::max(then.hi - other.lo, other.hi - then.lo);
  r.relative = r.slack = infinity;
  return settled(r).bound;
}

namespace {

Bound compared(RangeRule comparison, const Bound& a, const Bound& b) {
  const Ends truth = *ends_of(comparison, a.ends(), b.ends());
  const bool exact = a.absolute == 0 && b.absolute == 0;
  const bool apart = surely_less(a, b) || surely_less(b, a);
  bool may_differ = !exact && !apart;
  // If it does not tell equal from greater, it differs only if exact arithmetic may find a < b; and the reverse.
  const auto alike = [&](RangeRule order) {
    return ir::accepts(comparison, RangeRule::equal) == ir::accepts(comparison, order);
  };
  if (alike(RangeRule::greater)) may_differ = may_differ && !surely_not_less(a, b);
  if (alike(RangeRule::less)) may_differ = may_differ && !surely_not_less(b, a);
  return {truth.lo, truth.hi, may_differ ? 1.0 : 0.0, 0, 0};
}

}  // namespace

Outcome bound_of(ir::Opcode op, const Bound& a, const Bound& b, bool same) {
  const RangeRule rule = ir::info(op).range;
  const auto ends = [&] { return ends_of(rule, a.ends(), b.ends(), same); };
  const double differs = std::max(a.absolute, b.absolute);
  switch (rule) {
    using enum RangeRule;
    case less:
    case equal:
    case less_or_equal:
    case greater:
    case not_equal:
    case greater_or_equal: return {compared(rule, a, b)};
    case sum: return same ? multiply(exactly(2), a) : add(a, b);
    case difference: return same ? Outcome{exactly(0)} : subtract(a, b);
    case product: return same ? square(a) : multiply(a, b);
    case quotient: return divide(a, b);
    case root: return square_root(a);
    case floor: return {floor_of(a)};
    case negative: return {negate(a)};
    case magnitude: return {prove::magnitude(a)};
    case choice: break;
    case truncated: {
      const std::optional<Ends> whole = ends();
      if (!whole) return {any_integer(), Breach::conversion};
      const bool alike = a.absolute == 0 || std::trunc(a.lo - a.absolute) == std::trunc(a.hi + a.absolute);
      return {integer(*whole, alike ? 0 : a.absolute + 1)};
    }
    case rounded: {
      Bound r{prove::rounded(a.lo), prove::rounded(a.hi)};
      r.absolute = a.absolute + (a.magnitude() > 0x1p24 ? half_ulp * r.magnitude() : 0);
      r.relative = r.slack = r.absolute == 0 ? 0 : infinity;
      return settled(r);
    }
    case integer_sum:
    case integer_difference: {
      const std::optional<Ends> whole = ends();
      return {whole ? integer(*whole, a.absolute + b.absolute) : any_integer()};
    }
    // Known for floats; in exact arithmetic either operand may be different.
    case both:
    case either:
    case different: {
      const Ends truth = ends().value_or(Ends{0, 1});
      return {{truth.lo, truth.hi, differs}};
    }
    case inverse: return {{1 - a.hi, 1 - a.lo, a.absolute}};
    case any: return any_of(ir::info(op).rule, differs);
  }
  return {anything(), Breach::unknown};
}

}  // namespace isoshade::prove
