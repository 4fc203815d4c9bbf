// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/uniformity.h"

#include <algorithm>
#include <utility>

namespace isoshade::ir {

namespace {

class Uniformity {
 public:
  Uniformity(const Function& f, const std::vector<bool>& parameters) : f_(f), uniform_(f.values.size(), true) {
    if (f.is_declaration()) return;
    for (size_t i = 0; i < parameters.size(); ++i) uniform_[f.blocks[0].parameters[i]] = parameters[i];
    visit(0);
  }
  std::vector<bool> take() { return std::move(uniform_); }

 private:
  void visit(BlockId block) {
    for (InstructionId id : f_.blocks[block].instructions) {
      const Instruction& made = f_.instructions[id];
      if (block_count(made.op) == 0)
        visit_plain(made);
      else
        made.op == Opcode::branch ? visit_branch(made) : visit_loop(made);
    }
  }

  void visit_plain(const Instruction& made) {
    const bool uniform = std::ranges::all_of(f_.operands_of(made), [&](ValueId v) { return uniform_[v]; });
    for (uint32_t k = 0; k < made.result_count; ++k) uniform_[made.first_result + k] = uniform;
  }

  void visit_branch(const Instruction& made) {
    for (BlockId side : made.blocks) visit(side);
    const bool condition = uniform_[f_.operands_of(made)[0]];
    for (uint32_t k = 0; k < made.result_count; ++k)
      uniform_[made.first_result + k] = condition && uniform_[f_.blocks[made.blocks[0]].yields[k]] &&
                                        uniform_[f_.blocks[made.blocks[1]].yields[k]];
  }

  // Once more wherever a carried value turned out to vary; it is never uniform again, so that ends.
  void visit_loop(const Instruction& made) {
    const auto operands = f_.operands_of(made);
    const Block& body = f_.blocks[made.blocks[0]];
    for (uint32_t k = 0; k < made.result_count; ++k) merge(body.parameters[k + 1], operands[k + 1]);
    bool changed = true;
    while (std::exchange(changed, false)) {
      visit(made.blocks[0]);
      for (uint32_t k = 0; k < made.result_count; ++k)
        changed |= merge(body.parameters[k + 1], body.yields[k]);
    }
    for (uint32_t k = 0; k < made.result_count; ++k)
      uniform_[made.first_result + k] = uniform_[operands[0]] && uniform_[body.parameters[k + 1]];
  }

  // Makes `value` varying if `with` is; whether that is new.
  bool merge(ValueId value, ValueId with) {
    if (uniform_[with] || !uniform_[value]) return false;
    uniform_[value] = false;
    return true;
  }

  const Function& f_;
  std::vector<bool> uniform_;
};

}  // namespace

std::vector<bool> uniform_values(const Function& function) {
  std::vector<bool> parameters;
  for (const Parameter& parameter : function.parameters) parameters.push_back(parameter.uniform);
  return uniform_values(function, parameters);
}

std::vector<bool> uniform_values(const Function& function, const std::vector<bool>& parameters) {
  return Uniformity(function, parameters).take();
}

}  // namespace isoshade::ir
