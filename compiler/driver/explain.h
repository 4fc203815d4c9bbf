// SPDX-License-Identifier: Apache-2.0
// What compiling for fixed values, or another skip, leaves of a document, node by node.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "compiler/driver/shader.h"

namespace isoshade::driver {

/// A node that the author wrote; an expression is one.
struct NodeFate {
  std::string id, type;
  uint64_t before = 0, after = 0;  ///< scalar operations, with those of called functions; one turn of a loop
  std::string value;               ///< of a node that became constant: "0.5", "[1, 0, 0]"; else empty
  uint64_t branched_before = 0, branched_after = 0;  ///< of these operations, those that one side of a choice has
};

struct Explanation {
  uint64_t before = 0, after = 0;  ///< of all functions of the document
  std::vector<NodeFate> nodes;     ///< in the order of the document

  /// The nodes that nothing computes any more, though they have operations otherwise.
  std::set<std::string> left_out() const;
};

/// Compares a document with what is left of it: both are the same document, and the second one is compiled for fixed values,
/// or with skips that the first one lacks.
Explanation explain(const Shader& general, const Shader& fixed);

/// The graph that is left, and what fell away, as lines of text.
std::string text(const Explanation& explanation, const Shader& fixed);

}  // namespace isoshade::driver
