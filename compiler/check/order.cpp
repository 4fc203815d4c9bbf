// SPDX-License-Identifier: Apache-2.0
#include "compiler/check/work.h"

namespace isoshade::check {
namespace {

enum class State : uint8_t { unseen, open, done };

struct Visit {
  uint32_t node;
  uint32_t next_operand;
};

/// "a -> b -> a": the nodes that are open from `node` on, in the order in which they read each other. The operations
/// of an expression are one node to the reader.
std::string path_of(const Work& work, const std::vector<Visit>& open, uint32_t node) {
  size_t first = open.size();
  while (open[first - 1].node != node) --first;
  --first;
  std::vector<std::string_view> ids;
  for (size_t i = first; i < open.size(); ++i) {
    const std::string& id = work.graph().nodes[open[i].node].id;
    if (ids.empty() || ids.back() != id) ids.push_back(id);
  }
  const std::string& last = work.graph().nodes[node].id;
  if (ids.size() > 1 && ids.back() == last) ids.pop_back();
  const size_t length = ids.size();
  constexpr size_t shown = 8;
  std::string path;
  for (size_t i = 0; i < length; ++i) {
    if (length > shown && i == shown / 2) {
      path += "... " + std::to_string(length - shown) + " more ... -> ";
      i = length - shown / 2;
    }
    path += std::string(ids[i]) + " -> ";
  }
  return path + last;
}

}  // namespace

void order(Work& work) {
  TypedGraph& typed = work.typed;
  std::vector<State> states(typed.nodes.size(), State::unseen);
  std::vector<Visit> open;
  typed.order.reserve(typed.nodes.size());
  for (uint32_t root = 0; root < typed.nodes.size(); ++root) {
    if (states[root] != State::unseen) continue;
    states[root] = State::open;
    open.push_back({root, 0});
    while (!open.empty()) {
      Visit& visit = open.back();
      const Node& node = typed.nodes[visit.node];
      if (visit.next_operand == node.operand_count) {
        states[visit.node] = State::done;
        typed.order.push_back(visit.node);
        open.pop_back();
        continue;
      }
      const uint32_t at = node.first_operand + visit.next_operand++;
      Operand& operand = typed.operands[at];
      if (operand.from != Operand::From::node || states[operand.index] == State::done) continue;
      if (states[operand.index] == State::unseen) {
        states[operand.index] = State::open;
        open.push_back({operand.index, 0});
        continue;
      }
      work.report(support::Id::cycle, work.given[at].link->place,
                  "nodes read each other in a circle: " + path_of(work, open, operand.index));
      work.broken[visit.node] = true;
      operand.from = Operand::From::nothing;
    }
  }
}

}  // namespace isoshade::check
