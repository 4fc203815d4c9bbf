// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/uniformity.h"

#include <numeric>
#include <span>

namespace isoshade::ir {

namespace {

// `to` varies if `from` does.
struct Edge {
  ValueId from, to;
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

// By value: what varies with it.
class Dependents {
 public:
  explicit Dependents(const Function& f) : begin_(f.values.size() + 1) {
    std::vector<Edge> edges;
    edges.reserve(f.operands.size() + f.values.size());
    collect_edges(f, 0, edges);
    for (const Edge& edge : edges) ++begin_[edge.from];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    list_.resize(edges.size());
    for (const Edge& edge : edges) list_[--begin_[edge.from]] = edge.to;  // from ends to begins
  }
  std::span<const ValueId> of(ValueId value) const {
    return std::span(list_).subspan(begin_[value], begin_[value + 1] - begin_[value]);
  }

 private:
  std::vector<uint32_t> begin_;
  std::vector<ValueId> list_;
};

}  // namespace

std::vector<bool> uniform_values(const Function& function) {
  std::vector<bool> uniform(function.values.size(), true);
  if (function.is_declaration()) return uniform;
  const Dependents dependents(function);
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
    for (ValueId dependent : dependents.of(value)) vary(dependent);
  }
  return uniform;
}

}  // namespace isoshade::ir
