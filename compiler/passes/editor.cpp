// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/editor.h"

#include <array>
#include <numeric>
#include <utility>

#include "compiler/ir/builder.h"
#include "compiler/ir/float_bits.h"
#include "compiler/support/assert.h"

namespace isoshade::passes {

using namespace ir;

Editor::Editor(Function& function)
    : f_(function), replaced_by_(function.values.size()), defined_by_(function.values.size(), none) {
  std::iota(replaced_by_.begin(), replaced_by_.end(), 0);
  for (InstructionId id = 0; id < f_.instructions.size(); ++id)
    for (uint32_t k = 0; k < f_.instructions[id].result_count; ++k)
      defined_by_[f_.instructions[id].first_result + k] = id;
}

void Editor::run(Visit visit, Leave leave) {
  visit_ = std::move(visit);
  leave_ = std::move(leave);
  visit_block(0);
  std::vector<InstructionId>& body = f_.blocks[0].instructions;
  body.insert(body.begin(), head_.begin(), head_.end());
}

void Editor::visit_block(BlockId block) {
  std::vector<InstructionId> outer = std::exchange(list_, {});
  list_.reserve(f_.blocks[block].instructions.size());
  visit_all(std::exchange(f_.blocks[block].instructions, {}));
  for (ValueId& yield : f_.blocks[block].yields) yield = current(yield);
  if (leave_) leave_(block);
  f_.blocks[block].instructions = std::exchange(list_, std::move(outer));
}

void Editor::visit_all(const std::vector<InstructionId>& instructions) {
  for (InstructionId id : instructions) {
    const Instruction& made = f_.instructions[id];
    for (ValueId& operand : f_.operands_of(made)) operand = current(operand);
    origin_ = made.origin;
    visit_(id);
  }
}

void Editor::descend(InstructionId instruction) {
  const std::array blocks = f_.instructions[instruction].blocks;
  for (BlockId block : blocks)
    if (block != none) visit_block(block);
}

void Editor::inline_block(BlockId block) {
  visit_all(std::exchange(f_.blocks[block].instructions, {}));
  for (ValueId& yield : f_.blocks[block].yields) yield = current(yield);
}

void Editor::replace(ValueId value, ValueId with) {
  replaced_by_[value] = with;
  const bool both_results = defined_by_[value] != none && defined_by_[with] != none;
  if (both_results && f_.values[with].names == 0) f_.values[with].names = f_.values[value].names;
}

std::optional<uint32_t> Editor::known(ValueId value, uint32_t component) const {
  if (const Instruction* made = definition(value, Opcode::construct)) {
    value = operand(*made, component);
    component = 0;
  }
  if (const Instruction* made = definition(value, Opcode::constant)) return made->imm;
  return std::nullopt;
}

std::optional<uint32_t> Editor::known_splat(ValueId value) const {
  const auto first = known(value, 0);
  for (uint32_t c = 1; c < f_.type(value).width; ++c)
    if (known(value, c) != first) return std::nullopt;
  return first;
}

ValueId Editor::append(Opcode op, uint32_t imm, std::span<const ValueId> operands, Type type) {
  Instruction made;
  made.op = op;
  made.imm = imm;
  made.first_operand = static_cast<uint32_t>(f_.operands.size());
  made.operand_count = static_cast<uint32_t>(operands.size());
  made.first_result = static_cast<ValueId>(f_.values.size());
  made.origin = origin_;
  f_.operands.insert(f_.operands.end(), operands.begin(), operands.end());
  f_.values.push_back({type, 0});
  list_.push_back(static_cast<InstructionId>(f_.instructions.size()));
  defined_by_.push_back(list_.back());
  replaced_by_.push_back(made.first_result);
  f_.instructions.push_back(made);
  return made.first_result;
}

ValueId Editor::constant(Type type, uint32_t bits) {
  return append(Opcode::constant, type.is_float() ? canonical_float(bits) : bits, {}, type);
}

ValueId Editor::constant(Type type, std::span<const uint32_t> words) {
  if (words.size() == 1) return constant(type, words[0]);
  std::array<ValueId, 4> components;
  for (size_t i = 0; i < words.size(); ++i) components[i] = constant(float_type, words[i]);
  return make(Opcode::construct, std::span(components).first(words.size()));
}

ValueId Editor::make(Opcode op, std::initializer_list<ValueId> operands) {
  return make(op, std::span(operands));
}

ValueId Editor::make(Opcode op, std::span<const ValueId> operands) {
  if (op == Opcode::construct) return append(op, 0, operands, vector_type(static_cast<int>(operands.size())));
  std::array<Type, 3> types;
  for (size_t i = 0; i < operands.size(); ++i) types[i] = f_.type(operands[i]);
  const auto type = result_type(op, std::span(types).first(operands.size()));
  support::assert_that(type.has_value(), "a pass made operands that do not fit");
  return append(op, 0, operands, *type);
}

ValueId Editor::hidden_zero() { return append(Opcode::hidden_zero, 0, {}, float_type); }

ValueId Editor::component(ValueId value, uint32_t index) {
  if (f_.type(value).width == 1) return value;
  if (const Instruction* made = definition(value, Opcode::construct)) return operand(*made, index);
  const std::array operands{value};
  return append(Opcode::extract, index, operands, float_type);
}

}  // namespace isoshade::passes
