// SPDX-License-Identifier: Apache-2.0
#include "compiler/prove/prove.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <unordered_map>

#include "compiler/prove/leaves.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::prove {
namespace {

/// The most cuts in a row.
constexpr int deepest = 90;
/// With this many open boxes, the proof of an operation is given up.
constexpr size_t most_open = 12;
/// The most operations that are reported as not proved, and the most numbers in all reports.
constexpr size_t most_unproved = 1000, most_numbers = 4'000'000;

struct Task {
  Box box;
  int depth = 0;
  std::vector<uint32_t> given_up;  ///< operations of which nothing more is proved in this box
};

class Prover {
 public:
  Prover(const Tape& tape, const Effort& effort, const std::vector<Restriction>& where)
      : tape_(tape),
        effort_(effort),
        evaluator_(tape),
        runner_(tape),
        cutter_(tape, evaluator_),
        leaves_(tape, evaluator_, cutter_),
        root_(evaluator_.whole()),
        is_settled_(tape.operations.size()),
        most_unproved_(std::min(most_unproved, most_numbers / std::max<size_t>(root_.size(), 1))),
        samples_left_(effort.samples) {
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
  void sort_unproved();
  const Finding* next_finding(const Task& task) const;
  bool is_tired(const Task& task, const Finding& finding);
  std::vector<Box> cut(const Task& task, const Finding& finding);

  bool is_full() const { return proof_.unproved.size() >= most_unproved_; }
  bool is_later(uint32_t operation);
  std::vector<bool> readers_of(const std::function<bool(uint32_t)>& is_given) const;
  Unproved& unproved_of(uint32_t operation, Breach breach);
  void give_up(const Box& box, const Finding& finding);
  /// Operations that read this one are then judged as if it gave a finite number.
  void accept(uint32_t operation);
  void refute(const Box& box);
  bool is_allowed(const std::vector<uint32_t>& inputs) const;

  const Tape& tape_;
  const Effort& effort_;
  Evaluator evaluator_;
  TapeRunner runner_;
  Cutter cutter_;
  Leaves leaves_;
  Box root_;
  Proof proof_;
  std::vector<bool> is_settled_;                 ///< of operations: nothing more is asked of them
  std::vector<bool> reads_accepted_;             ///< of operations, also through others; empty: not known
  std::unordered_map<uint32_t, uint64_t> work_;  ///< for each operation
  std::unordered_map<uint32_t, size_t> at_;      ///< where operations are in Proof::unproved
  const size_t most_unproved_;
  uint64_t samples_left_;
};

void Prover::restrict(size_t side, const Side& range) {
  Side& all = root_[side];
  all = {std::max(all.lo, range.lo), std::min(all.hi, range.hi)};
  const bool whole = side < tape_.inputs.size() && tape_.inputs[side].scalar != ir::Scalar::floating;
  if (whole) all = {std::ceil(all.lo), std::floor(all.hi)};
}

void Prover::accept(uint32_t operation) {
  evaluator_.accept(operation);
  reads_accepted_.clear();
}

/// Whether the operation reads an accepted one, directly or through others.
bool Prover::is_later(uint32_t operation) {
  if (reads_accepted_.empty())
    reads_accepted_ = readers_of([&](uint32_t o) { return evaluator_.is_accepted(o); });
  return reads_accepted_[operation];
}

/// By operation: whether it reads, directly or through others, one for which `is_given` holds.
std::vector<bool> Prover::readers_of(const std::function<bool(uint32_t)>& is_given) const {
  std::vector<bool> readers(tape_.operations.size());
  for (uint32_t i = 0; i < tape_.operations.size(); ++i)
    readers[i] = std::ranges::any_of(tape_.operands_of(tape_.operations[i]),
                                     [&](uint32_t operand) { return readers[operand] || is_given(operand); });
  return readers;
}

Unproved& Prover::unproved_of(uint32_t operation, Breach breach) {
  const auto [known, is_new] = at_.try_emplace(operation, proof_.unproved.size());
  if (is_new) proof_.unproved.emplace_back(Unproved{operation, breach, {}, 0, {}});
  return proof_.unproved[known->second];
}

void Prover::give_up(const Box& box, const Finding& finding) {
  Unproved& unproved = unproved_of(finding.operation, finding.breach);
  if (++unproved.open_boxes >= most_open) is_settled_[finding.operation] = true;
  if (unproved.open_boxes > 1) return;
  const Box sides = unproved.box = cutter_.sides_of(box);
  accept(finding.operation);
  refute(sides);
}

bool Prover::is_allowed(const std::vector<uint32_t>& inputs) const {
  for (size_t s = 0; s < root_.size(); ++s) {
    const bool is_input = s < tape_.inputs.size();
    if (is_input && tape_.inputs[s].scalar != ir::Scalar::floating) continue;  // the box has no others
    const uint32_t word = is_input ? inputs[s] : runner_.word(evaluator_.operation_of(s));
    const auto value = static_cast<double>(std::bit_cast<float>(word));
    if (value < root_[s].lo || value > root_[s].hi) return false;
  }
  return true;
}

/// Looks for counterexamples in the box.
void Prover::refute(const Box& box) {
  const uint64_t a_try = std::max<size_t>(tape_.operations.size(), 1);
  const uint64_t tries = std::min<uint64_t>(static_cast<uint64_t>(effort_.tries), samples_left_ / a_try);
  samples_left_ -= tries * a_try;
  const auto allowed = [&](const std::vector<uint32_t>& inputs) { return is_allowed(inputs); };
  for (const Counterexample& found :
       search(runner_, tape_, box, static_cast<int>(tries), most_unproved_, allowed)) {
    if (is_full()) break;
    Unproved& unproved = unproved_of(found.broken.operation, found.broken.breach);
    if (!unproved.counterexample.empty()) continue;
    unproved.breach = found.broken.breach;
    unproved.counterexample = found.inputs;
    is_settled_[found.broken.operation] = true;
    accept(found.broken.operation);
  }
}

const Finding* Prover::next_finding(const Task& task) const {
  for (const Finding& finding : evaluator_.findings())
    if (!is_settled_[finding.operation] && std::ranges::count(task.given_up, finding.operation) == 0)
      return &finding;
  return nullptr;
}

bool Prover::is_tired(const Task& task, const Finding& finding) {
  const uint64_t most = is_later(finding.operation) ? effort_.later : effort_.proof;
  return task.depth >= deepest || work_[finding.operation] > most || evaluator_.steps() > 2 * effort_.proof;
}

std::vector<Box> Prover::cut(const Task& task, const Finding& finding) {
  const uint64_t before = evaluator_.steps();
  const auto measure = [&] {
    double worst = 0;
    for (const Finding& f : evaluator_.findings())
      if (f.operation == finding.operation) worst = f.severity;
    return worst;
  };
  std::vector<Box> halves = cutter_.cut(task.box, {finding.operation, finding.severity, measure});
  work_[finding.operation] += evaluator_.steps() - before;
  return halves;
}

void Prover::search_proof() {
  const bool crossed = std::ranges::any_of(root_, [](const Side& side) { return side.lo > side.hi; });
  proof_.vacuous = crossed || !evaluator_.walk(root_);
  if (proof_.vacuous) return;
  if (!evaluator_.findings().empty()) refute(root_);
  std::vector<Task> stack;
  stack.push_back({root_, 0, {}});
  // Where an operation is given up, the box is walked again for what reads it: so often at most.
  const uint64_t most_steps = 3 * effort_.proof + 100 * tape_.operations.size();
  while (!stack.empty()) {
    proof_.unfinished = is_full() || evaluator_.steps() > most_steps;
    if (proof_.unfinished) break;
    Task task = std::move(stack.back());
    stack.pop_back();
    if (!evaluator_.walk(task.box)) continue;
    const Finding* next = next_finding(task);
    if (next == nullptr) {
      if (proof_.unproved.empty()) leaves_.add(task.box);
      continue;
    }
    const Finding finding = *next;
    std::vector<Box> halves;
    if (!is_tired(task, finding)) halves = cut(task, finding);
    for (Box& half : halves) stack.push_back({std::move(half), task.depth + 1, task.given_up});
    if (!halves.empty()) continue;
    evaluator_.walk(task.box);
    give_up(task.box, finding);
    task.given_up.push_back(finding.operation);
    stack.push_back(std::move(task));
  }
  sort_unproved();
  proof_.vacuous = proof_.unproved.empty() && leaves_.empty();
  if (proof_.unproved.empty() && !proof_.vacuous) conclude();
}

void Prover::sort_unproved() {
  const std::vector<bool> is_reader = readers_of([&](uint32_t o) { return at_.contains(o); });
  std::ranges::sort(proof_.unproved, {}, &Unproved::operation);
  std::vector<Unproved> unproved;
  for (Unproved& u : proof_.unproved) {
    const bool later = is_reader[u.operation] && u.counterexample.empty();
    (later ? proof_.later : unproved).push_back(std::move(u));
  }
  proof_.unproved = std::move(unproved);
}

/// The bounds of the outputs over all boxes.
void Prover::conclude() {
  const bool tips = !leaves_.tipped().empty();
  const uint64_t work = tips ? effort_.error / 2 : effort_.error;
  leaves_.refine(work);
  proof_.outputs = proof_.followed = leaves_.bounds();
  if (tips) {
    evaluator_.follow_branches(true);
    leaves_.walk();
    leaves_.refine(work);
    proof_.followed = leaves_.bounds();
    proof_.tipped = leaves_.tipped();
  }
  for (size_t o = 0; o < tape_.outputs.size(); ++o) proof_.lost.push_back(leaves_.place_of_loss(o));
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

}  // namespace isoshade::prove
