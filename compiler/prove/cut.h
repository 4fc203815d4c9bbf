// SPDX-License-Identifier: Apache-2.0
// Cuts boxes of inputs in two, along the side that helps most.
#pragma once

#include <functional>
#include <vector>

#include "compiler/prove/evaluate.h"

namespace isoshade::prove {

class Cutter {
 public:
  /// Both must outlive it.
  Cutter(const Tape& tape, Evaluator& evaluator) : tape_(tape), evaluator_(evaluator) {}

  /// What to minimise, as measured after a walk up to an operation; 0 is the optimum.
  struct Aim {
    uint32_t operation = none;
    double before = 0;                ///< the measure of the whole box
    std::function<double()> measure;  ///< that of the last walk
  };
  /// The two halves of the box along the side for which the worse half is best. None if no side can be cut.
  std::vector<Box> cut(const Box& box, const Aim& aim);
  /// The sides of a box as reached in the last walk.
  Box sides_of(const Box& box) const;

 private:
  bool is_whole(size_t side) const {
    return side < tape_.inputs.size() && tape_.inputs[side].scalar != ir::Scalar::floating;
  }
  bool can_be_cut(size_t side, const Side& reached) const;
  /// The sides to try, most promising first.
  struct Candidate {
    size_t side;
    bool is_direct;
  };
  std::vector<Candidate> candidates(const Box& sides, uint32_t operation);

  const Tape& tape_;
  Evaluator& evaluator_;
  uint32_t last_operation_ = none;
  std::vector<Evaluator::Dependence> dependence_of_last_;
};

}  // namespace isoshade::prove
