// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/passes.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace isoshade::passes {

namespace {

using namespace ir;

/// Which parameters of a function anything reads. Needs a function without dead instructions.
std::vector<bool> parameters_read(const Function& f) {
  std::vector<bool> read(f.values.size());
  for (const Block& block : f.blocks) {
    for (const InstructionId id : block.instructions)
      for (const ValueId value : f.operands_of(f.instructions[id])) read[value] = true;
    for (const ValueId value : block.yields) read[value] = true;
  }
  std::vector<bool> of_parameters;
  for (const ValueId parameter : f.blocks[0].parameters) of_parameters.push_back(read[parameter]);
  return of_parameters;
}

template <class T>
void keep_if(std::vector<T>& list, const std::vector<bool>& kept) {
  size_t count = 0;
  for (size_t i = 0; i < list.size(); ++i)
    if (kept[i] && count++ != i) list[count - 1] = std::move(list[i]);
  list.resize(count);
}

void drop_arguments(Function& f, const std::vector<std::vector<bool>>& read) {
  for (const Block& block : f.blocks) {
    for (const InstructionId id : block.instructions) {
      Instruction& call = f.instructions[id];
      if (call.op != Opcode::call || read[call.imm].empty()) continue;
      uint32_t kept = 0;
      for (uint32_t i = 0; i < call.operand_count; ++i)
        if (read[call.imm][i]) f.operands[call.first_operand + kept++] = f.operands[call.first_operand + i];
      call.operand_count = kept;
    }
  }
}

}  // namespace

void drop_parameters(Module& module, std::span<const uint32_t> entries) {
  for (bool dropped = true; std::exchange(dropped, false);) {
    std::vector<std::vector<bool>> read(module.functions.size());
    for (uint32_t i = 0; i < module.functions.size(); ++i) {
      Function& f = module.functions[i];
      if (f.is_declaration() || std::ranges::find(entries, i) != entries.end()) continue;
      std::vector<bool> of_parameters = parameters_read(f);
      if (std::ranges::find(of_parameters, false) == of_parameters.end()) continue;
      keep_if(f.parameters, of_parameters);
      keep_if(f.blocks[0].parameters, of_parameters);
      f.library.clear();  // it no longer has the signature
      read[i] = std::move(of_parameters);
      dropped = true;
    }
    if (!dropped) return;
    for (Function& f : module.functions) drop_arguments(f, read);
    renumber(module);
  }
}

}  // namespace isoshade::passes
