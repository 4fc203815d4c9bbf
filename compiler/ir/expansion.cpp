// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/expansion.h"

#include <algorithm>
#include <array>

#include "compiler/ir/call_graph.h"
#include "compiler/support/assert.h"

namespace isoshade::ir {

namespace {

constexpr uint64_t beyond_all_limits = uint64_t{1} << 48;

uint64_t of_block(const Function& function, BlockId block, const std::vector<uint64_t>& of_functions,
                  uint64_t of_division) {
  uint64_t sum = 0;
  for (const InstructionId id : function.blocks[block].instructions) {
    const Instruction& made = function.instructions[id];
    if (made.op == Opcode::constant || made.op == Opcode::extract) continue;
    sum = std::min(beyond_all_limits, sum + expanded_operations(function, made, of_functions, of_division));
  }
  return sum;
}

}  // namespace

uint64_t expanded_operations(const Function& function, const Instruction& instruction,
                             const std::vector<uint64_t>& of_functions, uint64_t of_division) {
  const uint64_t width = function.type(instruction.first_result).width;
  uint64_t sum = 0;
  if (instruction.op == Opcode::fdiv || instruction.op == Opcode::fsqrt)
    sum = of_division * width;
  else if (is_primitive(instruction.op) || instruction.op == Opcode::load)
    sum = width;
  else if (instruction.op == Opcode::call)
    sum = of_functions[instruction.imm];
  for (const BlockId block : instruction.blocks)
    if (block != none) sum += of_block(function, block, of_functions, of_division);
  return std::min(beyond_all_limits, sum);
}

std::vector<uint64_t> expanded_operations(const Module& module, uint32_t entry, uint64_t of_division) {
  const auto order = callees_first(module, std::array{entry});
  support::assert_that(order.has_value(), "a function calls itself");
  std::vector<uint64_t> of_functions(module.functions.size());
  for (const uint32_t f : *order)
    if (!module.functions[f].is_declaration())
      of_functions[f] = of_block(module.functions[f], 0, of_functions, of_division);
  return of_functions;
}

}  // namespace isoshade::ir
