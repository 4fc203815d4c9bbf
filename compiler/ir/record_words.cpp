// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/record_words.h"

#include <algorithm>
#include <set>

namespace isoshade::ir {

std::vector<InstructionId> made_by(const Function& function) {
  std::vector<InstructionId> made(function.values.size(), none);
  for (InstructionId id = 0; id < function.instructions.size(); ++id)
    for (uint32_t k = 0; k < function.instructions[id].result_count; ++k)
      made[function.instructions[id].first_result + k] = id;
  return made;
}

RecordAddresses::RecordAddresses(const Function& kernel, std::optional<size_t> record)
    : kernel_(kernel), made_by_(made_by(kernel)) {
  if (record) record_ = kernel.blocks[0].parameters[*record];
}

std::optional<uint32_t> RecordAddresses::constant(ValueId value) const {
  const bool is_constant =
      made_by_[value] != none && kernel_.instructions[made_by_[value]].op == Opcode::constant;
  return is_constant ? std::optional(kernel_.instructions[made_by_[value]].imm) : std::nullopt;
}

std::optional<uint32_t> RecordAddresses::word(ValueId address) const {
  if (!record_) return constant(address);
  if (address == *record_) return 0;
  if (made_by_[address] == none || kernel_.instructions[made_by_[address]].op != Opcode::iadd)
    return std::nullopt;
  const auto operands = kernel_.operands_of(kernel_.instructions[made_by_[address]]);
  if (operands[0] == *record_) return constant(operands[1]);
  return operands[1] == *record_ ? constant(operands[0]) : std::nullopt;
}

std::optional<std::vector<uint32_t>> loaded_words(const Module& module, uint32_t kernel,
                                                  std::optional<size_t> record,
                                                  std::span<const uint32_t> buffers) {
  const RecordAddresses addresses(module.functions[kernel], record);
  std::set<uint32_t> words;
  for (uint32_t f = 0; f < module.functions.size(); ++f) {
    const Function& function = module.functions[f];
    for (const Instruction& made : function.instructions) {
      if (made.op != Opcode::load || std::ranges::count(buffers, made.imm) == 0) continue;
      const auto word = f == kernel ? addresses.word(function.operands_of(made)[0]) : std::nullopt;
      if (!word) return std::nullopt;
      words.insert(*word);
    }
  }
  return std::vector(words.begin(), words.end());
}

bool loads_from(const Module& module, uint32_t buffer) {
  return std::ranges::any_of(module.functions, [&](const Function& function) {
    return std::ranges::any_of(function.instructions, [&](const Instruction& made) {
      return made.op == Opcode::load && made.imm == buffer;
    });
  });
}

}  // namespace isoshade::ir
