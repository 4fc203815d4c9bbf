// SPDX-License-Identifier: Apache-2.0
#include "compiler/prove/rules.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>
#include <vector>

namespace isoshade::prove {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double pi = std::numbers::pi;
constexpr double ulp = 2 * half_ulp;
/// The largest error of rows that approximate, outside of the domain that functions.def states.
constexpr double careless = 16 * ulp;

using Arguments = std::span<const Bound>;

double slope_times(double slope, double error) { return error == 0 ? 0 : slope * error; }

// Near the ends the slope is infinite, but the change of the result is not: it is at most sqrt(5 error).
double arc_slope(double a, double b) {
  const double most = std::max(std::abs(a), std::abs(b));
  return most < 1 ? 1 / std::sqrt(1 - most * most) : infinity;
}

struct Monotone {
  bool rising;
  double least, most;
  Breach breach;
  double (*value)(double x);
  double (*slope)(double a, double b);
};

Outcome monotone(const Monotone& f, const Bound& x, double error) {
  const bool inside = x.lo >= f.least && x.hi <= f.most;
  const double from = std::clamp(x.lo, f.least, f.most), to = std::clamp(x.hi, f.least, f.most);
  // Both arguments, the computed and the exact one, lie here.
  const double first = std::max(std::min(from, x.exact_lo()), f.least);
  const double last = std::min(std::max(to, x.exact_hi()), f.most);
  double carried = slope_times(f.slope(first, last), x.absolute);
  if (f.breach == Breach::arc) carried = std::min(carried, std::sqrt(5 * x.absolute));
  const double a = f.value(f.rising ? from : to), b = f.value(f.rising ? to : from);
  const double least = f.value(f.rising ? first : last), most = f.value(f.rising ? last : first);
  if (x.absolute > 0)
    carried = std::min(carried, (most - least) * (1 + 1e-12) + 1e-14 * std::max(-least, most));
  const bool exact_is_inside =
      f.breach == Breach::none || (x.exact_lo() >= f.least && x.exact_hi() <= f.most);
  if (x.absolute > 0 && !exact_is_inside) carried = infinity;
  Outcome outcome = approximate(a, b, error, carried);
  if (exact_is_inside) {
    place_exact(outcome.bound, least, most);
    outcome.bound = settled(outcome.bound).bound;
  }
  if (!inside && f.breach != Breach::none) outcome.breach = f.breach;
  return outcome;
}

Outcome bounded(double least, double most, Arguments in, double error) {
  double unknown = 0;
  for (const Bound& argument : in) unknown = std::max(unknown, argument.absolute);
  Bound r{least, most, unknown > 0 ? most - least : error, infinity, infinity};
  return settled(r);
}

/// Angles of at most this magnitude are reduced in double to within 1e-9.
constexpr double near_angle = 0x1p20;

/// The bound of sine or cosine, which is 1 at `top` and -1 half a turn away.
Outcome wave(const Bound& x, double (*value)(double), double top, double error) {
  const bool near = x.magnitude() <= near_angle;
  const auto meets = [&](double extreme) {
    if (!near) return !x.is_point();
    const double turn = 2 * pi;
    const double first = extreme + turn * std::ceil((x.lo - 1e-9 - extreme) / turn);
    return first <= x.hi + 1e-9;
  };
  const double lo = meets(top - pi) ? -1 : std::min(value(x.lo), value(x.hi));
  const double hi = meets(top) ? 1 : std::max(value(x.lo), value(x.hi));
  return approximate(lo, hi, error, std::min(x.absolute, 2.0));
}

Outcome rule_sin(Arguments in, uint32_t, const Accuracy& accuracy) {
  return wave(in[0], [](double x) { return std::sin(x); }, pi / 2, accuracy.error);
}
Outcome rule_cos(Arguments in, uint32_t, const Accuracy& accuracy) {
  return wave(in[0], [](double x) { return std::cos(x); }, 0, accuracy.error);
}

Outcome rule_tan(Arguments in, uint32_t, const Accuracy& accuracy) {
  const Bound& x = in[0];
  // Both arguments, the computed and the exact one, lie here.
  const double from = std::min(x.lo, x.exact_lo()), to = std::max(x.hi, x.exact_hi());
  const double pole = pi * (std::ceil((from - 1e-9) / pi - 0.5) + 0.5);
  const bool near = std::max(-from, to) <= near_angle;
  // No float is closer to a pole than 1e-9.
  if (near ? pole <= to + 1e-9 : from < to) {
    Bound r{-1e9, 1e9, x.absolute > 0 ? infinity : accuracy.error * 1e9, infinity, infinity};
    return settled(r);
  }
  const double steepest = 1 + std::pow(std::max(std::abs(std::tan(from)), std::abs(std::tan(to))), 2);
  return approximate(std::tan(x.lo), std::tan(x.hi), accuracy.error, slope_times(steepest, x.absolute));
}

Outcome rule_fract(Arguments in, uint32_t, const Accuracy&) {
  const Bound& x = in[0];
  const double below = std::floor(x.lo - x.absolute);
  const bool one_piece = below == std::floor(x.hi + x.absolute);
  if (!one_piece) {
    const bool jumps = x.absolute > 0;
    Bound r{0, 1 - half_ulp, jumps ? 1 : ulp, infinity, infinity};
    return settled(r);
  }
  const double rest = 1 - half_ulp;
  Bound r{std::min(x.lo - below, rest), std::min(x.hi - below, rest), x.absolute + ulp, infinity, infinity};
  r.lo = std::max(0.0, r.lo - ulp);
  r.hi = std::min(rest, r.hi + ulp);
  return settled(r);
}

Outcome rule_mod(Arguments in, uint32_t, const Accuracy&) {
  const Bound& y = in[1];
  if (y.lo <= 0 && y.hi >= 0) return {anything(), Breach::division_by_zero};
  Bound r{y.hi > 0 ? 0 : y.lo, y.hi > 0 ? y.hi : 0};
  // It lies between 0 and the computed divisor, and exactly between 0 and the exact one.
  r.absolute = 2 * y.magnitude() + y.absolute + smallest;
  r.relative = r.slack = infinity;
  return settled(r);
}

Outcome rule_pow(Arguments in, uint32_t, const Accuracy& accuracy) {
  Bound x = in[0];
  const Bound& y = in[1];
  Breach breach = Breach::none;
  if (x.lo < 0 || (x.lo <= 0 && y.lo < 0)) {
    breach = Breach::power;
    x.lo = std::max(x.lo, y.lo < 0 ? smallest : 0.0);
    x.hi = std::max(x.hi, x.lo);
  }
  // It is monotone in either argument.
  const auto [lo, hi] =
      std::minmax({std::pow(x.lo, y.lo), std::pow(x.lo, y.hi), std::pow(x.hi, y.lo), std::pow(x.hi, y.hi)});
  double carried = 0;
  if (x.absolute > 0 || y.absolute > 0) {
    // Both bases, the computed and the exact one, lie here, and both exponents.
    const double x_least = std::min(x.lo, x.exact_lo()), x_most = std::max(x.hi, x.exact_hi());
    const double y_least = std::min(y.lo, y.exact_lo()), y_most = std::max(y.hi, y.exact_hi());
    const bool exists = x_least >= 0 && (x_least > 0 || y_least >= 0);
    const auto [least, most] = std::minmax({std::pow(x_least, y_least), std::pow(x_least, y_most),
                                            std::pow(x_most, y_least), std::pow(x_most, y_most)});
    // The slopes are y x^(y - 1) and x^y log(x).
    const double power = std::max(std::abs(y_least), std::abs(y_most));
    const double base_slope = y_least >= 1  ? power * std::pow(std::max(x_most, 1.0), power - 1)
                              : x_least > 0 ? power * most / x_least
                                            : infinity;
    const double logarithm =
        x_least > 0 ? std::max(std::abs(std::log(x_least)), std::abs(std::log(x_most))) : infinity;
    carried = slope_times(base_slope, x.absolute) + slope_times(most * logarithm, y.absolute);
    carried = 1.001 * std::min(carried, most - least);
    if (!exists || !std::isfinite(most)) carried = infinity;
  }
  Outcome outcome = approximate(lo, hi, accuracy.error, carried);
  const double e = y.magnitude() * x.relative;
  if (y.absolute == 0 && x.slack == 0 && e < 0.01) {
    outcome.bound.relative = 1.02 * (e + accuracy.error);
    outcome.bound.slack = smallest;
    outcome.bound = settled(outcome.bound).bound;
  }
  if (breach != Breach::none) outcome.breach = breach;
  return outcome;
}

Outcome rule_atan2(Arguments in, uint32_t, const Accuracy& accuracy) {
  const Bound &y = in[0], &x = in[1];
  const double lo = y.lo >= 0 ? 0 : x.lo > 0 ? -pi / 2 : -pi;
  const double hi = y.hi < 0 ? 0 : x.lo > 0 ? pi / 2 : pi;
  const double far_x = std::max(0.0, x.least_magnitude() - x.absolute);
  const double far_y = std::max(0.0, y.least_magnitude() - y.absolute);
  const bool jumps = x.lo - x.absolute <= 0 && far_y == 0;
  const double near = std::hypot(far_x, far_y);
  const double moved = x.absolute + y.absolute;
  const double carried = moved == 0 ? 0 : jumps ? 2 * pi : std::min(2 * pi, moved / near);
  return approximate(lo, hi, accuracy.error, carried);
}

/// How far x is on the way from low to high, held within [0, 1].
Bound share_of_way(const Bound& low, const Bound& high, const Bound& x) {
  Bound any = settled(Bound{0, 1, 1, infinity, infinity}).bound;
  const Outcome gone = subtract(x, low), way = subtract(high, low);
  if (gone.breach != Breach::none || way.breach != Breach::none) return any;
  const Outcome share = divide(gone.bound, way.bound);
  // Equal or nearly equal edges make a step, which rounding or flushing may move.
  if (share.breach == Breach::division_by_zero) return any;
  // A quotient that overflows is infinite, with the right sign, and is then clamped to the exact end.
  Bound held = lesser(greater(share.bound, exactly(0)), exactly(1));
  held.absolute = std::min(held.absolute, 1.0);
  return settled(held).bound;
}

Outcome rule_smoothstep(Arguments in, uint32_t, const Accuracy&) {
  const Bound t = share_of_way(in[0], in[1], in[2]);
  const auto curve = [](double x) { return x * x * (3 - 2 * x); };
  const Outcome rest = subtract(exactly(3), multiply(exactly(2), t).bound);
  Bound r = multiply(square(t).bound, rest.bound).bound;
  // It rises with t, with a slope of at most 3/2, and is rounded three times.
  const double error = 3.1 * half_ulp, flushed = 4 * smallest;
  r.lo = std::max({r.lo, curve(t.lo) * (1 - error) - flushed, 0.0});
  r.hi = std::min({r.hi, curve(t.hi) * (1 + error) + flushed, 1.0});  // no float t gives more
  r.absolute = std::min(r.absolute, 1.5 * (1 + error) * t.absolute + error * r.hi + flushed);
  place_exact(r, curve(std::clamp(t.exact_lo(), 0.0, 1.0)), curve(std::clamp(t.exact_hi(), 0.0, 1.0)));
  return settled(r);
}

double norm(Arguments v, double (Bound::*part)() const) {
  double sum = 0;
  for (const Bound& c : v) sum += (c.*part)() * (c.*part)();
  return std::sqrt(sum);
}
double error_norm(Arguments v) {
  double sum = 0;
  for (const Bound& c : v) sum += c.absolute * c.absolute;
  return std::sqrt(sum);
}

Outcome rule_normalize(Arguments in, uint32_t component, const Accuracy& accuracy) {
  const Bound& c = in[component];
  double others_least = 0, others_most = 0;
  for (uint32_t i = 0; i < in.size(); ++i) {
    if (i == component) continue;
    others_least += in[i].least_magnitude() * in[i].least_magnitude();
    others_most += in[i].magnitude() * in[i].magnitude();
  }
  const auto share = [](double x, double others) {
    const double length = std::sqrt(x * x + others);
    return length > 0 ? x / length : 0;
  };
  const double lo = share(c.lo, c.lo < 0 ? others_least : others_most);
  const double hi = share(c.hi, c.hi > 0 ? others_least : others_most);
  const double moved = error_norm(in);
  const double least = norm(in, &Bound::least_magnitude) - moved;
  const double carried = moved == 0 ? 0 : least > 0 ? std::min(2.0, 2 * moved / least) : 2;
  return approximate(lo, hi, accuracy.error, carried);
}

Outcome rule_length(Arguments in, uint32_t, const Accuracy& accuracy) {
  return approximate(norm(in, &Bound::least_magnitude), norm(in, &Bound::magnitude), accuracy.error,
                     error_norm(in));
}

Outcome rule_rotate2d(Arguments in, uint32_t, const Accuracy&) {
  const double size = in[0].magnitude() + in[1].magnitude();
  const double reach = norm(in.first(2), &Bound::magnitude) + 2.5 * ulp * size + smallest;
  const double turned = std::min(2 * size, size * 0.01745330 * in[2].absolute);
  Bound r{-reach, reach, in[0].absolute + in[1].absolute + turned + 2.5 * ulp * size + 4 * smallest, infinity,
          infinity};
  return settled(r);
}

/// Followed op by op, but its weights are floats close to the ones of its definition.
Outcome rule_luminance(Arguments in, uint32_t, const Accuracy&) {
  constexpr double weights[] = {0.2126, 0.7152, 0.0722};
  Outcome sum;
  for (size_t i = 0; i < std::size(weights); ++i) {
    const double nearest = rounded(weights[i]), error = 1.001 * std::abs(nearest - weights[i]);
    const Outcome term = multiply({nearest, nearest, error, 1.001 * error / weights[i], 0}, in[i]);
    const Breach before = sum.breach;
    sum = i == 0 ? term : add(sum.bound, term.bound);
    if (term.breach != Breach::none) sum.breach = term.breach;
    if (before != Breach::none) sum.breach = before;
  }
  return sum;
}

Outcome rule_rgb_to_hsv(Arguments in, uint32_t component, const Accuracy&) {
  if (component == 2) return {greater(greater(in[0], in[1]), in[2])};
  const bool positive = in[0].lo >= 0 && in[1].lo >= 0 && in[2].lo >= 0;
  if (!positive && component == 1) return {anything(), Breach::unknown};
  // A difference of two components that is denormal is 0, and so are hue and saturation.
  const double value = greater(greater(in[0], in[1]), in[2]).lo;
  if (value < 0x1p-100) return bounded(0, 1 + 3 * ulp, in, 1);
  return bounded(0, 1 + 3 * ulp, in, 3 * ulp);
}

Outcome fractal(Arguments in) {
  const double farthest = std::max({in[0].magnitude(), in[1].magnitude(), in[2].magnitude()});
  // Infinities count as 0, but products with them may be NaN.
  if (farthest * std::pow(std::max(1.0, in[4].magnitude()), 16) > largest)
    return {anything(), Breach::overflow};
  const double growth = std::max(1.0, in[5].magnitude());
  double most = 0;
  for (int octave = 0; octave < 16; ++octave) most += 2 * std::pow(growth, octave);
  Outcome outcome = bounded(-most, most, in, infinity);
  // Octaves far from the origin are as good as random.
  outcome.bound.absolute = 2 * most;
  return outcome;
}
Outcome rule_fractal3d(Arguments in, uint32_t, const Accuracy&) { return fractal(in); }
Outcome rule_fractal3d_vector3(Arguments in, uint32_t, const Accuracy&) { return fractal(in); }

Outcome worley(Arguments in, const Accuracy& accuracy) {
  if (in[2].lo < 0 || in[2].hi > 1) return {anything(), Breach::unknown};
  return bounded(0, 3, in, accuracy.promised ? 2 * ulp : 3);  // of nine cells none is farther than 2 sqrt(2)
}
Outcome rule_worleynoise2d(Arguments in, uint32_t, const Accuracy& accuracy) { return worley(in, accuracy); }
Outcome rule_worleynoise2d_vector3(Arguments in, uint32_t, const Accuracy& accuracy) {
  return worley(in, accuracy);
}

constexpr bool rising = true, falling = false;

#define MONOTONE(row, direction, least, most, breach, value_of_x, slope_in_ab)                       \
  Outcome rule_##row(Arguments in, uint32_t, const Accuracy& accuracy) {                             \
    static constexpr Monotone f{                                                                     \
        direction,                                                                                   \
        least,                                                                                       \
        most,                                                                                        \
        Breach::breach,                                                                              \
        [](double x) -> double { return value_of_x; },                                               \
        []([[maybe_unused]] double a, [[maybe_unused]] double b) -> double { return slope_in_ab; }}; \
    return monotone(f, in[0], accuracy.error);                                                       \
  }
#define BOUNDED(row, least, most)                                                \
  Outcome rule_##row(Arguments in, uint32_t, const Accuracy& accuracy) {         \
    return bounded(least, most, in, accuracy.promised ? 2 * ulp : most - least); \
  }
#include "compiler/functions/functions.def"

constexpr Rule rules[] = {
#define MONOTONE(row, direction, least, most, breach, value, slope) {#row, rule_##row},
#define BOUNDED(row, least, most) {#row, rule_##row},
#define SPECIAL(row) {#row, rule_##row},
#include "compiler/functions/functions.def"
};

struct Domain {
  double lo, hi;
};
/// The facts of functions.def about a row in a tier.
struct RowFacts {
  std::string_view row, signature;
  functions::Tier tier;
  double ulp;
  std::vector<Domain> domain;  ///< of each argument
  bool of_one;                 ///< the error is in ulps of 1, not of the result
};
const std::vector<RowFacts>& row_facts() {
#define D(...) \
  { __VA_ARGS__ }
  static const std::vector<RowFacts> all{
#define FUNCTION(name, signature, ulp, domain, reference, unit) \
  {#name, #signature, functions::Tier::standard, ulp, domain, false},
#include "compiler/functions/functions.def"
#define TIER(tier, name, ulp, domain, unit) \
  {#name, "", functions::Tier::tier, ulp, domain, std::string_view(#unit) == "ones(result)"},
#include "compiler/functions/functions.def"
  };
#undef D
  return all;
}

/// Those of the tier's body, which may be the default one.
const RowFacts* facts_of(std::string_view row, functions::Tier tier) {
  using ByTier = std::array<const RowFacts*, functions::tiers.size()>;
  static const std::unordered_map<std::string_view, ByTier> by_row = [] {
    std::unordered_map<std::string_view, ByTier> map;
    for (const RowFacts& facts : row_facts()) {
      ByTier& of_row = map[facts.row];
      if (facts.tier == functions::Tier::standard) of_row.fill(&facts);
      of_row[static_cast<size_t>(facts.tier)] = &facts;
    }
    return map;
  }();
  const auto found = by_row.find(row);
  return found == by_row.end() ? nullptr : found->second[static_cast<size_t>(tier)];
}

bool is_within(const std::vector<Domain>& domain, Arguments arguments, bool componentwise) {
  for (size_t i = 0; i < arguments.size(); ++i) {
    const Domain& d = domain[componentwise ? std::min(i, domain.size() - 1) : 0];
    if (arguments[i].lo < d.lo || arguments[i].hi > d.hi) return false;
  }
  return true;
}

}  // namespace

const Rule* find_rule(std::string_view row) {
  const auto found = std::ranges::find(rules, row, &Rule::row);
  return found == std::end(rules) ? nullptr : found;
}

bool is_componentwise(std::string_view row) {
  const RowFacts* facts = facts_of(row, functions::Tier::standard);
  return facts != nullptr && facts->signature.starts_with('g');
}

Outcome bound_of(const Rule& rule, std::span<const Bound> arguments, uint32_t component,
                 functions::Tier tier) {
  const RowFacts& facts = *facts_of(rule.row, tier);
  const bool inside = is_within(facts.domain, arguments, is_componentwise(rule.row));
  if (facts.tier == functions::Tier::fast && !inside) return {anything(), Breach::domain};
  const double ulps = facts.of_one ? facts_of(rule.row, functions::Tier::standard)->ulp : facts.ulp;
  const bool is_default = facts.tier == functions::Tier::standard;
  const double error = inside ? (is_default ? std::max(ulps, 1.0) : ulps) * ulp * (1 + ulp) : careless;
  Outcome outcome = rule.bound(arguments, component, {error, inside});
  if (!facts.of_one) return outcome;
  Bound& b = outcome.bound;
  b.lo -= facts.ulp * ulp;
  b.hi += facts.ulp * ulp;
  b.absolute += facts.ulp * ulp;
  b.relative = b.slack = infinity;
  b = settled(b).bound;
  return outcome;
}

}  // namespace isoshade::prove
