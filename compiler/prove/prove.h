// SPDX-License-Identifier: Apache-2.0
// Proves that a tape gives finite numbers for all its inputs, and bounds its error, by branch and bound: a box of
// inputs for which a proof fails is cut in two, along the side that helps most.
#pragma once

#include <string>
#include <vector>

#include "compiler/prove/sample.h"

namespace isoshade::prove {

/// The most work that a proof may take, in operations evaluated: so that it ends alike on every machine.
struct Effort {
  uint64_t proof = 12'000'000;  ///< for one operation; for all together twice that
  uint64_t later = 500'000;     ///< for one operation that reads another one that is not proved
  uint64_t error = 4'000'000;
  uint64_t samples = 30'000'000;
  int tries = 1500;  ///< inputs tried for a counterexample, in a box that was not proved
};

struct Unproved {
  uint32_t operation = none;
  Breach breach = Breach::none;
  std::vector<uint32_t> counterexample;  ///< words of the inputs; empty: none was found
  size_t open_boxes = 0;                 ///< boxes in which it is not proved; counted up to a few
  Box box;                               ///< one of them, as it was reached
};

/// The result of a proof over all inputs.
struct Proof {
  bool vacuous = false;            ///< no input lies within all ranges; then nothing else is set
  std::vector<Unproved> unproved;  ///< in the order of the tape; empty if everything is proved
  /// Operations that read an unproved one and are not proved either, for inputs where what they read is finite.
  std::vector<Unproved> later;
  bool unfinished = false;     ///< more may be unproved; then `unproved` is not empty
  std::vector<Bound> outputs;  ///< of Tape::outputs; meaningless unless everything is proved
  /// The same with errors relative to exact arithmetic that takes the same side of each select. They are smaller where
  /// rounding may tip a comparison.
  std::vector<Bound> followed;
  std::vector<uint32_t> tipped;  ///< selects whose condition rounding may tip
  /// By output: the operation where even the error of `followed` gets larger than any float, or none.
  std::vector<uint32_t> lost;
  uint64_t steps = 0;  ///< operations evaluated
};

/// A range to which an input, a scalar product or a clamped number is restricted.
struct Restriction {
  std::string name;  ///< of an input, or of the node that gives it
  Side range;
};

/// The names that restrictions can use.
std::vector<std::string> sides_of(const Tape& tape);

/// Proves the tape for all inputs for which the restrictions hold.
Proof prove(const Tape& tape, const Effort& effort = {}, const std::vector<Restriction>& where = {});

}  // namespace isoshade::prove
