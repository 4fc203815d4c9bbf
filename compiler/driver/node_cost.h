// SPDX-License-Identifier: Apache-2.0
// What a node of the table costs and how exact it is, measured on what it compiles to.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compiler/functions/tier.h"
#include "compiler/nodes/example.h"

namespace isoshade::driver {

struct NodeCost {
  int64_t operations =
      0;  ///< on single floats, integers and booleans, of all functions it calls, after all passes
  int own_operations = 0;          ///< of the node itself, before it calls
  std::vector<std::string> calls;  ///< rows of functions.def
};

/// The row must not belong to effects.
NodeCost cost_of(const nodes::Example& example, functions::Tier tier);

/// "0 ULP", "1.75 ULP", or what it is made of.
std::string error_of(const NodeCost& cost, functions::Tier tier);

}  // namespace isoshade::driver
