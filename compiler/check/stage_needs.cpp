// SPDX-License-Identifier: Apache-2.0
#include "compiler/check/stage_needs.h"

#include <algorithm>

#include "compiler/support/visible.h"

namespace isoshade::check {

using support::Id;
using support::quote;

namespace {

constexpr size_t index(StageNeed need) { return static_cast<size_t>(need); }

bool reads_surface(const Operand& operand) { return operand.from == Operand::From::surface; }

}  // namespace

std::array<bool, stage_need_count> needs_of(const TypedGraph& graph, const Node& node) {
  std::array<bool, stage_need_count> needs{};
  const auto need = [&](StageNeed what) -> bool& { return needs[index(what)]; };
  if (node.callee != nullptr)
    for (size_t i = 0; i < stage_need_count; ++i) needs[i] = node.callee->needed_by[i] != no_node;
  need(StageNeed::surface) |= std::ranges::any_of(graph.operands_of(node), reads_surface);
  if (node.row == nullptr) return needs;
  const nodes::Row& row = *node.row;
  if (const auto* attribute = std::get_if<nodes::Surface>(&row.lowering)) {
    switch (interface::row(*attribute).stages) {
      case interface::SurfaceStages::all: need(StageNeed::surface) = true; break;
      case interface::SurfaceStages::vertices: need(StageNeed::vertex) = true; break;
      case interface::SurfaceStages::pixels: need(StageNeed::pixel) = true; break;
    }
  }
  need(StageNeed::surface) |= row.is<nodes::Transform>();
  need(StageNeed::images) = row.is<nodes::Image>();
  need(StageNeed::lights) = row.is<nodes::Light>() || row.is<nodes::SumLights>();
  need(StageNeed::derivatives) = row.is<nodes::Derivative>() || may_be_trilinear(graph, node);
  need(StageNeed::environment) = row.is<nodes::Environment>();
  need(StageNeed::repetition) = row.is<nodes::Repetition>();
  need(StageNeed::time) = row.is<nodes::Time>();
  return needs;
}

void find_stage_needs(TypedGraph& graph) {
  std::vector<bool> reached(graph.nodes.size());
  const auto reach = [&](const Operand& operand) {
    if (operand.from == Operand::From::node) reached[operand.index] = true;
  };
  std::ranges::for_each(graph.outputs, reach);
  for (auto it = graph.order.rbegin(); it != graph.order.rend(); ++it)
    if (reached[*it]) std::ranges::for_each(graph.operands_of(graph.nodes[*it]), reach);
  for (uint32_t i = 0; i < graph.nodes.size(); ++i) {
    if (!reached[i]) continue;
    const auto needs = needs_of(graph, graph.nodes[i]);
    for (size_t need = 0; need < stage_need_count; ++need)
      if (needs[need] && graph.needed_by[need] == no_node) graph.needed_by[need] = i;
  }
}

PlacedNode cause_of(const TypedGraph& graph, uint32_t node, StageNeed need) {
  const TypedGraph* in = &graph;
  for (const TypedGraph* callee = in->nodes[node].callee.get(); callee != nullptr && callee->needs(need);
       callee = in->nodes[node].callee.get()) {
    in = callee;
    node = in->needed_by[index(need)];
  }
  return {*in, node};
}

std::string described(const PlacedNode& cause) {
  const Node& node = cause.get();
  const std::string label = quote(cause.source().label());
  const std::span<const Operand> operands = cause.graph.operands_of(node);
  const bool is_attribute = node.row != nullptr && node.row->is<nodes::Surface>();
  const auto fallback = std::ranges::find_if(operands, reads_surface);
  if (is_attribute || node.row == nullptr || fallback == operands.end()) return label;
  return label + " without " + quote(node.row->ports[static_cast<size_t>(fallback - operands.begin())].name);
}

void note_calls(support::Diagnostic& report, const TypedGraph& graph, uint32_t node, StageNeed need) {
  const TypedGraph* callee = graph.nodes[node].callee.get();
  while (callee != nullptr && callee->needs(need)) {
    const PlacedNode at{*callee, callee->needed_by[index(need)]};
    const std::string label = quote(at.source().label());
    report.note(callee->graph.span(at.source().type_place),
                at.get().callee != nullptr ? "which calls " + label + " here" : "which uses " + label + " here");
    callee = at.get().callee.get();
  }
}

bool stands_alone(const TypedGraph& function, support::Diagnostics& diagnostics) {
  const graph::Graph& graph = function.graph;
  const std::string refusal = quote(graph.name) + " cannot be evaluated by itself: ";
  for (const graph::Input& input : graph.inputs) {
    if (input.type != Type::filename) continue;
    diagnostics.report(Id::unsupported, graph.span(input.name_place), refusal + quote(input.name) + " is an image")
        .suggest("call it from an effect");
    return false;
  }
  const auto first = std::ranges::find_if(function.needed_by, [](uint32_t node) { return node != no_node; });
  if (first == function.needed_by.end()) return true;
  const auto need = static_cast<StageNeed>(first - function.needed_by.begin());
  support::Diagnostic& report =
      diagnostics.report(Id::unsupported, graph.span(graph.nodes[*first].type_place),
                         refusal + "it depends on " + described(cause_of(function, *first, need)));
  note_calls(report, function, *first, need);
  report.suggest("call it from an effect");
  return false;
}

}  // namespace isoshade::check
