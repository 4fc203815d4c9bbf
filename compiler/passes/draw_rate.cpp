// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/draw_rate.h"

#include <algorithm>

namespace isoshade::passes {

using namespace ir;

/// Walks a function once; the body of a loop twice where what it carries is not the same.
class RateWalk {
 public:
  RateWalk(Rates& rates, const Function& f, const std::vector<bool>& parameters) : rates_(rates), f_(f) {
    made_.same.assign(f.values.size(), false);
    made_.whole.assign(f.instructions.size(), false);
    made_.made_by.assign(f.values.size(), none);
    for (size_t i = 0; i < parameters.size(); ++i) made_.same[f.blocks[0].parameters[i]] = parameters[i];
    visit(0);
  }
  RatesOfFunction take() { return std::move(made_); }

 private:
  bool all_same(std::span<const ValueId> values) const {
    return std::ranges::all_of(values, [&](ValueId v) { return made_.same[v]; });
  }

  void visit(BlockId block) {
    for (const InstructionId id : f_.blocks[block].instructions) {
      const Instruction& made = f_.instructions[id];
      bool same = false;
      if (made.op == Opcode::branch)
        same = made_.whole[id] = visit_branch(made);
      else if (made.op == Opcode::loop)
        same = made_.whole[id] = visit_loop(made);
      else
        same = all_same(f_.operands_of(made)) && is_function_of_operands(made);
      for (uint32_t k = 0; k < made.result_count; ++k) {
        made_.same[made.first_result + k] = same;
        made_.made_by[made.first_result + k] = id;
      }
    }
  }

  bool is_function_of_operands(const Instruction& made) {
    if (made.op == Opcode::load) return rates_.is_same_load(f_, made_.made_by, made);
    return made.op != Opcode::call || rates_.depends_on_arguments(made.imm);
  }

  bool visit_branch(const Instruction& made) {
    for (const BlockId side : made.blocks) visit(side);
    return all_same(f_.operands_of(made)) && all_same(f_.blocks[made.blocks[0]].yields) &&
           all_same(f_.blocks[made.blocks[1]].yields);
  }

  bool visit_loop(const Instruction& made) {
    const Block& body = f_.blocks[made.blocks[0]];
    const auto set = [&](bool same) {
      for (const ValueId parameter : body.parameters) made_.same[parameter] = same;
      visit(made.blocks[0]);
    };
    if (all_same(f_.operands_of(made))) {
      set(true);
      if (all_same(body.yields)) return true;
    }
    set(false);
    return false;
  }

  Rates& rates_;
  const Function& f_;
  RatesOfFunction made_;
};

const RatesOfFunction& Rates::of(uint32_t function, const std::vector<bool>& parameters) {
  const auto key = std::pair(function, parameters);
  if (const auto found = known_.find(key); found != known_.end()) return found->second;
  RatesOfFunction made = RateWalk(*this, module_.functions[function], parameters).take();
  return known_.emplace(key, std::move(made)).first->second;
}

bool Rates::is_late(const Function& f, const std::vector<InstructionId>& made_by, InstructionId address) const {
  if (address == none || f.instructions[address].op != Opcode::iadd) return false;
  return std::ranges::any_of(f.operands_of(f.instructions[address]), [&](ValueId value) {
    const bool is_constant = made_by[value] != none && f.instructions[made_by[value]].op == Opcode::constant;
    return is_constant && std::ranges::count(rate_.late_words, f.instructions[made_by[value]].imm) != 0;
  });
}

bool Rates::is_same_load(const Function& f, const std::vector<InstructionId>& made_by, const Instruction& load) const {
  const InstructionId index = made_by[f.operands_of(load)[0]];
  if (std::ranges::count(rate_.buffers, load.imm) != 0) return load.imm != rate_.floats || !is_late(f, made_by, index);
  if (!rate_.records || rate_.records->buffer != load.imm || index == none) return false;
  const Instruction& word = f.instructions[index];
  return word.op == Opcode::constant && std::ranges::count(rate_.records->words, word.imm % rate_.records->stride) != 0;
}

bool Rates::depends_on_arguments(uint32_t function) {
  const auto found = depends_.find(function);
  if (found != depends_.end()) return found->second;
  const Function& f = module_.functions[function];
  const bool depends = !f.is_declaration() && std::ranges::all_of(f.blocks, [&](const Block& block) {
    return std::ranges::all_of(block.instructions, [&](InstructionId id) {
      const Instruction& made = f.instructions[id];
      if (made.op == Opcode::load) return std::ranges::count(rate_.buffers, made.imm) != 0;
      return made.op != Opcode::call || depends_on_arguments(made.imm);
    });
  });
  depends_[function] = depends;
  return depends;
}

}  // namespace isoshade::passes
