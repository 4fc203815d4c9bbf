// SPDX-License-Identifier: Apache-2.0
// Bounds of what is one value or another, and of what decides it: comparisons, booleans and integers.
#include <algorithm>
#include <cmath>
#include <limits>

#include "compiler/prove/bound.h"
#include "compiler/support/assert.h"

namespace isoshade::prove {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double least_integer = -0x1p31, greatest_integer = 0x1p31 - 1;

Bound truth(bool can_be_false, bool can_be_true, bool may_differ) {
  return {can_be_false ? 0.0 : 1.0, can_be_true ? 1.0 : 0.0, may_differ ? 1.0 : 0.0, 0, 0};
}

Outcome any_integer() { return {{least_integer, greatest_integer, infinity, infinity, infinity}}; }

Outcome integer(double lo, double hi, double absolute) {
  if (lo < least_integer || hi > greatest_integer) return any_integer();
  return {{lo, hi, absolute, absolute == 0 ? 0 : infinity, absolute}};
}

/// The bound of the result that is one or the other, both computed and exactly.
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
  // Exact arithmetic may have taken the other side.
  r.absolute += std::max(then.hi - other.lo, other.hi - then.lo);
  r.relative = r.slack = infinity;
  return settled(r).bound;
}

Bound compare(ir::Opcode op, const Bound& a, const Bound& b) {
  using enum ir::Opcode;
  const bool surely_below = a.hi<b.lo, surely_above = a.lo> b.hi;
  const bool never_below = a.lo >= b.hi, never_above = a.hi <= b.lo;
  const bool exact = a.absolute == 0 && b.absolute == 0;
  const bool apart = surely_less(a, b) || surely_less(b, a);
  const bool may_differ = !exact && !apart;
  const bool may_differ_below = may_differ && !surely_not_less(a, b);
  const bool may_differ_above = may_differ && !surely_not_less(b, a);
  const bool disjoint = surely_below || surely_above;
  const bool one = a.is_point() && b.is_point() && a.lo == b.lo;
  switch (op) {
    case flt:
    case ilt: return truth(!surely_below, !never_below, may_differ_below);
    case fle:
    case ile: return truth(!never_above, !surely_above, may_differ_above);
    case fgt:
    case igt: return truth(!surely_above, !never_above, may_differ_above);
    case fge:
    case ige: return truth(!never_below, !surely_below, may_differ_below);
    case feq:
    case ieq: return truth(!one, !disjoint, may_differ);
    case fne:
    case ine: return truth(!disjoint, !one, may_differ);
    default: support::bug("a bound is compared by an op that does not compare");
  }
}

Outcome other(ir::Opcode op, const Bound& a, const Bound& b) {
  using enum ir::Opcode;
  const double differs = std::max(a.absolute, b.absolute);
  switch (op) {
    case band: return {{std::min(a.lo, b.lo), std::min(a.hi, b.hi), differs}};
    case bor: return {{std::max(a.lo, b.lo), std::max(a.hi, b.hi), differs}};
    case bnot: return {{1 - a.hi, 1 - a.lo, a.absolute}};
    case bxor:
      // Known in floats; in exact arithmetic either may be the other.
      if (a.is_point() && b.is_point()) return {{double(a.lo != b.lo), double(a.lo != b.lo), differs}};
      return {{0, 1, differs}};
    case iadd: return integer(a.lo + b.lo, a.hi + b.hi, a.absolute + b.absolute);
    case isub: return integer(a.lo - b.hi, a.hi - b.lo, a.absolute + b.absolute);
    case itof: {
      Bound r{rounded(a.lo), rounded(a.hi)};
      r.absolute = a.absolute + (a.magnitude() > 0x1p24 ? half_ulp * r.magnitude() : 0);
      r.relative = r.slack = r.absolute == 0 ? 0 : infinity;
      return settled(r);
    }
    case ftoi: {
      if (a.lo < least_integer || a.hi >= 0x1p31) return {any_integer().bound, Breach::conversion};
      const bool same = a.absolute == 0 || std::trunc(a.lo - a.absolute) == std::trunc(a.hi + a.absolute);
      return integer(std::trunc(a.lo), std::trunc(a.hi), same ? 0 : a.absolute + 1);
    }
    case bitsf:
    case bitsf_normal: return {anything(), Breach::unknown};
    case ult: return {{0, 1, differs}};
    case fbits:
    case fbits_nonnan:
    case imul:
    case imulhi:
    case umulhi:
    case iand:
    case ior:
    case ixor:
    case ishl:
    case ishr:
    case isar: return any_integer();
    default: support::bug("a bound of an op that has another rule");
  }
}

}  // namespace isoshade::prove
