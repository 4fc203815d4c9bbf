// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/hoist_slice.h"

#include <iterator>
#include <utility>

#include "compiler/support/assert.h"

namespace isoshade::passes {

using namespace ir;

/// Which parameters the results of a function depend on.
std::vector<bool> parameters_needed(const Function& f) {
  std::vector<InstructionId> made_by(f.values.size(), none);
  for (InstructionId id = 0; id < f.instructions.size(); ++id)
    for (uint32_t k = 0; k < f.instructions[id].result_count; ++k) made_by[f.instructions[id].first_result + k] = id;
  std::vector<bool> read(f.values.size());
  std::vector<ValueId> waiting(f.blocks[0].yields);
  while (!waiting.empty()) {
    const ValueId value = waiting.back();
    waiting.pop_back();
    if (read[value]) continue;
    read[value] = true;
    if (made_by[value] == none) continue;
    const Instruction& made = f.instructions[made_by[value]];
    const auto operands = f.operands_of(made);
    waiting.insert(waiting.end(), operands.begin(), operands.end());
    for (const BlockId block : made.blocks)
      if (block != none) waiting.insert(waiting.end(), f.blocks[block].yields.begin(), f.blocks[block].yields.end());
  }
  std::vector<bool> parameters;
  for (const ValueId parameter : f.blocks[0].parameters) parameters.push_back(read[parameter]);
  return parameters;
}

namespace {

/// Walks a function in its order: what a value is made of comes before it.
class FreeWalk {
 public:
  FreeWalk(const Function& f, const RatesOfFunction& rates, bool is_kernel)
      : f_(f), rates_(rates), is_kernel_(is_kernel), free_(f.values.size()), constant_(f.values.size()) {
    visit(0);
  }
  std::vector<bool> take() { return std::move(free_); }

 private:
  bool all(const std::vector<bool>& marks, const Instruction& made) const {
    return std::ranges::all_of(f_.operands_of(made), [&](ValueId value) { return marks[value]; });
  }

  void visit(BlockId block) {
    for (const ValueId parameter : f_.blocks[block].parameters) free_[parameter] = true;
    for (const InstructionId id : f_.blocks[block].instructions) {
      const Instruction& made = f_.instructions[id];
      for (const BlockId inner : made.blocks)
        if (inner != none) visit(inner);
      // hide_foldables keeps drivers from folding what is computed from constants.
      const bool is_plain = made.op != Opcode::call && made.op != Opcode::load && made.blocks[0] == none;
      const bool is_constant = is_plain && all(constant_, made);
      const bool is_free = is_constant || (may_be_free(made) && all(free_, made));
      for (uint32_t k = 0; k < made.result_count; ++k) {
        constant_[made.first_result + k] = is_constant;
        free_[made.first_result + k] = is_free;
      }
    }
  }

  bool may_be_free(const Instruction& made) const {
    switch (made.op) {
      case Opcode::construct:
      case Opcode::extract: return true;
      case Opcode::load:
      case Opcode::fne:
      case Opcode::ine: return is_kernel_;  // a boolean of a record
      case Opcode::iadd: return is_kernel_ && is_address(made);
      default: return false;
    }
  }
  /// The record and a constant.
  bool is_address(const Instruction& made) const {
    const auto operands = f_.operands_of(made);
    const InstructionId second = rates_.made_by[operands[1]];
    return rates_.made_by[operands[0]] == none && second != none && f_.instructions[second].op == Opcode::constant;
  }

  const Function& f_;
  const RatesOfFunction& rates_;
  bool is_kernel_;
  std::vector<bool> free_, constant_;
};

}  // namespace

std::vector<bool> free_values(const Function& f, const RatesOfFunction& rates, bool is_kernel) {
  return FreeWalk(f, rates, is_kernel).take();
}

ValueId Copier::new_value(ValueId of) {
  to_.values.push_back({from_.type(of), 0});
  return values[of] = static_cast<ValueId>(to_.values.size() - 1);
}

InstructionId Copier::copy(InstructionId id) {
  Instruction made = from_.instructions[id];
  std::vector<ValueId> operands;
  for (const ValueId operand : from_.operands_of(made)) operands.push_back(values.at(operand));
  for (BlockId& block : made.blocks)
    if (block != none) block = copy_block(block);
  made.first_operand = static_cast<uint32_t>(to_.operands.size());
  to_.operands.insert(to_.operands.end(), operands.begin(), operands.end());
  made.origin = 0;
  const ValueId first = made.first_result;
  made.first_result = static_cast<ValueId>(to_.values.size());
  for (uint32_t k = 0; k < made.result_count; ++k) new_value(first + k);
  to_.instructions.push_back(made);
  return static_cast<InstructionId>(to_.instructions.size() - 1);
}

BlockId Copier::copy_block(BlockId id) {
  Block copied;
  for (const ValueId parameter : from_.blocks[id].parameters) copied.parameters.push_back(new_value(parameter));
  for (const InstructionId inner : from_.blocks[id].instructions) copied.instructions.push_back(copy(inner));
  for (const ValueId value : from_.blocks[id].yields) copied.yields.push_back(values.at(value));
  to_.blocks.push_back(std::move(copied));
  return static_cast<BlockId>(to_.blocks.size() - 1);
}

Slice::Slice(const Function& from, const RatesOfFunction& rates, const std::map<InstructionId, const Split*>& splits,
             const Module& module, Function& to)
    : from_(from), rates_(rates), splits_(splits), module_(module), to_(to), copier_(from, to) {
  to_.blocks.emplace_back();
}

ValueId Slice::copy(ValueId wanted) {
  // Graphs may be chains of 100,000 nodes: no recursion.
  std::vector<ValueId> waiting{wanted};
  while (!waiting.empty()) {
    const ValueId value = waiting.back();
    const auto is_missing = [&](ValueId read) { return !copier_.values.contains(read); };
    if (is_missing(value)) {
      const InstructionId id = rates_.made_by[value];
      if (id == none) {
        add_parameter(value);
      } else {
        const std::vector<ValueId> read = read_from_outside(id);
        const size_t before = waiting.size();
        std::ranges::copy_if(read, std::back_inserter(waiting), is_missing);
        if (waiting.size() != before) continue;
        const InstructionId copied = copier_.copy(id);  // may add blocks
        to_.blocks[0].instructions.push_back(copied);
      }
    }
    waiting.pop_back();
  }
  return copier_.values.at(wanted);
}

ValueId Slice::copy_result(const Item& item) {
  // Calls of calls can make a function as long as a power of two.
  constexpr size_t longest = 20'000;
  const auto found = results_.find(item.call);
  if (found != results_.end()) return found->second[item.of_call];
  const Split& split = *splits_.at(item.call);
  std::vector<ValueId> arguments;
  for (const size_t parameter : split.needs)
    arguments.push_back(copy(from_.operands_of(from_.instructions[item.call])[parameter]));
  const Function& body = module_.functions[split.draw];
  const bool is_short = to_.instructions.size() + body.instructions.size() <= longest;
  const auto results = is_short ? inline_body(body, arguments) : call(split, arguments);
  return results_.emplace(item.call, results).first->second[item.of_call];
}

std::vector<ValueId> Slice::inline_body(const Function& body, std::span<const ValueId> arguments) {
  Copier copier(body, to_);
  for (size_t i = 0; i < arguments.size(); ++i) copier.values[body.blocks[0].parameters[i]] = arguments[i];
  for (const InstructionId id : body.blocks[0].instructions) {
    const InstructionId copied = copier.copy(id);  // may add blocks
    to_.blocks[0].instructions.push_back(copied);
  }
  std::vector<ValueId> results;
  for (const ValueId value : body.blocks[0].yields) results.push_back(copier.values.at(value));
  return results;
}

std::vector<ValueId> Slice::call(const Split& split, std::span<const ValueId> arguments) {
  Instruction call;
  call.op = Opcode::call;
  call.imm = split.draw;
  call.first_operand = static_cast<uint32_t>(to_.operands.size());
  call.operand_count = static_cast<uint32_t>(arguments.size());
  to_.operands.insert(to_.operands.end(), arguments.begin(), arguments.end());
  call.first_result = static_cast<ValueId>(to_.values.size());
  call.result_count = static_cast<uint32_t>(split.items.size());
  std::vector<ValueId> results;
  for (const Parameter& result : split.items) {
    results.push_back(static_cast<ValueId>(to_.values.size()));
    to_.values.push_back({result.type, 0});
  }
  to_.blocks[0].instructions.push_back(static_cast<InstructionId>(to_.instructions.size()));
  to_.instructions.push_back(call);
  return results;
}

ValueId Slice::add_parameter(ValueId value) {
  const auto& parameters = from_.blocks[0].parameters;
  const auto number = static_cast<size_t>(std::ranges::find(parameters, value) - parameters.begin());
  support::assert_that(number < parameters.size(), "a value of a block that is not copied");
  needs.push_back(number);
  to_.parameters.push_back(from_.parameters[number]);
  to_.parameters.back().group.clear();
  to_.parameters.back().uniform = true;
  to_.blocks[0].parameters.push_back(copier_.new_value(value));
  return copier_.values.at(value);
}

void Slice::yield(ValueId value, std::string name) {
  to_.results.push_back({std::move(name), to_.type(value)});
  to_.blocks[0].yields.push_back(value);
}

std::vector<ValueId> Slice::read_from_outside(InstructionId id) const {
  std::vector<ValueId> made, outside;
  const auto read = [&](ValueId value) {
    if (std::ranges::find(made, value) == made.end()) outside.push_back(value);
  };
  const auto visit = [&](const auto& self, InstructionId inner) -> void {
    const Instruction& instruction = from_.instructions[inner];
    for (const ValueId value : from_.operands_of(instruction)) read(value);
    for (const BlockId block : instruction.blocks) {
      if (block == none) continue;
      const Block& body = from_.blocks[block];
      made.insert(made.end(), body.parameters.begin(), body.parameters.end());
      for (const InstructionId next : body.instructions) self(self, next);
      for (const ValueId value : body.yields) read(value);
    }
    for (uint32_t k = 0; k < instruction.result_count; ++k) made.push_back(instruction.first_result + k);
  };
  visit(visit, id);
  return outside;
}

}  // namespace isoshade::passes
