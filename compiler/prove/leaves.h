// SPDX-License-Identifier: Apache-2.0
// The boxes of inputs that a proof ends with, and what they say of results: ranges and errors.
#pragma once

#include <vector>

#include "compiler/prove/cut.h"

namespace isoshade::prove {

class Leaves {
 public:
  /// All must outlive it.
  Leaves(const Tape& tape, Evaluator& evaluator, Cutter& cutter)
      : tape_(tape), evaluator_(evaluator), cutter_(cutter) {}

  /// Adds a box, as the last walk, of this box, left it.
  void add(const Box& box) { leaves_.push_back(leaf(box)); }
  void clear() { leaves_.clear(); }
  bool empty() const { return leaves_.empty(); }

  /// Cuts the boxes with the largest errors until so many operations have been walked.
  void refine(uint64_t work);
  /// Walks all boxes again.
  void walk();

  std::vector<Bound> bounds() const;     ///< of the outputs, over all boxes
  std::vector<uint32_t> tipped() const;  ///< selects whose condition rounding may tip
  /// The first operation that the output depends on and whose error is unknown, though those of its operands are known;
  /// or none.
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
