// SPDX-License-Identifier: Apache-2.0
// A tape run on floats, and the search for inputs on which it breaks.
#pragma once

#include <functional>
#include <vector>

#include "compiler/prove/evaluate.h"
#include "compiler/ir/interpreter.h"

namespace isoshade::prove {

/// Runs a tape as the interpreter runs its function: the same floats.
class TapeRunner {
 public:
  /// The tape must outlive it.
  explicit TapeRunner(const Tape& tape);

  struct Broken {
    uint32_t operation = none;
    Breach breach = Breach::none;
  };
  /// Runs on the words of the inputs; returns the operations that are looked at and give no finite number, without
  /// those that read what another of them gave. Needs lanes::FpGuard. Sums over lights are of one light.
  const std::vector<Broken>& run(std::span<const uint32_t> inputs);
  uint32_t word(uint32_t operation) const { return words_[operation]; }

 private:
  void compute(const Operation& operation, uint32_t index, std::span<const uint32_t> inputs);
  Breach breach_of(const Operation& operation, uint32_t index) const;
  /// Whether what the operation gives comes from an operation that broke.
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

/// Inputs of a box, as words: ends, middles, equal ones, vectors along each other. The same on every run. Unit vectors
/// are of any direction.
std::vector<std::vector<uint32_t>> samples(const Tape& tape, const Box& box, int count);

/// Tries so many of them; one counterexample for each operation that breaks, of at most so many. `allowed`: of the inputs
/// that were run last, whether they count.
std::vector<Counterexample> search(TapeRunner& runner, const Tape& tape, const Box& box, int tries, size_t most,
                                   const std::function<bool(const std::vector<uint32_t>&)>& allowed);

}  // namespace isoshade::prove
