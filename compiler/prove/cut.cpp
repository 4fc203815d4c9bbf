// SPDX-License-Identifier: Apache-2.0
#include "compiler/prove/cut.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isoshade::prove {
namespace {

/// The number of sides that are tried for a cut.
constexpr size_t most_trials = 12;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Where to cut: on a logarithmic scale of the magnitude, or of the distance from a near end.
double middle(double l, double h) {
  if (l < 0 && h > 0) return 0;
  if (l == 0) return h > 0x1p-100 ? h / 256 : h / 2;
  if (h == 0) return l < -0x1p-100 ? l / 256 : l / 2;
  if (h == 1 && l >= 0.5) return 1 - (1 - l) / 8;
  if (l > 0 && h > 2 * l) return std::sqrt(l) * std::sqrt(h);
  if (h < 0 && l < 2 * h) return -std::sqrt(-l) * std::sqrt(-h);
  return l / 2 + h / 2;
}

double relative_width(const Side& side) {
  return (side.hi - side.lo) / std::max(std::abs(side.lo), std::abs(side.hi));
}

}  // namespace

Box Cutter::sides_of(const Box& box) const {
  Box sides;
  for (size_t s = 0; s < box.size(); ++s) sides.push_back(evaluator_.reached(box, s));
  return sides;
}

bool Cutter::can_be_cut(size_t side, const Side& reached) const {
  if (is_whole(side)) return reached.hi > reached.lo;
  const double size = std::max(std::abs(reached.lo), std::abs(reached.hi));
  return reached.hi - reached.lo > size * 0x1p-20 && size > smallest;
}

/// The sides that the operation depends on: first those that it depends on directly, as on a scalar product more than
/// on the components; of these the widest first.
std::vector<Cutter::Candidate> Cutter::candidates(const Box& sides, uint32_t operation) {
  if (last_operation_ != operation) dependence_of_last_ = evaluator_.dependence(operation);
  last_operation_ = operation;
  std::vector<Candidate> candidates;
  for (size_t s = 0; s < sides.size(); ++s) {
    const Evaluator::Dependence dependence = dependence_of_last_[s];
    if (dependence != Evaluator::Dependence::none && can_be_cut(s, sides[s]))
      candidates.push_back({s, dependence == Evaluator::Dependence::direct});
  }
  std::ranges::stable_sort(candidates, [&](const Candidate& a, const Candidate& b) {
    if (a.is_direct != b.is_direct) return a.is_direct;
    return relative_width(sides[a.side]) > relative_width(sides[b.side]);
  });
  if (candidates.size() > most_trials) candidates.resize(most_trials);
  return candidates;
}

std::vector<Box> Cutter::cut(const Box& box, const Aim& aim) {
  const Box sides = sides_of(box);
  std::vector<Box> best;
  double least = infinity;
  bool wins = false;
  for (const auto& [s, is_direct] : candidates(sides, aim.operation)) {
    if (!is_direct && wins) break;
    Side low = sides[s], high = sides[s];
    const bool whole = is_whole(s);
    const double at = whole ? std::floor((low.lo + low.hi) / 2) : rounded(middle(low.lo, low.hi));
    if (!(at >= low.lo && at < low.hi)) continue;
    low.hi = at;
    high.lo = whole ? at + 1 : at;
    std::vector<Box> halves{box, box};
    halves[0][s] = low;
    halves[1][s] = high;
    const auto badness = [&](const Box& half) {
      return evaluator_.walk(half, aim.operation) ? aim.measure() : 0;
    };
    const double a = badness(halves[0]), b = badness(halves[1]);
    // Nothing won is better than nothing won along a side that matters less: then the wider one is cut.
    const double score = (a > 0 && b > 0 ? 1e6 : 0) + std::max(a, b) + 1e-3 * std::min(a, b) +
                         (std::max(a, b) >= aim.before ? 1e3 * (2 - relative_width(sides[s])) : 0);
    wins = wins || std::max(a, b) < aim.before;
    if (score < least) {
      least = score;
      best = std::move(halves);
    }
    if (a == 0 && b == 0) break;
  }
  return best;
}

}  // namespace isoshade::prove
