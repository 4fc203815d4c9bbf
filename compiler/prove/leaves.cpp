// SPDX-License-Identifier: Apache-2.0
#include "compiler/prove/leaves.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <set>

namespace isoshade::prove {
namespace {

/// The most boxes into which inputs are cut for a better bound of the error, and the most sides of all of them.
constexpr size_t most_leaves = 20'000, most_sides = 4'000'000;
/// Stands for an unbounded error, so that these can be compared.
constexpr double unbounded = 1e30;

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

Leaves::Leaf Leaves::leaf(const Box& box) const {
  Leaf leaf{box, {}, evaluator_.undecided()};
  for (const Tape::Output& output : tape_.outputs) leaf.outputs.push_back(evaluator_.bound(output.operation));
  return leaf;
}

void Leaves::refine(uint64_t work) {
  refine(evaluator_.steps() + work / 2, [](const Bound& b) { return b.relative_error(); });
  refine(evaluator_.steps() + work / 2, [](const Bound& b) { return b.absolute; });
}

void Leaves::walk() {
  for (Leaf& l : leaves_)
    if (evaluator_.walk(l.box)) l = leaf(l.box);
}

std::vector<Bound> Leaves::bounds() const {
  std::vector<Bound> bounds;
  for (size_t o = 0; o < tape_.outputs.size(); ++o) {
    Bound all{infinity, -infinity};
    for (const Leaf& leaf : leaves_) {
      const Bound& b = leaf.outputs[o];
      const Bound::Share share = b.share();
      all = {std::min(all.lo, b.lo), std::max(all.hi, b.hi), std::max(all.absolute, b.absolute),
             std::max(all.relative, share.error), std::max(all.slack, share.slack)};
    }
    bounds.push_back(all);
  }
  return bounds;
}

std::vector<uint32_t> Leaves::tipped() const {
  std::set<uint32_t> tipped;
  for (const Leaf& l : leaves_) tipped.insert(l.tipped.begin(), l.tipped.end());
  return {tipped.begin(), tipped.end()};
}

uint32_t Leaves::place_of_loss(size_t output) {
  const auto unknown = [&](const Leaf& l) { return l.outputs[output].absolute > largest; };
  const auto worst = std::ranges::find_if(leaves_, unknown);
  if (worst == leaves_.end() || !evaluator_.walk(worst->box)) return none;
  const uint32_t last = tape_.outputs[output].operation;
  std::vector<bool> needed(last + 1);
  needed[last] = true;
  uint32_t lost = none;
  for (uint32_t i = last + 1; i-- > 0;) {
    if (!needed[i] || !evaluator_.is_reached(i) || evaluator_.bound(i).absolute <= largest) continue;
    lost = i;
    for (const uint32_t operand : tape_.operands_of(tape_.operations[i])) needed[operand] = true;
  }
  return lost;
}

void Leaves::refine(uint64_t until, double (*measure)(const Bound&)) {
  struct Worst {
    double error;
    uint32_t output;  ///< an operation
    size_t leaf;
    bool operator<(const Worst& other) const {
      return error != other.error ? error < other.error : leaf > other.leaf;
    }
  };
  const auto capped = [&](const Bound& b) { return std::min(measure(b), unbounded); };
  const auto worst_of = [&](size_t leaf) {
    Worst worst{0, 0, leaf};
    for (size_t o = 0; o < tape_.outputs.size(); ++o)
      if (const double error = capped(leaves_[leaf].outputs[o]); error > worst.error)
        worst = {error, tape_.outputs[o].operation, leaf};
    return worst;
  };
  const size_t most = std::min(most_leaves, most_sides / std::max<size_t>(evaluator_.side_count(), 1));
  std::priority_queue<Worst> queue;
  for (size_t i = 0; i < leaves_.size(); ++i) queue.push(worst_of(i));
  while (!queue.empty() && evaluator_.steps() < until && leaves_.size() < most) {
    const Worst worst = queue.top();
    queue.pop();
    if (worst.error == 0) return;
    const Box box = leaves_[worst.leaf].box;
    evaluator_.walk(box);
    const Cutter::Aim aim{worst.output, worst.error, [&] { return capped(evaluator_.bound(worst.output)); }};
    std::vector<Leaf> halves;
    for (const Box& half : cutter_.cut(box, aim))
      if (evaluator_.walk(half)) halves.push_back(leaf(half));
    if (halves.empty()) continue;  // it cannot be cut
    leaves_[worst.leaf] = std::move(halves[0]);
    queue.push(worst_of(worst.leaf));
    if (halves.size() == 1) continue;
    leaves_.push_back(std::move(halves[1]));
    queue.push(worst_of(leaves_.size() - 1));
  }
}

}  // namespace isoshade::prove
