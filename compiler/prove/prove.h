// SPDX-License-Identifier: Apache-2.0
// Proves that a tape gives finite numbers for all its inputs, and bounds its error, by branch and bound: boxes of
// inputs about which nothing is proved are cut, each along the side that helps most.
#pragma once

#include <string>
#include <vector>

#include "compiler/prove/sample.h"

namespace isoshade::prove {

/// How much work a proof may be, in operations walked or run: so it ends alike on every machine.
struct Effort {
  uint64_t proof = 12'000'000;  ///< of one operation; of all together twice that
  uint64_t later = 500'000;     ///< of one operation that reads what another one gives that is not proved
  uint64_t error = 4'000'000;
  uint64_t samples = 30'000'000;
  int tries = 1500;  ///< inputs tried for a counterexample, in a box that was not proved
};

struct Unproved {
  uint32_t operation = none;
  Breach breach = Breach::none;
  std::vector<uint32_t> counterexample;  ///< words of the inputs; empty: none was found
  size_t open_boxes = 0;                 ///< in which it is not proved; beyond a few they are not counted
  Box box;                               ///< one of them, as it was reached
};

/// Over all inputs, the whole result of one output component.
struct Proof {
  bool vacuous = false;            ///< no input lies within all ranges: then nothing else is told
  std::vector<Unproved> unproved;  ///< in the order of the tape; empty: all is proved
  /// Operations that read what an unproved one gives, and that are not decided either. Judged, as all others, for
  /// inputs where what they read is finite.
  std::vector<Unproved> later;
  bool unfinished = false;     ///< there may be more that is not proved; then `unproved` is not empty
  std::vector<Bound> outputs;  ///< of Tape::outputs; without meaning where not all is proved
  /// The same, but the errors are those against exact arithmetic that takes the same side of each select. They are
  /// smaller where rounding may tip a comparison.
  std::vector<Bound> followed;
  std::vector<uint32_t> tipped;  ///< selects whose condition rounding may tip
  /// By output: the operation where even the error of `followed` gets larger than any float, or none.
  std::vector<uint32_t> lost;
  uint64_t steps = 0;  ///< operations that were walked
};

/// A range that an input, a scalar product or a clamped number is restricted to.
struct Restriction {
  std::string name;  ///< of an input, or of the node that gives it
  Side range;
};

/// What restrictions can name.
std::vector<std::string> sides_of(const Tape& tape);

/// Over all inputs for which the restrictions hold.
Proof prove(const Tape& tape, const Effort& effort = {}, const std::vector<Restriction>& where = {});

}  // namespace isoshade::prove
