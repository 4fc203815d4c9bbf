// SPDX-License-Identifier: Apache-2.0
// A graph as a picture, in the language of Graphviz.
#pragma once

#include <string>

#include "compiler/check/typed_graph.h"

namespace isoshade::driver {

/// More boxes than this are no picture.
inline constexpr size_t most_drawn_nodes = 2000;
/// Up to so many boxes Graphviz finds where they go. It takes more than 10 s for 500 that link to any before them (dot
/// 2.43, with straight lines or not), and hangs over 2,000; with more than this the text says where they are, and 2,000
/// take 0.5 s.
inline constexpr size_t most_laid_out_nodes = 200;

/// The graph in DOT: nodes with their types, ports and literals, links with their swizzles and types, and
/// called function documents as clusters with their own nodes, up to `depth` inside each other. Text of the
/// document is escaped. Stops at most_drawn_nodes and says so in the picture. A picture of more than
/// most_laid_out_nodes has its boxes in columns, each to the right of what it reads, and shows no frames.
std::string draw(const check::TypedGraph& graph, int depth);

}  // namespace isoshade::driver
