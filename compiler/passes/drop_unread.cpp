// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "compiler/passes/passes.h"

namespace isoshade::passes {

namespace {

using namespace ir;
using Marks = std::vector<char>;

/// What of the signature of each function is read, given that nothing dead is left inside functions, and callees stand
/// before callers.
class Signatures {
 public:
  Signatures(const Module& module, std::span<const uint32_t> kept) : module_(module) {
    for (const Function& function : module.functions) {
      // The host's, and those that other programs have, too, under the same name.
      const bool stays = function.is_declaration() || !function.library.empty();
      parameters_.emplace_back(function.parameters.size(), stays);
      results_.emplace_back(function.results.size(), stays);
    }
    for (const uint32_t entry : kept) {
      std::ranges::fill(parameters_[entry], true);
      std::ranges::fill(results_[entry], true);
    }
    for (uint32_t f = 0; f < module.functions.size(); ++f)
      if (!module.functions[f].is_declaration()) read(f);
    // A function returns something.
    for (Marks& results : results_)
      if (std::ranges::count(results, true) == 0) std::ranges::fill(results, true);
  }

  const Marks& parameters(uint32_t function) const { return parameters_[function]; }
  const Marks& results(uint32_t function) const { return results_[function]; }
  bool all_read() const {
    const auto all = [](const Marks& marks) { return std::ranges::count(marks, false) == 0; };
    return std::ranges::all_of(parameters_, all) && std::ranges::all_of(results_, all);
  }

 private:
  void read(uint32_t f) {
    const Function& function = module_.functions[f];
    Marks used(function.values.size());
    const auto use = [&](ValueId value) { used[value] = true; };
    for (const Block& block : function.blocks) {
      std::ranges::for_each(block.yields, use);
      for (const InstructionId id : block.instructions) {
        const Instruction& made = function.instructions[id];
        const auto operands = function.operands_of(made);
        for (size_t i = 0; i < operands.size(); ++i)
          if (made.op != Opcode::call || parameters_[made.imm][i]) use(operands[i]);
      }
    }
    for (size_t i = 0; i < function.parameters.size(); ++i)
      if (used[function.blocks[0].parameters[i]]) parameters_[f][i] = true;
    for (const Block& block : function.blocks)
      for (const InstructionId id : block.instructions) {
        const Instruction& made = function.instructions[id];
        for (uint32_t k = 0; made.op == Opcode::call && k < made.result_count; ++k)
          if (used[made.first_result + k]) results_[made.imm][k] = true;
      }
  }

  const Module& module_;
  std::vector<Marks> parameters_, results_;  ///< by function
};

template <class T>
void keep_marked(std::vector<T>& list, const Marks& marks) {
  size_t next = 0;
  std::erase_if(list, [&](const T&) { return !marks[next++]; });
}

/// Leaves out of a function's calls what their callees no longer take and return.
void shorten_calls(Function& function, const Signatures& read) {
  std::vector<ValueId> moved(function.values.size());
  for (ValueId value = 0; value < moved.size(); ++value) moved[value] = value;
  for (Block& block : function.blocks)
    for (const InstructionId id : block.instructions) {
      Instruction& made = function.instructions[id];
      if (made.op != Opcode::call) continue;
      uint32_t kept = 0;
      for (uint32_t i = 0; i < made.operand_count; ++i)
        if (read.parameters(made.imm)[i])
          function.operands[made.first_operand + kept++] = function.operands[made.first_operand + i];
      made.operand_count = kept;
      const Marks& results = read.results(made.imm);
      if (std::ranges::count(results, false) == 0) continue;
      // The results of an instruction are consecutive.
      const auto first = static_cast<ValueId>(function.values.size());
      for (uint32_t k = 0; k < results.size(); ++k) {
        if (!results[k]) continue;
        moved[made.first_result + k] = static_cast<ValueId>(function.values.size());
        function.values.push_back(Value(function.values[made.first_result + k]));
      }
      made.first_result = first;
      made.result_count = static_cast<uint32_t>(function.values.size()) - first;
    }
  const auto move = [&](ValueId& value) { value = value < moved.size() ? moved[value] : value; };
  std::ranges::for_each(function.operands, move);
  for (Block& block : function.blocks) std::ranges::for_each(block.yields, move);
}

}  // namespace

void drop_unread(Module& module, std::vector<uint32_t>& entries) {
  while (true) {
    dce(module, entries);
    const Signatures read(module, entries);
    if (read.all_read()) return;
    for (uint32_t f = 0; f < module.functions.size(); ++f) {
      Function& function = module.functions[f];
      if (function.is_declaration()) continue;
      shorten_calls(function, read);
      keep_marked(function.parameters, read.parameters(f));
      keep_marked(function.blocks[0].parameters, read.parameters(f));
      keep_marked(function.results, read.results(f));
      keep_marked(function.blocks[0].yields, read.results(f));
    }
    // What made the arguments is dead now, and perhaps the last to read a parameter.
    renumber(module);
  }
}

}  // namespace isoshade::passes
