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
  size_t first, next;  ///< of its callees: all that the path has, and the next to be visited
};

}  // namespace

std::optional<std::vector<uint32_t>> callees_first(const Module& module, std::span<const uint32_t> entries) {
  enum class State : uint8_t { unseen, open, done };
  std::vector<State> states(module.functions.size(), State::unseen);
  std::vector<uint32_t> order;
  order.reserve(module.functions.size());
  std::vector<Visit> path;
  std::vector<uint32_t> callees;  // of all functions on the path, one after another
  const auto open = [&](uint32_t function) {
    states[function] = State::open;
    path.push_back({function, callees.size(), callees.size()});
    if (!module.functions[function].is_declaration()) collect_callees(module.functions[function], 0, callees);
  };
  for (uint32_t entry : entries) {
    if (states[entry] == State::unseen) open(entry);
    while (!path.empty()) {
      Visit& visit = path.back();
      if (visit.next == callees.size()) {
        states[visit.function] = State::done;
        callees.resize(visit.first);
        order.push_back(visit.function);
        path.pop_back();
        continue;
      }
      const uint32_t callee = callees[visit.next++];
      if (states[callee] == State::open) return std::nullopt;
      if (states[callee] == State::unseen) open(callee);
    }
  }
  return order;
}

}  // namespace isoshade::ir
