// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/nesting.h"

#include <algorithm>
#include <optional>
#include <span>

namespace isoshade::emit {

namespace {

using namespace ir;

class Finder {
 public:
  explicit Finder(const Function& f) : f_(f), nesting_(f.values.size()), uses_(f.values.size()) {
    for (InstructionId id = 0; id < f_.instructions.size(); ++id) {
      const Instruction& made = f_.instructions[id];
      for (uint32_t k = 0; k < made.result_count; ++k) nesting_[made.first_result + k].made_by = id;
    }
  }

  std::vector<Nesting> find() {
    visit(0);
    return std::move(nesting_);
  }

 private:
  struct Uses {
    BlockId block = none;  ///< of the uses so far
    bool many = false;     ///< more than one, or in several blocks
    bool only_index = true;
  };

  void use(ValueId value, BlockId block, bool is_index = false) {
    Uses& uses = uses_[value];
    uses.many |= uses.block != none;
    uses.block = block;
    uses.only_index &= is_index;
  }

  /// `value` is written as part of what stands for it, so each use of that is one of `value`.
  void pass_on(const Uses& uses, ValueId value) {
    if (uses.block == none) return;
    use(value, uses.block);
    uses_[value].many |= uses.many;
  }

  bool is_constant(ValueId value) const {
    const InstructionId made_by = nesting_[value].made_by;
    return made_by != none && f_.instructions[made_by].op == Opcode::constant;
  }

  bool is_node(ValueId value) const { return f_.origins[f_.values[value].names].line != 0; }

  /// Whether it makes the function's only result: its return is the node's statement.
  bool is_returned(const Instruction& made) const {
    return made.result_count == 1 && f_.results.size() == 1 && f_.blocks[0].yields[0] == made.first_result;
  }

  Shape shape_of(const Instruction& made) const {
    const auto operands = f_.operands_of(made);
    const ValueId result = made.first_result;
    if (made.op == Opcode::constant || made.op == Opcode::hidden_zero) return Shape::literal;
    if (made.op == Opcode::extract) return Shape::component;
    if (made.op == Opcode::construct && are_words(operands)) return Shape::words;
    if (is_node(result)) return Shape::plain;
    const auto is_first = [&](ValueId value) { return value == operands[0]; };
    if (made.op == Opcode::construct && std::ranges::all_of(operands, is_first)) return Shape::splat;
    const Uses& uses = uses_[result];
    if (made.op == Opcode::iadd && uses.only_index && uses.block != none && is_constant(operands[1]))
      return Shape::offset;
    return Shape::plain;
  }

  bool are_words(std::span<const ValueId> components) const {
    std::optional<Index> first;
    uint32_t buffer = none;
    for (uint32_t i = 0; i < components.size(); ++i) {
      const InstructionId made_by = nesting_[components[i]].made_by;
      if (made_by == none || f_.instructions[made_by].op != Opcode::load || is_node(components[i]))
        return false;
      const Instruction& load = f_.instructions[made_by];
      Index index = split_index(f_, nesting_, f_.operands_of(load)[0]);
      index.constant -= i;
      if (first && (*first != index || buffer != load.imm)) return false;
      first = index;
      buffer = load.imm;
    }
    return true;
  }

  // Backwards: all uses of a value are met before the value is.
  void visit(BlockId id) {
    const Block& block = f_.blocks[id];
    for (const ValueId value : block.yields) use(value, id);
    for (auto at = block.instructions.rbegin(); at != block.instructions.rend(); ++at) {
      const Instruction& made = f_.instructions[*at];
      for (const BlockId inner : made.blocks)
        if (inner != none) visit(inner);
      const auto operands = f_.operands_of(made);
      const Shape shape = made.result_count == 1 ? shape_of(made) : Shape::plain;
      for (uint32_t k = 0; k < made.result_count; ++k) {
        Nesting& result = nesting_[made.first_result + k];
        const Uses& uses = uses_[made.first_result + k];
        result.shape = shape;
        result.is_used = uses.block != none || made.result_count > 1;
        const bool has_text = shape == Shape::plain || shape == Shape::words;
        result.has_statement = has_text && (uses.many || uses.block != id ||
                                            (is_node(made.first_result + k) && !is_returned(made)));
      }
      if (!nesting_[made.first_result].is_used && made.blocks[0] == none) continue;
      if (shape == Shape::splat || shape == Shape::offset) {
        pass_on(uses_[made.first_result], operands[0]);
      } else if (shape == Shape::words) {
        const Instruction& load = f_.instructions[nesting_[operands[0]].made_by];
        if (const ValueId base = split_index(f_, nesting_, f_.operands_of(load)[0]).base; base != none)
          use(base, id);
      } else if (shape == Shape::component) {
        uses_[operands[0]] = {id, true, false};
      } else {
        for (const ValueId value : operands) use(value, id, made.op == Opcode::load);
      }
    }
  }

  const Function& f_;
  std::vector<Nesting> nesting_;
  std::vector<Uses> uses_;
};

}  // namespace

Index split_index(const Function& function, const std::vector<Nesting>& nesting, ValueId index) {
  const auto constant = [&](ValueId value) -> const Instruction* {
    const InstructionId id = nesting[value].made_by;
    return id != none && function.instructions[id].op == Opcode::constant ? &function.instructions[id]
                                                                          : nullptr;
  };
  if (const Instruction* whole = constant(index)) return {none, whole->imm};
  if (const InstructionId id = nesting[index].made_by;
      id != none && function.instructions[id].op == Opcode::iadd) {
    const auto operands = function.operands_of(function.instructions[id]);
    if (const Instruction* added = constant(operands[1])) return {operands[0], added->imm};
  }
  return {index, 0};
}

std::vector<Nesting> find_nesting(const Function& function) { return Finder(function).find(); }

}  // namespace isoshade::emit
