// SPDX-License-Identifier: Apache-2.0
// What documents need of the stage that evaluates them (StageNeed). A function passes on what the functions that it calls
// need, so an effect or a post knows it of each call without looking into the function.
#pragma once

#include <array>
#include <string>

#include "compiler/check/typed_graph.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::check {

/// By StageNeed: whether the node needs it.
std::array<bool, stage_need_count> needs_of(const TypedGraph& graph, const Node& node);

/// Sets TypedGraph::needed_by. The nodes have types, and those of callees are known.
void find_stage_needs(TypedGraph& graph);

/// A node of some document.
struct PlacedNode {
  const TypedGraph& graph;
  uint32_t node;

  const Node& get() const { return graph.nodes[node]; }
  const graph::Node& source() const { return graph.graph.nodes[node]; }
};
/// The node that is not a call and makes `node` need something: itself, or one of the function that it calls.
PlacedNode cause_of(const TypedGraph& graph, uint32_t node, StageNeed need);
/// As messages name it: `"normal"`, `"image" without "texcoord"`.
std::string described(const PlacedNode& cause);
/// Adds a note for each document between a call and the cause of its need.
void note_calls(support::Diagnostic& report, const TypedGraph& graph, uint32_t node, StageNeed need);

/// Whether a function document can be evaluated from the values of its inputs alone; reports what else it needs.
bool stands_alone(const TypedGraph& function, support::Diagnostics& diagnostics);

}  // namespace isoshade::check
