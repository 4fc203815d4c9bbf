// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/call_graph.h"

namespace isoshade::ir {

namespace {

void collect_callees(const Function& function, BlockId block, std::vector<uint32_t>& out) {
  for (InstructionId id : function.blocks[block].instructions) {
    const Instruction& instruction = function.instructions[id];
    if (instruction.op == Opcode::call) out.push_back(instruction.imm);
    for (BlockId inner : instruction.blocks)
      if (inner != none) collect_callees(function, inner, out);
  }
}

// One function on the path from an entry; the path is a vector because call chains may be long.
struct Visit {
  uint32_t function;
  std::vector<uint32_t> callees;
  size_t next = 0;
};

}  // namespace

std::optional<std::vector<uint32_t>> callees_first(const Module& module, std::span<const uint32_t> entries) {
  enum class State : uint8_t { unseen, open, done };
  std::vector<State> states(module.functions.size(), State::unseen);
  std::vector<uint32_t> order;
  std::vector<Visit> path;
  const auto open = [&](uint32_t function) {
    states[function] = State::open;
    path.push_back({function, {}});
    if (!module.functions[function].is_declaration())
      collect_callees(module.functions[function], 0, path.back().callees);
  };
  for (uint32_t entry : entries) {
    if (states[entry] == State::unseen) open(entry);
    while (!path.empty()) {
      Visit& visit = path.back();
      if (visit.next == visit.callees.size()) {
        states[visit.function] = State::done;
        order.push_back(visit.function);
        path.pop_back();
        continue;
      }
      const uint32_t callee = visit.callees[visit.next++];
      if (states[callee] == State::open) return std::nullopt;
      if (states[callee] == State::unseen) open(callee);
    }
  }
  return order;
}

}  // namespace isoshade::ir
