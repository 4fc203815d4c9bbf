// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/light_sums.h"

#include <set>
#include <vector>

namespace isoshade::lower {

using check::Node;
using check::Operand;

bool sums_colors(const check::TypedGraph& graph, uint32_t sum) {
  std::vector<bool> found(graph.nodes.size());
  std::vector<uint32_t> open{sum};
  while (!open.empty()) {
    const Node& node = graph.nodes[open.back()];
    open.pop_back();
    const auto* const light = node.row == nullptr ? nullptr : std::get_if<nodes::Light>(&node.row->lowering);
    if (light != nullptr && *light == nodes::Light::color) return true;
    for (const Operand& operand : graph.operands_of(node)) {
      if (operand.from != Operand::From::node || found[operand.index]) continue;
      // The others are not computed for each light.
      if (!graph.nodes[operand.index].per_iteration) continue;
      found[operand.index] = true;
      open.push_back(operand.index);
    }
  }
  return false;
}

std::optional<LightSum> sum_of_black_lights(const check::TypedGraph& graph) {
  std::set<const check::TypedGraph*> found{&graph};
  std::vector<const check::TypedGraph*> open{&graph};
  while (!open.empty()) {
    const check::TypedGraph& next = *open.back();
    open.pop_back();
    for (uint32_t i = 0; i < next.nodes.size(); ++i) {
      const Node& node = next.nodes[i];
      if (node.row == nullptr) {
        if (found.insert(node.callee.get()).second) open.push_back(node.callee.get());
      } else if (node.row->is<nodes::SumLights>() && !sums_colors(next, i)) {
        return LightSum{&next, i};
      }
    }
  }
  return std::nullopt;
}

}  // namespace isoshade::lower
