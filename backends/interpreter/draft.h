// SPDX-License-Identifier: Apache-2.0
// A kernel as a list of steps on scalar components, before values have registers: calls are inlined, vectors are their
// components, and constructing and taking apart vectors costs nothing.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "backends/interpreter/steps.h"
#include "compiler/ir/module.h"

namespace isoshade::interpreter {

/// A step. Targets are numbers of steps.
struct DraftStep {
  Shape shape;
  Place to, a, b, c;
  uint32_t buffer = 0;   ///< load
  uint32_t target = 0;   ///< jumps: the step to go to; split: the first one of the other side
  uint32_t end = 0;      ///< split: the step after both sides
  uint32_t block = 0;    ///< steps of one block run one after another, for the same groups
  uint32_t loop = ir::none;  ///< the innermost loop that it belongs to
  bool dead = false;
};

/// A range of steps that may run several times: [begin, end).
struct DraftLoop {
  uint32_t begin, end;
  uint32_t around;  ///< the loop that it belongs to, or none
};

/// A value has one place of its own, which only the carried values of loops and the results of branches are written to
/// more than once.
struct Draft {
  std::vector<DraftStep> steps;
  std::vector<DraftLoop> loops;
  std::vector<uint32_t> scalars;  ///< by number: the constants; of others 0
  uint32_t words = 0, masks = 0;  ///< how many places there are
  std::vector<Place> parameters;  ///< one for each word
  std::vector<Place> results;     ///< one for each word that is asked for: integers, as they are stored
};

/// Inlines all calls from the function on.
Draft decode(const ir::Module& module, uint32_t function, size_t results);

/// Removes steps whose results nothing reads, lets steps write at once where their result would be copied to, and fuses
/// pairs of steps.
void simplify(Draft& draft);

/// Numbers the registers: values share one if their lifetimes do not overlap. Places of values that nothing reads become
/// Pool::none.
void assign_registers(Draft& draft);

}  // namespace isoshade::interpreter
