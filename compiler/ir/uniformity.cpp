// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/uniformity.h"

#include <algorithm>

namespace isoshade::ir {

namespace {

// `to` varies if `from` does.
struct Edge {
  ValueId from, to;
  friend bool operator<(Edge a, Edge b) { return a.from < b.from; }
};

void collect_edges(const Function& f, BlockId block, std::vector<Edge>& edges) {
  for (InstructionId id : f.blocks[block].instructions) {
    const Instruction& instruction = f.instructions[id];
    const auto operands = f.operands_of(instruction);
    const ValueId first = instruction.first_result;
    for (uint32_t k = 0; k < instruction.result_count; ++k) {
      if (instruction.op == Opcode::loop) {
        const Block& body = f.blocks[instruction.blocks[0]];
        edges.push_back({operands[k + 1], body.parameters[k + 1]});
        edges.push_back({body.yields[k], body.parameters[k + 1]});
        edges.push_back({body.parameters[k + 1], first + k});
        edges.push_back({operands[0], first + k});
        continue;
      }
      for (ValueId operand : operands) edges.push_back({operand, first + k});
      if (instruction.op == Opcode::branch)
        for (BlockId side : instruction.blocks) edges.push_back({f.blocks[side].yields[k], first + k});
    }
    for (BlockId inner : instruction.blocks)
      if (inner != none) collect_edges(f, inner, edges);
  }
}

}  // namespace

std::vector<bool> uniform_values(const Function& function) {
  std::vector<bool> uniform(function.values.size(), true);
  if (function.is_declaration()) return uniform;
  std::vector<Edge> edges;
  collect_edges(function, 0, edges);
  std::sort(edges.begin(), edges.end());
  std::vector<ValueId> varying;
  const auto vary = [&](ValueId value) {
    if (!uniform[value]) return;
    uniform[value] = false;
    varying.push_back(value);
  };
  for (size_t i = 0; i < function.parameters.size(); ++i)
    if (!function.parameters[i].uniform) vary(function.blocks[0].parameters[i]);
  while (!varying.empty()) {
    const ValueId value = varying.back();
    varying.pop_back();
    const auto [first, last] = std::equal_range(edges.begin(), edges.end(), Edge{value, 0});
    for (auto edge = first; edge != last; ++edge) vary(edge->to);
  }
  return uniform;
}

}  // namespace isoshade::ir
