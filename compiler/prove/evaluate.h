// SPDX-License-Identifier: Apache-2.0
// Evaluates a tape on bounds: what each operation can give for inputs in a box, and what could not be proved of it.
#pragma once

#include <array>
#include <vector>

#include "compiler/prove/tape.h"

namespace isoshade::prove {

/// The ranges of the inputs, and of the operations along which boxes are also cut.
using Box = std::vector<Side>;

struct Finding {
  uint32_t operation = none;
  Breach breach = Breach::none;
  double severity = 0;  ///< how far it is from a proof; comparable between boxes
};

class Evaluator {
 public:
  /// The tape must outlive it.
  explicit Evaluator(const Tape& tape);

  /// The box of all inputs.
  Box whole() const;
  /// A box has a side for each input, then for each scalar product and clamped number.
  size_t side_count() const { return tape_.inputs.size() + cuts_.size(); }
  /// A side in the last walk: its range, intersected with what the operation gave.
  Side reached(const Box& box, size_t side) const;
  std::string side_name(size_t side) const;
  /// The operation of a side beyond the inputs.
  uint32_t operation_of(size_t side) const { return cuts_[side - tape_.inputs.size()]; }
  /// How an operation depends on a side; indirect: only through other sides.
  enum class Dependence : uint8_t { none, indirect, direct };
  /// By side.
  std::vector<Dependence> dependence(uint32_t operation) const;

  /// From now on, operations that read this one are judged as if it always gave a finite number.
  void accept(uint32_t operation) { accepted_[operation] = true; }
  bool is_accepted(uint32_t operation) const { return accepted_[operation]; }

  /// Evaluates the operations up to `last`. False if the box contains no input at all. Needs lanes::FpGuard.
  bool walk(const Box& box, uint32_t last);
  bool walk(const Box& box) { return walk(box, static_cast<uint32_t>(tape_.operations.size() - 1)); }
  /// What the last walk did not prove: the first of each chain of operations, and those that read accepted ones.
  const std::vector<Finding>& findings() const { return findings_; }
  const Bound& bound(uint32_t operation) const { return bounds_[operation]; }
  bool is_reached(uint32_t operation) const { return states_[operation] != State::dead; }
  /// The selects of the last walk whose condition may be different in exact arithmetic.
  const std::vector<uint32_t>& undecided() const { return undecided_; }
  /// Whether errors are relative to exact arithmetic that takes the same sides of selects as floats do, or to exact
  /// arithmetic that decides for itself.
  void follow_branches(bool follow) { follows_branches_ = follow; }
  uint64_t steps() const { return steps_; }  ///< operations evaluated so far

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
