// SPDX-License-Identifier: Apache-2.0
// The boxes of inputs with which a proof ends, and the ranges and errors of results over them.
#pragma once

#include <vector>

#include "compiler/prove/cut.h"

namespace isoshade::prove {

class Leaves {
 public:
  /// All must outlive it.
  Leaves(const Tape& tape, Evaluator& evaluator, Cutter& cutter)
      : tape_(tape), evaluator_(evaluator), cutter_(cutter) {}

  /// Adds a box, which must be the one of the last walk.
  void add(const Box& box) { leaves_.push_back(leaf(box)); }
  void clear() { leaves_.clear(); }
  bool empty() const { return leaves_.empty(); }

  /// Cuts the boxes with the largest errors until `work` operations have been evaluated.
  void refine(uint64_t work);
  /// Evaluates all boxes again.
  void walk();

  std::vector<Bound> bounds() const;     ///< of the outputs, over all boxes
  std::vector<uint32_t> tipped() const;  ///< selects whose condition rounding may tip
  /// The first operation on which the output depends whose error is unknown although its operands' errors are known; or
  /// none.
  uint32_t place_of_loss(size_t output);

 private:
  struct Leaf {
    Box box;
    std::vector<Bound> outputs;
    std::vector<uint32_t> tipped;
  };
  Leaf leaf(const Box& box) const;
  void refine(uint64_t until, double (*measure)(const Bound&));

  const Tape& tape_;
  Evaluator& evaluator_;
  Cutter& cutter_;
  std::vector<Leaf> leaves_;
};

}  // namespace isoshade::prove
