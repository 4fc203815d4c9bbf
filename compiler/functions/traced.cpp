// SPDX-License-Identifier: Apache-2.0
#include "compiler/functions/traced.h"

namespace isoshade::functions::traced {

#define TRACE_1(result, function, type, op) \
  result function(type a) { return record<result>(ir::Opcode::op, a); }
#define TRACE_2(result, function, type, op) \
  result function(type a, type b) { return record<result>(ir::Opcode::op, a, b); }
#define TRACE_3(result, function, type, op) \
  result function(Bool condition, type a, type b) { return record<result>(ir::Opcode::op, condition, a, b); }
#define OP(name, arity, rule, cpp, ...) TRACE_##rule(arity, SPELLED_##cpp, name)
#include "compiler/ir/ops.def"

ir::ValueId construct(ir::Builder& builder, std::span<const Float> components) {
  std::array<ir::ValueId, 4> ids;
  for (size_t i = 0; i < components.size(); ++i) ids[i] = components[i].id(builder);
  return builder.construct(std::span(ids).first(components.size()));
}

}  // namespace isoshade::functions::traced
