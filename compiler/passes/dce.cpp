// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/passes.h"

#include <utility>

#include "compiler/ir/call_graph.h"
#include "compiler/support/assert.h"

namespace isoshade::passes {

void dce(ir::Module& module, std::vector<uint32_t>& entries) {
  const auto order = ir::callees_first(module, entries);
  support::assert_that(order.has_value(), "a function calls itself");
  std::vector<uint32_t> moved(module.functions.size(), ir::none);
  std::vector<ir::Function> kept;
  for (uint32_t function : *order) {
    moved[function] = static_cast<uint32_t>(kept.size());
    kept.push_back(std::move(module.functions[function]));
  }
  module.functions = std::move(kept);
  for (ir::Function& function : module.functions)
    for (ir::Instruction& instruction : function.instructions)
      if (instruction.op == ir::Opcode::call) instruction.imm = moved[instruction.imm];
  for (uint32_t& entry : entries) entry = moved[entry];
}

}  // namespace isoshade::passes
