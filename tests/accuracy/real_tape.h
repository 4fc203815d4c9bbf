// SPDX-License-Identifier: Apache-2.0
// Tapes of the analysis, computed in 57 digits.
#pragma once

#include <vector>

#include "backends/reference/real.h"
#include "compiler/analysis/sample.h"

namespace isoshade::accuracy {

/// What exact arithmetic makes of the inputs of a run.
class RealTape {
 public:
  /// Both must outlive it.
  RealTape(const analysis::Tape& tape, const analysis::Runner& floats) : tape_(tape), floats_(floats) {}

  /// Of the inputs that the runner ran last. `follow`: selects take the sides that floats took. Sums over lights are of
  /// one light, as the runner's.
  void run(std::span<const uint32_t> inputs, bool follow);
  const reference::Real& number(uint32_t operation) const { return cells_[operation].number; }

 private:
  struct Cell {
    reference::Real number;  ///< of a float
    uint32_t word = 0;       ///< of an integer or a boolean
  };
  Cell value_of(const analysis::Operation& operation, uint32_t index, std::span<const uint32_t> inputs,
                bool follow);
  Cell op(const analysis::Operation& operation, bool follow);
  reference::Real row(const analysis::Operation& operation) const;
  reference::Real dot(std::span<const uint32_t> in) const;

  const analysis::Tape& tape_;
  const analysis::Runner& floats_;
  std::vector<Cell> cells_;
};

}  // namespace isoshade::accuracy
