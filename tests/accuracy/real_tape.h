// SPDX-License-Identifier: Apache-2.0
// Tapes of the prover, computed in 57 digits.
#pragma once

#include <vector>

#include "backends/reference/evaluator.h"
#include "compiler/prove/sample.h"

namespace isoshade::accuracy {

/// What exact arithmetic makes of the inputs of a run.
class RealTape {
 public:
  /// Both must outlive it.
  RealTape(const prove::Tape& tape, const prove::TapeRunner& floats) : tape_(tape), floats_(floats) {}

  /// Of the inputs that the runner ran last. `follow`: selects take the sides that floats took. Sums over lights are of
  /// one light, as the runner's.
  void run(std::span<const uint32_t> inputs, bool follow);
  const reference::Real& number(uint32_t operation) const { return cells_[operation].number; }

 private:
  using Cell = reference::Cell;
  Cell value_of(const prove::Operation& operation, uint32_t index, std::span<const uint32_t> inputs,
                bool follow);
  Cell op(const prove::Operation& operation, bool follow);
  reference::Real row(const prove::Operation& operation) const;
  reference::Real dot(std::span<const uint32_t> in) const;

  const prove::Tape& tape_;
  const prove::TapeRunner& floats_;
  std::vector<Cell> cells_;
};

}  // namespace isoshade::accuracy
