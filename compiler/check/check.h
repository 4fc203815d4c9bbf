// SPDX-License-Identifier: Apache-2.0
// Graph -> TypedGraph.
#pragma once

#include <memory>

#include "compiler/check/library.h"
#include "compiler/check/typed_graph.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::check {

/// Function documents nested deeper than this are refused.
inline constexpr int max_document_depth = 64;
/// So are graphs that would have more nodes than this with all calls and sums over lights expanded: a few
/// small documents that call each other twice could otherwise stand for any number.
inline constexpr uint64_t max_expanded_nodes = 4'000'000;
/// And graphs that pass more numbers than this to and from functions.
inline constexpr uint64_t max_passed_numbers = 2'000'000;

/// Resolves links, infers types, fills in defaults, and loads the functions that the graph uses. Reports
/// unknown names, wrong types, cycles and misplaced nodes, and warns of unused ones; returns null if anything
/// was an error. Time and memory are linear in the nodes, and the stack does not grow with them.
std::shared_ptr<const TypedGraph> check(graph::Graph graph, Library& library,
                                        support::Diagnostics& diagnostics);

}  // namespace isoshade::check
