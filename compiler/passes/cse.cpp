// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/passes.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "compiler/ir/laws.h"

namespace isoshade::passes {

namespace {

using namespace ir;

// Its buffers are reused for the next function: most functions are small.
class Merger {
 public:
  void run(Function& f) {
    f_ = &f;
    same_as_.resize(f.values.size());
    std::iota(same_as_.begin(), same_as_.end(), 0);
    next_.assign(f.instructions.size(), none);
    heads_.assign(std::bit_ceil(f.instructions.size() + 1), none);
    block(0);
  }

 private:
  void block(BlockId id) {
    const size_t outer = scope_.size();
    std::erase_if(f_->blocks[id].instructions,
                  [this](InstructionId instruction) { return replaced(instruction); });
    for (ValueId& yield : f_->blocks[id].yields) yield = same_as_[yield];
    // Values of this block are not visible outside it. Chains lose their newest element first.
    for (; scope_.size() > outer; scope_.pop_back()) heads_[bucket(scope_.back())] = next_[scope_.back()];
  }

  bool replaced(InstructionId id) {
    const Instruction& made = f_->instructions[id];
    for (ValueId& operand : f_->operands_of(made)) operand = same_as_[operand];
    if (made.blocks[0] != none) {
      for (BlockId inner : made.blocks)
        if (inner != none) block(inner);
      return false;
    }
    uint32_t& head = heads_[bucket(id)];
    for (InstructionId other = head; other != none; other = next_[other]) {
      if (!equal(made, f_->instructions[other])) continue;
      for (uint32_t k = 0; k < made.result_count; ++k)
        merge(made.first_result + k, f_->instructions[other].first_result + k);
      return true;
    }
    next_[id] = head;
    head = id;
    scope_.push_back(id);
    return false;
  }

  void merge(ValueId from, ValueId into) {
    same_as_[from] = into;
    if (f_->values[into].names == 0) f_->values[into].names = f_->values[from].names;
  }

  size_t bucket(InstructionId id) const {
    const Instruction& made = f_->instructions[id];
    const auto operands = f_->operands_of(made);
    const auto mix = [](uint64_t hash, uint64_t word) {
      return (std::rotl(hash, 23) ^ word) * 0x9e3779b97f4a7c15u;
    };
    uint64_t hash = mix(static_cast<uint64_t>(made.op), made.imm);
    if (commutes(made.op)) {
      hash = mix(mix(hash, std::min(operands[0], operands[1])), std::max(operands[0], operands[1]));
    } else {
      for (ValueId operand : operands) hash = mix(hash, operand);
    }
    return (hash >> 32) & (heads_.size() - 1);
  }

  bool equal(const Instruction& a, const Instruction& b) const {
    if (a.op != b.op || a.imm != b.imm) return false;
    if (a.op == Opcode::constant) return f_->type(a.first_result) == f_->type(b.first_result);
    const auto x = f_->operands_of(a), y = f_->operands_of(b);
    if (std::equal(x.begin(), x.end(), y.begin(), y.end())) return true;
    return commutes(a.op) && x[0] == y[1] && x[1] == y[0];
  }

  Function* f_ = nullptr;
  std::vector<ValueId> same_as_;      ///< by value
  std::vector<InstructionId> heads_;  ///< by hash: the newest visible instruction, then along next_
  std::vector<InstructionId> next_;   ///< by instruction
  std::vector<InstructionId> scope_;  ///< what is visible, in the order it became so
};

}  // namespace

void cse(ir::Module& module) {
  Merger merger;
  for (Function& function : module.functions)
    if (!function.is_declaration()) merger.run(function);
}

}  // namespace isoshade::passes
