// SPDX-License-Identifier: Apache-2.0
// Draws a graph as a diagram, in the DOT language of Graphviz.
#pragma once

#include <set>
#include <string>

#include "compiler/check/typed_graph.h"

namespace isoshade::driver {

/// The maximum number of boxes in a diagram.
inline constexpr size_t most_drawn_nodes = 2000;
/// Graphviz lays out diagrams of up to this many boxes. For 500 boxes with random links it takes more than 10 s (dot
/// 2.43, also with straight lines), and it hangs for 2,000. Larger diagrams contain positions (box_layers.h); 2,000
/// boxes then take 0.5 s.
inline constexpr size_t most_laid_out_nodes = 200;

/// The graph in DOT: nodes with their types, ports and literals, links with their swizzles and types, and called
/// function documents as clusters with their own nodes, nested up to `depth`. Text of the document is escaped. Stops at
/// most_drawn_nodes boxes and notes that in the diagram. A diagram of more than most_laid_out_nodes boxes arranges them
/// in columns, each to the right of the boxes that it reads, without cluster frames.
/// `left_out`: the ids of nodes of the document that are drawn grey.
std::string draw(const check::TypedGraph& graph, int depth, const std::set<std::string>& left_out = {});

}  // namespace isoshade::driver
