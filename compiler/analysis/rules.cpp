// SPDX-License-Identifier: Apache-2.0
#include "compiler/analysis/rules.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace isoshade::analysis {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double pi = std::numbers::pi;
constexpr double ulp = 2 * half_ulp;
/// What rows err by at most where they promise nothing: outside of the domain that functions.def states.
constexpr double careless = 16 * ulp;

using Arguments = std::span<const Bound>;

double slope_times(double slope, double error) { return error == 0 ? 0 : slope * error; }

// Near the ends the slope is infinite, but what the result moves by is not: at most sqrt(5 error).
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

Outcome monotone(const Monotone& f, std::string_view row, const Bound& x) {
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
  const bool exact_is_inside = f.least <= 0 || x.exact_lo() >= f.least;
  if (x.absolute > 0 && !exact_is_inside) carried = infinity;
  Outcome outcome = approximate(a, b, std::max(ulp_of(row), 1.0) * ulp * (1 + ulp), carried);
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

/// Of sine (phase 0) or cosine (phase pi / 2).
Outcome wave(const Bound& x, double phase) {
  if (x.magnitude() > 8192) return bounded(-1.01, 1.01, Arguments(&x, 1), 2.02);
  const double from = x.lo + phase, to = x.hi + phase;
  const auto meets = [&](double extreme) {
    const double turn = 2 * pi;
    const double first = extreme + turn * std::ceil((from - 1e-9 - extreme) / turn);
    return first <= to + 1e-9;
  };
  const double lo = meets(-pi / 2) ? -1 : std::min(std::sin(from), std::sin(to));
  const double hi = meets(pi / 2) ? 1 : std::max(std::sin(from), std::sin(to));
  return approximate(lo, hi, 1.75 * ulp * (1 + ulp), x.absolute);
}

Outcome rule_sin(Arguments in, uint32_t) { return wave(in[0], 0); }
Outcome rule_cos(Arguments in, uint32_t) { return wave(in[0], pi / 2); }

Outcome rule_tan(Arguments in, uint32_t) {
  const Bound& x = in[0];
  const double pole = pi * (std::ceil((x.lo - 1e-9) / pi - 0.5) + 0.5);
  // No float of magnitude up to 8192 is nearer to a pole than 1e-9.
  if (x.magnitude() > 8192) return {anything(), Breach::unknown};
  if (pole <= x.hi + 1e-9) return bounded(-1e9, 1e9, in, 3.5 * ulp * 1e9);
  const double steepest = 1 + std::pow(std::max(std::abs(std::tan(x.lo)), std::abs(std::tan(x.hi))), 2);
  return approximate(std::tan(x.lo), std::tan(x.hi), 3.5 * ulp * (1 + ulp),
                     slope_times(steepest, x.absolute));
}

Outcome rule_fract(Arguments in, uint32_t) {
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

Outcome rule_mod(Arguments in, uint32_t) {
  const Bound &x = in[0], &y = in[1];
  if (y.lo <= 0 && y.hi >= 0) return {anything(), Breach::division_by_zero};
  const double size = x.magnitude() + y.magnitude();
  Bound r{y.hi > 0 ? 0 : y.lo, y.hi > 0 ? y.hi : 0};
  if (x.magnitude() / y.least_magnitude() >= 0x1p22) {
    r.lo = -2.01 * size;
    r.hi = 2.01 * size;
  }
  const bool jumps = x.absolute > 0 || y.absolute > 0;
  r.absolute = jumps ? 2.01 * size : y.magnitude() + size * ulp;
  r.relative = r.slack = infinity;
  return settled(r);
}

Outcome rule_pow(Arguments in, uint32_t) {
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
  const bool promised = x.lo >= 1e-6 && x.hi <= 1e6 && y.magnitude() <= 64;
  const double error = promised ? 2 * ulp * (1 + ulp) : careless;
  const double x_least = x.lo - x.absolute, x_most = x.hi + x.absolute;
  double carried = 0;
  if (x.absolute > 0 || y.absolute > 0) {
    // The slopes are y x^(y - 1) and x^y log(x).
    const double power = y.magnitude() + y.absolute - 1;
    const double base_slope = y.lo - y.absolute >= 1 ? (power + 1) * std::pow(std::max(x_most, 1.0), power)
                              : x_least > 0          ? (power + 1) * hi * 1.01 / x_least
                                                     : infinity;
    const double logarithm =
        x_least > 0 ? std::max(std::abs(std::log(x_least)), std::abs(std::log(x_most))) : infinity;
    carried = slope_times(base_slope, x.absolute) + slope_times(1.01 * hi * logarithm, y.absolute);
  }
  Outcome outcome = approximate(lo, hi, error, carried);
  const double e = y.magnitude() * x.relative;
  if (y.absolute == 0 && x.slack == 0 && e < 0.01) {
    outcome.bound.relative = std::min(outcome.bound.relative, 1.02 * e + error);
    outcome.bound.slack = smallest;
    outcome.bound = settled(outcome.bound).bound;
  }
  if (breach != Breach::none) outcome.breach = breach;
  return outcome;
}

Outcome rule_atan2(Arguments in, uint32_t) {
  const Bound &y = in[0], &x = in[1];
  const double lo = y.lo >= 0 ? 0 : x.lo > 0 ? -pi / 2 : -pi;
  const double hi = y.hi < 0 ? 0 : x.lo > 0 ? pi / 2 : pi;
  const double far_x = std::max(0.0, x.least_magnitude() - x.absolute);
  const double far_y = std::max(0.0, y.least_magnitude() - y.absolute);
  const bool jumps = x.lo - x.absolute <= 0 && far_y == 0;
  const double near = std::hypot(far_x, far_y);
  const double moved = x.absolute + y.absolute;
  const double carried = moved == 0 ? 0 : jumps ? 2 * pi : std::min(2 * pi, moved / near);
  return approximate(lo, hi, 2 * ulp * (1 + ulp), carried);
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

Outcome rule_normalize(Arguments in, uint32_t component) {
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
  return approximate(lo, hi, 3 * ulp * (1 + ulp), carried);
}

Outcome rule_length(Arguments in, uint32_t) {
  return approximate(norm(in, &Bound::least_magnitude), norm(in, &Bound::magnitude), 2 * ulp * (1 + ulp),
                     error_norm(in));
}

Outcome rule_rotate2d(Arguments in, uint32_t) {
  const double size = in[0].magnitude() + in[1].magnitude();
  const double reach = norm(in.first(2), &Bound::magnitude) + 2.5 * ulp * size;
  const double turned = std::min(2 * size, size * 0.01745330 * in[2].absolute);
  Bound r{-reach, reach, in[0].absolute + in[1].absolute + turned + 2.5 * ulp * size, infinity, infinity};
  if (in[2].magnitude() > 0x1p22) r.absolute = 2 * reach;
  return settled(r);
}

Outcome rule_rgb_to_hsv(Arguments in, uint32_t component) {
  if (component == 2) return {greater(greater(in[0], in[1]), in[2])};
  const bool positive = in[0].lo >= 0 && in[1].lo >= 0 && in[2].lo >= 0;
  if (!positive && component == 1) return {anything(), Breach::unknown};
  return bounded(0, 1 + 3 * ulp, in, 3 * ulp);
}

Outcome fractal(Arguments in, uint32_t) {
  const double growth = std::max(1.0, in[5].magnitude());
  double most = 0;
  for (int octave = 0; octave < 16; ++octave) most += 2 * std::pow(growth, octave);
  Outcome outcome = bounded(-most, most, in, infinity);
  // Octaves far from the origin are as good as random.
  outcome.bound.absolute = 2 * most;
  return outcome;
}
Outcome rule_fractal3d(Arguments in, uint32_t component) { return fractal(in, component); }
Outcome rule_fractal3d_vector3(Arguments in, uint32_t component) { return fractal(in, component); }

Outcome worley(Arguments in) {
  if (in[2].lo < 0 || in[2].hi > 1) return {anything(), Breach::unknown};
  return bounded(0, 3, in, 2 * ulp);  // of nine cells none is farther than 2 sqrt(2)
}
Outcome rule_worleynoise2d(Arguments in, uint32_t) { return worley(in); }
Outcome rule_worleynoise2d_vector3(Arguments in, uint32_t) { return worley(in); }

constexpr bool rising = true, falling = false;

#define MONOTONE(row, direction, least, most, breach, value_of_x, slope_in_ab)                       \
  Outcome rule_##row(Arguments in, uint32_t) {                                                       \
    static constexpr Monotone f{                                                                     \
        direction,                                                                                   \
        least,                                                                                       \
        most,                                                                                        \
        Breach::breach,                                                                              \
        [](double x) -> double { return value_of_x; },                                               \
        []([[maybe_unused]] double a, [[maybe_unused]] double b) -> double { return slope_in_ab; }}; \
    return monotone(f, #row, in[0]);                                                                 \
  }
#define BOUNDED(row, least, most) \
  Outcome rule_##row(Arguments in, uint32_t) { return bounded(least, most, in, 2 * ulp); }
#include "compiler/functions/ranges.def"

constexpr Rule rules[] = {
#define MONOTONE(row, direction, least, most, breach, value, slope) {#row, rule_##row},
#define BOUNDED(row, least, most) {#row, rule_##row},
#define SPECIAL(row) {#row, rule_##row},
#include "compiler/functions/ranges.def"
};

struct RowFacts {
  std::string_view row, signature;
  double ulp;
};
constexpr RowFacts row_facts[] = {
#define FUNCTION(name, signature, ulp, domain, reference, unit) {#name, #signature, ulp},
#include "compiler/functions/functions.def"
};

}  // namespace

const Rule* find_rule(std::string_view row) {
  const auto found = std::ranges::find(rules, row, &Rule::row);
  return found == std::end(rules) ? nullptr : found;
}

bool is_componentwise(std::string_view row) {
  const auto found = std::ranges::find(row_facts, row, &RowFacts::row);
  return found != std::end(row_facts) && found->signature.starts_with('g');
}

double ulp_of(std::string_view row) {
  const auto found = std::ranges::find(row_facts, row, &RowFacts::row);
  return found == std::end(row_facts) ? infinity : found->ulp;
}

}  // namespace isoshade::analysis
