// SPDX-License-Identifier: Apache-2.0
// Graph -> TypedGraph.
#pragma once

#include <memory>

#include "compiler/check/library.h"
#include "compiler/check/typed_graph.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::check {

/// Limits. The nesting depth of function documents.
inline constexpr int max_document_depth = 64;
/// The number of nodes with all calls and sums over lights expanded, which can grow exponentially: each of a
/// few small documents may call the next one twice.
inline constexpr uint64_t max_expanded_nodes = 4'000'000;
/// The number of scalars that the graph passes to and from functions.
inline constexpr uint64_t max_passed_numbers = 2'000'000;

/// Resolves links, infers types, fills in defaults, and loads the functions that the graph uses. Reports
/// unknown names, wrong types, cycles and misplaced nodes, and warns about unused nodes; returns null on any
/// error. Time and memory are linear in the number of nodes; the stack depth does not depend on it.
std::shared_ptr<const TypedGraph> check(graph::Graph graph, Library& library,
                                        support::Diagnostics& diagnostics);

}  // namespace isoshade::check
