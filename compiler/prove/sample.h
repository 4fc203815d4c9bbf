// SPDX-License-Identifier: Apache-2.0
// Runs a tape on floats, and searches for inputs for which it does not give finite numbers.
#pragma once

#include <functional>
#include <vector>

#include "compiler/prove/evaluate.h"
#include "compiler/ir/interpreter.h"

namespace isoshade::prove {

/// Runs a tape, with the same floats as the interpreter running its function.
class TapeRunner {
 public:
  /// The tape must outlive it.
  explicit TapeRunner(const Tape& tape);

  struct Broken {
    uint32_t operation = none;
    Breach breach = Breach::none;
  };
  /// Runs on the words of the inputs; returns the operations that are evaluated and give no finite number, without
  /// those that read another of them. Sums over lights have one light. Needs lanes::FpGuard.
  const std::vector<Broken>& run(std::span<const uint32_t> inputs);
  uint32_t word(uint32_t operation) const { return words_[operation]; }

 private:
  void compute(const Operation& operation, uint32_t index, std::span<const uint32_t> inputs);
  Breach breach_of(const Operation& operation, uint32_t index) const;
  /// Whether the operation reads, directly or through others, one that broke.
  bool follows_breach(const Operation& operation) const;
  uint32_t row(const Operation& operation);
  uint32_t dot(const Operation& operation) const;

  const Tape& tape_;
  ir::Interpreter interpreter_;
  std::vector<uint32_t> words_;
  std::vector<bool> guard_holds_;
  std::vector<bool> after_breach_;        ///< of operations
  std::vector<bool> guard_after_breach_;  ///< of guards
  std::vector<Broken> broken_;
};

struct Counterexample {
  std::vector<uint32_t> inputs;  ///< words, one an input
  TapeRunner::Broken broken;
};

/// Inputs of a box, as words: ends, middles, equal numbers, parallel vectors; unit vectors of any direction. The same
/// on every run.
std::vector<std::vector<uint32_t>> samples(const Tape& tape, const Box& box, int count);

/// Tries `tries` of them; gives one counterexample for each operation that breaks, at most `most`. `allowed`: whether
/// the inputs that were run last count.
std::vector<Counterexample> search(TapeRunner& runner, const Tape& tape, const Box& box, int tries, size_t most,
                                   const std::function<bool(const std::vector<uint32_t>&)>& allowed);

}  // namespace isoshade::prove
