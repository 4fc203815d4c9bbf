// SPDX-License-Identifier: Apache-2.0
// The cost and error of a node, determined from its compiled program.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compiler/functions/tier.h"
#include "compiler/nodes/example.h"

namespace isoshade::driver {

struct NodeCost {
  int64_t operations = 0;          ///< scalar operations after all passes, including called functions
  int own_operations = 0;          ///< of the node itself, without called functions
  std::vector<std::string> calls;  ///< rows of functions.def
};

/// The row must be available in function documents.
NodeCost cost_of(const nodes::Example& example, functions::Tier tier);

/// "exact", "0 ULP", "1.75 ULP", or the errors of the functions that it calls.
std::string error_of(const NodeCost& cost, functions::Tier tier);

}  // namespace isoshade::driver
