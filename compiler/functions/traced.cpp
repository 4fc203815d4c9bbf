// SPDX-License-Identifier: Apache-2.0
#include "compiler/functions/traced.h"

namespace isoshade::functions::traced {

#define UNARY(result, name, type, op) \
  result name(type a) { return record<result>(ir::Opcode::op, a); }
#define BINARY(result, name, type, op) \
  result name(type a, type b) { return record<result>(ir::Opcode::op, a, b); }
#include "compiler/functions/traced_ops.def"

Float select(Bool condition, Float then, Float other) {
  return record<Float>(ir::Opcode::select, condition, then, other);
}
Int select(Bool condition, Int then, Int other) {
  return record<Int>(ir::Opcode::select, condition, then, other);
}
Bool select(Bool condition, Bool then, Bool other) {
  return record<Bool>(ir::Opcode::select, condition, then, other);
}

ir::ValueId construct(ir::Builder& builder, std::span<const Float> components) {
  std::array<ir::ValueId, 4> ids;
  for (size_t i = 0; i < components.size(); ++i) ids[i] = components[i].id(builder);
  return builder.construct(std::span(ids).first(components.size()));
}

}  // namespace isoshade::functions::traced
