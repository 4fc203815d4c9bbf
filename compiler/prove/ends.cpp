// SPDX-License-Identifier: Apache-2.0
#include "compiler/prove/ends.h"

#include <algorithm>
#include <cmath>

namespace isoshade::prove {
namespace {

using ir::RangeRule;

/// The ends of what an operation gives that is monotone in either operand: rounding is monotone, too.
template <class Operation>
Ends corners(const Ends& a, const Ends& b, Operation operation) {
  const auto at = [&](double x, double y) {
    return static_cast<double>(operation(static_cast<float>(x), static_cast<float>(y)));
  };
  const auto [lo, hi] = std::minmax({at(a.lo, b.lo), at(a.lo, b.hi), at(a.hi, b.lo), at(a.hi, b.hi)});
  return {lo, hi};
}

double float_sum(double a, double b) {
  return static_cast<double>(static_cast<float>(a) + static_cast<float>(b));
}
double float_root(double a) { return static_cast<double>(std::sqrt(static_cast<float>(a))); }

Ends compared(RangeRule comparison, const Ends& a, const Ends& b) {
  const bool possible[] = {a.lo < b.hi, a.lo <= b.hi && b.lo <= a.hi, a.hi > b.lo};
  constexpr RangeRule orders[] = {RangeRule::less, RangeRule::equal, RangeRule::greater};
  bool can_be_true = false, can_be_false = false;
  for (int i = 0; i < 3; ++i) {
    if (!possible[i]) continue;
    (ir::accepts(comparison, orders[i]) ? can_be_true : can_be_false) = true;
  }
  return {can_be_false ? 0.0 : 1.0, can_be_true ? 1.0 : 0.0};
}

std::optional<Ends> integers(double lo, double hi) {
  if (lo < -0x1p31 || hi > 0x1p31 - 1) return std::nullopt;
  return Ends{lo, hi};
}

}  // namespace

// Not inlined: where g++ 12 does this to two numbers at once, it takes the way to float and back for nothing.
[[gnu::noinline]] double rounded(double value) { return static_cast<double>(static_cast<float>(value)); }

Ends magnitudes(const Ends& a) {
  const double lo = std::abs(a.lo), hi = std::abs(a.hi);
  return {a.lo <= 0 && a.hi >= 0 ? 0 : std::min(lo, hi), std::max(lo, hi)};
}

std::optional<Ends> ends_of(RangeRule rule, const Ends& a, const Ends& b, bool same) {
  using enum RangeRule;
  switch (rule) {
    case less:
    case equal:
    case less_or_equal:
    case greater:
    case not_equal:
    case greater_or_equal: return compared(rule, a, b);
    case sum: return Ends{float_sum(a.lo, b.lo), float_sum(a.hi, b.hi)};
    case difference: return Ends{float_sum(a.lo, -b.hi), float_sum(a.hi, -b.lo)};
    case product: {
      const auto times = [](float x, float y) { return x * y; };
      return same ? corners(magnitudes(a), magnitudes(a), times) : corners(a, b, times);
    }
    case quotient:
      if (b.lo <= 0 && b.hi >= 0) return std::nullopt;
      return corners(a, b, [](float x, float y) { return x / y; });
    case root:
      if (a.lo < 0) return std::nullopt;
      return Ends{float_root(a.lo), float_root(a.hi)};
    case floor: return Ends{std::floor(a.lo), std::floor(a.hi)};
    case negative: return Ends{-a.hi, -a.lo};
    case magnitude: return magnitudes(a);
    case choice: return Ends{std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
    case truncated:
      if (a.lo < -0x1p31 || a.hi >= 0x1p31) return std::nullopt;
      return integers(std::trunc(a.lo), std::trunc(a.hi));
    case rounded: return Ends{prove::rounded(a.lo), prove::rounded(a.hi)};
    case integer_sum: return integers(a.lo + b.lo, a.hi + b.hi);
    case integer_difference: return integers(a.lo - b.hi, a.hi - b.lo);
    case both: return Ends{std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
    case either: return Ends{std::max(a.lo, b.lo), std::max(a.hi, b.hi)};
    case different: {
      if (!a.is_point() || !b.is_point()) return std::nullopt;
      const double differs = a.lo != b.lo ? 1 : 0;
      return Ends{differs, differs};
    }
    case inverse: return Ends{1 - a.hi, 1 - a.lo};
    case any: return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace isoshade::prove
