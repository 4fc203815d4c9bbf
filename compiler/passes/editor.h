// SPDX-License-Identifier: Apache-2.0
// Rewrites a function in place, in execution order; fold, decide and hide_foldables are built on it.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::passes {

class Editor {
 public:
  explicit Editor(ir::Function& function);

  /// Calls `visit` for every instruction of the body, operands already replaced. It must `keep` the
  /// instruction, or `replace` all its results that are in use; what it makes meanwhile comes before the next
  /// instruction.
  using Visit = std::function<void(ir::InstructionId)>;
  /// Called at the end of each block, its yields already replaced; what it makes still belongs to the block.
  using Leave = std::function<void(ir::BlockId)>;
  void run(Visit visit, Leave leave = {});

  void keep(ir::InstructionId instruction) { list_.push_back(instruction); }
  /// Visits the blocks of a kept instruction.
  void descend(ir::InstructionId instruction);
  /// Visits one of them; each must be visited, in order.
  void descend_into(ir::BlockId block) { visit_block(block); }
  /// Visits a block's instructions as if they stood here; its parameters must be replaced before.
  void inline_block(ir::BlockId block);
  /// Uses `with` from here on instead of `value`, whose name it takes over if it has none and is no
  /// parameter.
  void replace(ir::ValueId value, ir::ValueId with);
  ir::ValueId current(ir::ValueId value) const { return replaced_by_[value]; }

  /// What a value is the result of; null for a parameter. Its operands are current. Valid until the next
  /// change.
  const ir::Instruction* definition(ir::ValueId value) const {
    return defined_by_[value] == ir::none ? nullptr : &f_.instructions[defined_by_[value]];
  }
  /// The definition if it is of this op, else null.
  const ir::Instruction* definition(ir::ValueId value, ir::Opcode op) const {
    const ir::Instruction* made = definition(value);
    return made != nullptr && made->op == op ? made : nullptr;
  }
  ir::ValueId operand(const ir::Instruction& instruction, uint32_t index) const {
    return f_.operands[instruction.first_operand + index];
  }
  /// The bits of a value's component where they are known.
  std::optional<uint32_t> known(ir::ValueId value, uint32_t component) const;
  /// The bits of all components where they are known and alike.
  std::optional<uint32_t> known_splat(ir::ValueId value) const;

  ir::ValueId constant(ir::Type type, uint32_t bits);
  /// A constant scalar, or a vector of constants; floats are made canonical.
  ir::ValueId constant(ir::Type type, std::span<const uint32_t> words);
  /// A primitive op or a construct.
  ir::ValueId make(ir::Opcode op, std::initializer_list<ir::ValueId> operands);
  ir::ValueId make(ir::Opcode op, std::span<const ir::ValueId> operands);
  /// Makes a value at the head of the function, where all its blocks see it.
  template <class Make>
  ir::ValueId at_head(Make make) {
    const uint32_t origin = std::exchange(origin_, 0);
    list_.swap(head_);
    const ir::ValueId made = make();
    list_.swap(head_);
    origin_ = origin;
    return made;
  }
  ir::ValueId hidden_zero();
  /// A component of a value; looks through constructs, and a float's only component is itself.
  ir::ValueId component(ir::ValueId value, uint32_t index);

  ir::Function& function() { return f_; }

 private:
  void visit_block(ir::BlockId block);
  void visit_all(const std::vector<ir::InstructionId>& instructions);
  ir::ValueId append(ir::Opcode op, uint32_t imm, std::span<const ir::ValueId> operands, ir::Type type);

  ir::Function& f_;
  Visit visit_;
  Leave leave_;
  std::vector<ir::InstructionId> list_;        ///< the block being rebuilt
  std::vector<ir::InstructionId> head_;        ///< comes before the body
  std::vector<ir::ValueId> replaced_by_;       ///< by value
  std::vector<ir::InstructionId> defined_by_;  ///< by value
  uint32_t origin_ = 0;
};

}  // namespace isoshade::passes
