// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/bind.h"

#include "compiler/support/assert.h"

namespace isoshade::passes {

namespace {

/// Appends the instructions that make a value of these words to `head`.
void define(ir::Function& function, ir::ValueId value, const std::vector<uint32_t>& words,
            std::vector<ir::InstructionId>& head) {
  const auto append = [&](const ir::Instruction& instruction) {
    function.instructions.push_back(instruction);
    head.push_back(static_cast<ir::InstructionId>(function.instructions.size() - 1));
  };
  ir::Instruction constant;
  constant.op = ir::Opcode::constant;
  if (words.size() == 1) {
    constant.imm = words[0];
    constant.first_result = value;
    return append(constant);
  }
  ir::Instruction construct;
  construct.op = ir::Opcode::construct;
  construct.first_operand = static_cast<uint32_t>(function.operands.size());
  construct.operand_count = static_cast<uint32_t>(words.size());
  construct.first_result = value;
  for (uint32_t word : words) {
    function.values.push_back({ir::float_type, 0});
    constant.imm = word;
    constant.first_result = static_cast<ir::ValueId>(function.values.size() - 1);
    append(constant);
  }
  for (size_t i = 0; i < words.size(); ++i)
    function.operands.push_back(static_cast<ir::ValueId>(function.values.size() - words.size() + i));
  append(construct);
}

}  // namespace

void bind_parameters(ir::Function& function, std::span<const KnownWords> words) {
  support::assert_that(words.size() == function.parameters.size(), "known words for other parameters");
  std::vector<ir::Parameter> parameters;
  std::vector<ir::ValueId> values;
  std::vector<ir::InstructionId> head;
  for (size_t i = 0; i < words.size(); ++i) {
    const ir::ValueId value = function.blocks[0].parameters[i];
    if (!words[i]) {
      parameters.push_back(function.parameters[i]);
      values.push_back(value);
    } else {
      define(function, value, *words[i], head);
    }
  }
  function.parameters = std::move(parameters);
  function.blocks[0].parameters = std::move(values);
  auto& instructions = function.blocks[0].instructions;
  instructions.insert(instructions.begin(), head.begin(), head.end());
}

}  // namespace isoshade::passes
