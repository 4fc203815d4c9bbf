// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/passes.h"

#include <vector>

#include "compiler/functions/library.h"
#include "compiler/support/assert.h"

namespace isoshade::passes {

void exact_division(ir::Module& module) {
  // Declarations go to the end of the list: index, do not iterate.
  for (size_t f = 0; f < module.functions.size(); ++f) {
    for (size_t i = 0; i < module.functions[f].instructions.size(); ++i) {
      ir::Function& function = module.functions[f];
      ir::Instruction& instruction = function.instructions[i];
      if (instruction.op != ir::Opcode::fdiv && instruction.op != ir::Opcode::fsqrt) continue;
      std::vector<ir::Type> types;
      for (ir::ValueId operand : function.operands_of(instruction)) types.push_back(function.type(operand));
      const auto* variant = functions::find(types.size() == 2 ? "div_exact" : "sqrt_exact", types);
      support::assert_that(variant != nullptr, "no exact division of this type");
      const uint32_t callee = functions::declare(module, *variant);
      ir::Instruction& call = module.functions[f].instructions[i];
      call.op = ir::Opcode::call;
      call.imm = callee;
    }
  }
}

}  // namespace isoshade::passes
