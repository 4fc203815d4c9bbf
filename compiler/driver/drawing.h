// SPDX-License-Identifier: Apache-2.0
// A graph as a picture, in the language of Graphviz.
#pragma once

#include <string>

#include "compiler/check/typed_graph.h"

namespace isoshade::driver {

/// More boxes than this are no picture, and Graphviz takes minutes to lay them out.
inline constexpr size_t most_drawn_nodes = 2000;

/// The graph in DOT: nodes with their types, ports and literals, links with their swizzles and types, and
/// called function documents as clusters with their own nodes, up to `depth` inside each other. Text of the
/// document is escaped. Stops at most_drawn_nodes and says so in the picture.
std::string draw(const check::TypedGraph& graph, int depth);

}  // namespace isoshade::driver
