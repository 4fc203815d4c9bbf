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

  /// What to make less, as a walk up to an operation left it; 0: nothing is left to do.
  struct Aim {
    uint32_t operation = none;
    double before = 0;                ///< of the whole box
    std::function<double()> measure;  ///< of the last walk
  };
  /// The two halves of the box along the side that makes the worse of them least bad. None if no side can be cut.
  std::vector<Box> cut(const Box& box, const Aim& aim);
  /// What the sides of a box were in the last walk.
  Box sides_of(const Box& box) const;

 private:
  bool is_whole(size_t side) const {
    return side < tape_.inputs.size() && tape_.inputs[side].scalar != ir::Scalar::floating;
  }
  bool can_be_cut(size_t side, const Side& reached) const;
  /// The sides to try, the first ones first.
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
