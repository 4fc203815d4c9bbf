// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "compiler/functions/exact.h"
#include "compiler/functions/traced.h"
#include "compiler/passes/passes.h"

namespace isoshade::passes {

namespace {

using functions::traced::Int;

/// Adds `int NAME(int a, int b)` with this body to the module.
uint32_t add_function(ir::Module& module, std::string_view name, Int (*body)(Int, Int)) {
  ir::Function function;
  function.name = "iso_" + std::string(name);
  function.library = name;
  for (const char* parameter : {"a", "b"}) function.parameters.push_back({parameter, ir::int_type, "", false});
  function.results.push_back({"out", ir::int_type});
  module.functions.push_back(std::move(function));
  const auto index = static_cast<uint32_t>(module.functions.size() - 1);
  ir::Builder builder(module, index);
  const ir::ValueId result =
      body({builder, builder.parameter(0)}, {builder, builder.parameter(1)}).id(builder);
  builder.finish({&result, 1});
  return index;
}

}  // namespace

void multiply_by_halves(ir::Module& module) {
  std::optional<uint32_t> of_signed, of_unsigned;
  const size_t count = module.functions.size();  // without those that are added
  for (size_t f = 0; f < count; ++f)
    for (size_t i = 0; i < module.functions[f].instructions.size(); ++i) {
      const ir::Opcode op = module.functions[f].instructions[i].op;
      if (op != ir::Opcode::imulhi && op != ir::Opcode::umulhi) continue;
      std::optional<uint32_t>& callee = op == ir::Opcode::imulhi ? of_signed : of_unsigned;
      if (!callee)
        callee = op == ir::Opcode::imulhi
                     ? add_function(module, "mul_hi_by_halves", functions::mul_hi_by_halves<Int>)
                     : add_function(module, "unsigned_mul_hi_by_halves",
                                    functions::unsigned_mul_hi_by_halves<Int>);
      ir::Instruction& call = module.functions[f].instructions[i];
      call.op = ir::Opcode::call;
      call.imm = *callee;
    }
}

}  // namespace isoshade::passes
