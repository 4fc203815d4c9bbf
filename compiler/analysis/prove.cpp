// SPDX-License-Identifier: Apache-2.0
#include "compiler/analysis/prove.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <queue>
#include <set>

#include "runtime/lanes/lanes.h"

namespace isoshade::analysis {
namespace {

/// Boxes are cut at most so often in a row.
constexpr int deepest = 90;
/// A proof with so many boxes left open is given up.
constexpr size_t most_open = 12;
/// As many sides as this are tried for a cut.
constexpr size_t most_trials = 12;

/// Boxes into which inputs are cut at most to tell the error better.
constexpr size_t most_leaves = 20'000;
/// Stands for an error that is not bounded, so that some are worse than others.
constexpr double unbounded = 1e30;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Where to cut: numbers matter by their magnitude, and near an end by their distance from it.
double middle(double l, double h) {
  if (l < 0 && h > 0) return 0;
  if (l == 0) return h > 0x1p-100 ? h / 256 : h / 2;
  if (h == 0) return l < -0x1p-100 ? l / 256 : l / 2;
  if (h == 1 && l >= 0.5) return 1 - (1 - l) / 8;
  if (l > 0 && h > 2 * l) return std::sqrt(l) * std::sqrt(h);
  if (h < 0 && l < 2 * h) return -std::sqrt(-l) * std::sqrt(-h);
  return l / 2 + h / 2;
}

struct Task {
  Box box;
  int depth = 0;
};

struct Leaf {
  Box box;
  std::vector<Bound> outputs;
  std::vector<uint32_t> tipped;
};

class Prover {
 public:
  Prover(const Tape& tape, const Effort& effort, const std::vector<Restriction>& where)
      : tape_(tape), effort_(effort), evaluator_(tape), runner_(tape), root_(evaluator_.whole()) {
    for (const Restriction& r : where)
      for (size_t s = 0; s < root_.size(); ++s)
        if (evaluator_.side_name(s) == r.name) restrict(s, r.range);
  }

  Proof run() {
    search_proof();
    proof_.steps = evaluator_.steps();
    return std::move(proof_);
  }

 private:
  void restrict(size_t side, const Side& range);
  void search_proof();
  void conclude();
  /// How bad a walk up to `last` was, by what `measure` says of it; 0 where the box holds nothing.
  template <class Measure>
  double badness(const Box& box, uint32_t last, Measure measure);
  /// The two halves of the box along the side that makes the worse of them least bad.
  template <class Measure>
  std::vector<Box> cut(const Box& box, uint32_t last, double before, Measure measure);
  std::vector<Side> sides_of(const Box& box);
  bool can_be_cut(size_t side, const Side& reached) const;

  void give_up(const Box& box, const Finding& finding);
  bool refute(const Box& box, int tries);
  Leaf leaf(const Box& box) const;
  std::vector<Bound> bounds_of_leaves() const;
  void refine_all();
  uint32_t place_of_loss(size_t output);
  void refine(uint64_t work, double (*measure)(const Bound&));

  const Tape& tape_;
  const Effort& effort_;
  Evaluator evaluator_;
  Runner runner_;
  Box root_;
  Proof proof_;
  std::vector<Leaf> leaves_;
};

void Prover::restrict(size_t side, const Side& range) {
  Side& all = root_[side];
  all = {std::max(all.lo, range.lo), std::min(all.hi, range.hi)};
  const bool whole = side < tape_.inputs.size() && tape_.inputs[side].scalar != ir::Scalar::floating;
  if (whole) all = {std::ceil(all.lo), std::floor(all.hi)};
}

std::vector<Side> Prover::sides_of(const Box& box) {
  std::vector<Side> sides;
  for (size_t s = 0; s < box.size(); ++s) sides.push_back(evaluator_.reached(box, s));
  return sides;
}

bool Prover::can_be_cut(size_t side, const Side& reached) const {
  if (side < tape_.inputs.size() && tape_.inputs[side].scalar != ir::Scalar::floating)
    return reached.hi > reached.lo;
  const double size = std::max(std::abs(reached.lo), std::abs(reached.hi));
  return reached.hi - reached.lo > size * 0x1p-20 && size > smallest;
}

template <class Measure>
double Prover::badness(const Box& box, uint32_t last, Measure measure) {
  return evaluator_.walk(box, last) ? measure() : 0;
}

template <class Measure>
std::vector<Box> Prover::cut(const Box& box, uint32_t last, double before, Measure measure) {
  const std::vector<Side> sides = sides_of(box);
  std::vector<std::pair<double, size_t>> candidates;  // by their width, the widest first
  for (size_t s = 0; s < sides.size(); ++s) {
    if (!evaluator_.depends(last, s) || !can_be_cut(s, sides[s])) continue;
    const double size = std::max(std::abs(sides[s].lo), std::abs(sides[s].hi));
    candidates.emplace_back(-(sides[s].hi - sides[s].lo) / size, s);
  }
  std::ranges::stable_sort(candidates, {}, [](const auto& c) { return c.first; });
  if (candidates.size() > most_trials) {
    // Scalar products say more than the components that they are of.
    std::ranges::stable_sort(candidates, {}, [&](const auto& c) {
      const bool component = c.second < tape_.inputs.size() && tape_.inputs[c.second].vector != none;
      return component;
    });
    candidates.resize(most_trials);
  }
  std::vector<Box> best;
  double least = infinity;
  for (const auto& [width, s] : candidates) {
    Side low = sides[s], high = sides[s];
    const bool whole = s < tape_.inputs.size() && tape_.inputs[s].scalar != ir::Scalar::floating;
    double at = middle(low.lo, low.hi);
    at = whole ? std::floor((low.lo + low.hi) / 2) : rounded(at);
    if (!(at >= low.lo && at < low.hi)) continue;
    low.hi = at;
    high.lo = whole ? at + 1 : at;
    std::vector<Box> halves{box, box};
    halves[0][s] = low;
    halves[1][s] = high;
    const double a = badness(halves[0], last, measure), b = badness(halves[1], last, measure);
    // Nothing won is better than nothing won along a side that matters less: then the wider one is cut.
    const double score = (a > 0 && b > 0 ? 1e6 : 0) + std::max(a, b) + 1e-3 * std::min(a, b) +
                         (std::max(a, b) >= before ? 1e3 * (2 + width) : 0);
    if (score < least) {
      least = score;
      best = std::move(halves);
    }
    if (a == 0 && b == 0) break;
  }
  return best;
}

/// What the last walk, of this box, gave.
Leaf Prover::leaf(const Box& box) const {
  Leaf leaf{box, {}, evaluator_.undecided()};
  for (const Tape::Output& output : tape_.outputs) leaf.outputs.push_back(evaluator_.bound(output.operation));
  return leaf;
}

void Prover::give_up(const Box& box, const Finding& finding) {
  for (Unproved& known : proof_.unproved) {
    if (known.operation != finding.operation) continue;
    ++known.open_boxes;
    return;
  }
  Unproved unproved{finding.operation, finding.breach, {}, 1, {}};
  unproved.box = sides_of(box);
  proof_.unproved.push_back(std::move(unproved));
}

/// Looks for counterexamples in the box; false if there is none.
bool Prover::refute(const Box& box, int tries) {
  const auto allowed = [&](const std::vector<uint32_t>& inputs) {
    for (size_t s = 0; s < root_.size(); ++s) {
      const bool is_input = s < tape_.inputs.size();
      if (is_input && tape_.inputs[s].scalar != ir::Scalar::floating) continue;  // the box has no others
      const uint32_t word = is_input ? inputs[s] : runner_.word(evaluator_.operation_of(s));
      const auto value = static_cast<double>(std::bit_cast<float>(word));
      if (value < root_[s].lo || value > root_[s].hi) return false;
    }
    return true;
  };
  for (const Counterexample& found : search(runner_, tape_, box, tries, allowed)) {
    auto known = std::ranges::find(proof_.unproved, found.broken.operation, &Unproved::operation);
    if (known == proof_.unproved.end()) known = proof_.unproved.emplace(known);
    if (!known->counterexample.empty()) continue;
    known->operation = found.broken.operation;
    known->breach = found.broken.breach;
    known->counterexample = found.inputs;
  }
  return std::ranges::any_of(proof_.unproved, [](const Unproved& u) { return !u.counterexample.empty(); });
}

void Prover::search_proof() {
  std::vector<Task> stack{{root_, 0}};
  const bool crossed = std::ranges::any_of(root_, [](const Side& side) { return side.lo > side.hi; });
  proof_.vacuous = crossed || !evaluator_.walk(root_);
  if (proof_.vacuous) return;
  if (!evaluator_.findings().empty() && refute(stack[0].box, effort_.tries)) return;
  size_t open = 0;
  while (!stack.empty()) {
    const Task task = std::move(stack.back());
    stack.pop_back();
    if (!evaluator_.walk(task.box)) continue;
    if (evaluator_.findings().empty()) {
      leaves_.push_back(leaf(task.box));
      continue;
    }
    const Finding finding = evaluator_.findings()[0];
    const auto measure = [&] {
      double worst = 0;
      for (const Finding& f : evaluator_.findings())
        if (f.operation == finding.operation) worst = f.severity;
      return worst;
    };
    std::vector<Box> halves;
    const bool tired = task.depth >= deepest || evaluator_.steps() > effort_.proof || open >= most_open;
    if (!tired) halves = cut(task.box, finding.operation, finding.severity, measure);
    if (halves.empty()) {
      ++open;
      evaluator_.walk(task.box, finding.operation);
      give_up(task.box, finding);
      const bool hopeless = open == 1 && refute(sides_of(task.box), effort_.tries);
      if (hopeless) return;
      continue;
    }
    for (Box& half : halves) stack.push_back({std::move(half), task.depth + 1});
  }
  proof_.vacuous = proof_.unproved.empty() && leaves_.empty();
  if (proof_.unproved.empty() && !proof_.vacuous) conclude();
}

/// The bounds of the outputs over all boxes.
void Prover::conclude() {
  refine_all();
  proof_.outputs = proof_.followed = bounds_of_leaves();
  const bool tips = std::ranges::any_of(leaves_, [](const Leaf& l) { return !l.tipped.empty(); });
  if (tips) {
    evaluator_.follow_branches(true);
    for (Leaf& l : leaves_)
      if (evaluator_.walk(l.box)) l = leaf(l.box);
    refine_all();
    proof_.followed = bounds_of_leaves();
    std::set<uint32_t> tipped;
    for (const Leaf& l : leaves_) tipped.insert(l.tipped.begin(), l.tipped.end());
    proof_.tipped.assign(tipped.begin(), tipped.end());
  }
  for (size_t o = 0; o < tape_.outputs.size(); ++o) proof_.lost.push_back(place_of_loss(o));
}

void Prover::refine_all() {
  refine(evaluator_.steps() + effort_.error / 2, [](const Bound& b) { return b.relative_error(); });
  refine(evaluator_.steps() + effort_.error / 2, [](const Bound& b) { return b.absolute; });
}

std::vector<Bound> Prover::bounds_of_leaves() const {
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

/// The first operation that the output depends on and whose error is unknown, though those of its operands are known.
uint32_t Prover::place_of_loss(size_t output) {
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

/// Cuts the boxes with the largest errors until so many operations have been walked.
void Prover::refine(uint64_t work, double (*measure)(const Bound&)) {
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
  std::priority_queue<Worst> queue;
  for (size_t i = 0; i < leaves_.size(); ++i) queue.push(worst_of(i));
  while (!queue.empty() && evaluator_.steps() < work && leaves_.size() < most_leaves) {
    const Worst worst = queue.top();
    queue.pop();
    if (worst.error == 0) return;
    const Box box = leaves_[worst.leaf].box;
    evaluator_.walk(box);
    const auto error_there = [&] { return capped(evaluator_.bound(worst.output)); };
    std::vector<Leaf> halves;
    for (const Box& half : cut(box, worst.output, worst.error, error_there))
      if (evaluator_.walk(half)) halves.push_back(leaf(half));
    if (halves.empty()) continue;  // it cannot be cut: it stays as it is
    leaves_[worst.leaf] = std::move(halves[0]);
    queue.push(worst_of(worst.leaf));
    if (halves.size() == 1) continue;
    leaves_.push_back(std::move(halves[1]));
    queue.push(worst_of(leaves_.size() - 1));
  }
}

}  // namespace

std::vector<std::string> sides_of(const Tape& tape) {
  const Evaluator evaluator(tape);
  std::vector<std::string> names;
  for (size_t s = 0; s < evaluator.side_count(); ++s) names.push_back(evaluator.side_name(s));
  return names;
}

Proof prove(const Tape& tape, const Effort& effort, const std::vector<Restriction>& where) {
  const lanes::FpGuard guard;
  return Prover(tape, effort, where).run();
}

}  // namespace isoshade::analysis
