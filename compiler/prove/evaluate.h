// SPDX-License-Identifier: Apache-2.0
// A tape walked by bounds: what every operation may give for inputs in a box, and what is not proved of it.
#pragma once

#include <array>
#include <vector>

#include "compiler/prove/tape.h"

namespace isoshade::prove {

/// Where the inputs lie, and the operations that boxes are cut along too.
using Box = std::vector<Side>;

struct Finding {
  uint32_t operation = none;
  Breach breach = Breach::none;
  double severity = 0;  ///< how far from being proved; comparable between boxes
};

class Evaluator {
 public:
  /// The tape must outlive it.
  explicit Evaluator(const Tape& tape);

  /// All inputs in their ranges.
  Box whole() const;
  /// Inputs, then scalar products and what is clamped: a box has a side for each.
  size_t side_count() const { return tape_.inputs.size() + cuts_.size(); }
  /// What a side was in the last walk: its range cut by what the operation gave there.
  Side reached(const Box& box, size_t side) const;
  std::string side_name(size_t side) const;
  /// The operation that a side beyond the inputs is of.
  uint32_t operation_of(size_t side) const { return cuts_[side - tape_.inputs.size()]; }
  /// How an operation depends on a side: directly, or only through other sides.
  enum class Dependence : uint8_t { none, indirect, direct };
  /// By side.
  std::vector<Dependence> dependence(uint32_t operation) const;

  /// From here on what reads the operation is judged as if it always gave a finite number.
  void accept(uint32_t operation) { accepted_[operation] = true; }
  bool is_accepted(uint32_t operation) const { return accepted_[operation]; }

  /// Walks operations up to `last`. False if the box holds no input at all. Needs lanes::FpGuard.
  bool walk(const Box& box, uint32_t last);
  bool walk(const Box& box) { return walk(box, static_cast<uint32_t>(tape_.operations.size() - 1)); }
  /// What the last walk did not prove; of operations that read each other's results only the first, and those that
  /// read what accepted ones give.
  const std::vector<Finding>& findings() const { return findings_; }
  const Bound& bound(uint32_t operation) const { return bounds_[operation]; }
  bool is_reached(uint32_t operation) const { return states_[operation] != State::dead; }
  /// The selects of the last walk whose condition exact arithmetic may decide otherwise.
  const std::vector<uint32_t>& undecided() const { return undecided_; }
  /// Whether errors are those against exact arithmetic that takes the sides of selects that floats take. Else it takes
  /// its own.
  void follow_branches(bool follow) { follows_branches_ = follow; }
  uint64_t steps() const { return steps_; }  ///< operations walked so far

 private:
  /// value >= factor * base - slack, where base >= 0
  struct Proportion {
    uint32_t base = none;
    double factor = 0, slack = 0;
  };
  using Proportions = std::array<Proportion, 3>;
  enum class State : uint8_t { good, doubtful, dead };

  Outcome outcome_of(const Operation& operation, uint32_t index);
  Outcome least_of(std::span<const uint32_t> in) const;
  Outcome answer_of(Answer answer, std::span<const uint32_t> in) const;
  Outcome dot_of(std::span<const uint32_t> in) const;
  Outcome select_of(std::span<const uint32_t> in, uint32_t index);
  bool narrow(const Operation& operation, uint32_t index);
  void enter(const Operation& operation);
  /// The lengths of a vector as computed and of its error, at most.
  struct Lengths {
    double vector = 0, error = 0;
  };
  Lengths lengths_of(uint32_t shape) const;
  void limit_error(uint32_t index, size_t terms, const Lengths& a, const Lengths& b);
  bool apply_facts(const Operation& operation, uint32_t index);
  void carry_proportion(const Operation& operation, uint32_t index);
  void limit_quotient(uint32_t index, const Proportion& of_divisor);
  void limit_square(uint32_t index);
  void limit_remainder(uint32_t index);
  void limit_residual(uint32_t index);
  /// Keeps as many as there is room for.
  void propose(uint32_t index, const Proportion& proportion);
  bool restrict(uint32_t index, double lo, double hi);
  bool units_possible(const Box& box) const;
  double severity_of(const Operation& operation, Breach breach) const;

  const Tape& tape_;
  std::vector<uint32_t> cuts_;    ///< the scalar products and clamps
  std::vector<uint32_t> cut_of_;  ///< of operations: which cut, or none
  std::vector<bool> accepted_;
  std::vector<const std::vector<Fact>*> facts_of_;  ///< of operations: null if there are none
  std::vector<Bound> arguments_;                    ///< of the row that is walked
  std::vector<Bound> bounds_;
  std::vector<State> states_;
  std::vector<Proportions> proportions_;
  std::vector<bool> guard_dead_;
  std::vector<Finding> findings_;
  std::vector<uint32_t> undecided_;
  bool follows_branches_ = false;
  uint64_t steps_ = 0;
};

}  // namespace isoshade::prove
