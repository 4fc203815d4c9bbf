// SPDX-License-Identifier: Apache-2.0
#include "backends/interpreter/steps.h"

#include <algorithm>

#include "compiler/ir/evaluate.h"
#include "compiler/support/assert.h"

namespace isoshade::interpreter {
namespace {

template <ir::Opcode op>
const Step* primitive(const Step& s, Context& context) {
  uint32_t* const scalars = context.scalars;
  scalars[s.to] = ir::evaluate(op, scalars[s.a], scalars[s.b], scalars[s.c]);
  return &s + 1;
}

Run* find_primitive(ir::Opcode op) {
  switch (op) {
#define OP(name, ...) \
  case ir::Opcode::name: return primitive<ir::Opcode::name>;
#define FORM(name, ...) case ir::Opcode::name:
#include "compiler/ir/ops.def"
    break;
  }
  return nullptr;
}

template <class T>
const Step* load(const Step& s, Context& context) {
  const BufferView& buffer = context.buffers[s.more];
  const uint32_t last = static_cast<uint32_t>(buffer.size) - 1;
  const T element = static_cast<const T*>(buffer.data)[std::min(context.scalars[s.a], last)];
  context.scalars[s.to] = std::bit_cast<uint32_t>(element);
  return &s + 1;
}

const Step* copy(const Step& s, Context& context) {
  context.scalars[s.to] = context.scalars[s.a];
  return &s + 1;
}

const Step* jump(const Step& s, Context&) { return &s + static_cast<int32_t>(s.b); }

const Step* jump_if_not(const Step& s, Context& context) {
  return context.scalars[s.a] == 0 ? &s + static_cast<int32_t>(s.b) : &s + 1;
}

const Step* jump_unless_less(const Step& s, Context& context) {
  const auto index = static_cast<int32_t>(context.scalars[s.a]), count = static_cast<int32_t>(context.scalars[s.c]);
  return index < count ? &s + 1 : &s + static_cast<int32_t>(s.b);
}

}  // namespace

Run* find_scalar(const Shape& shape) {
  switch (shape.kind) {
    case Kind::primitive: return find_primitive(shape.op);
    case Kind::load: return shape.type == ir::Scalar::floating ? load<float> : load<int32_t>;
    case Kind::copy: return copy;
    case Kind::jump: return jump;
    case Kind::jump_if_not: return jump_if_not;
    case Kind::jump_unless_less: return jump_unless_less;
    case Kind::fused:
    case Kind::split: break;
  }
  support::bug("no scalar step is of this kind");
}

}  // namespace isoshade::interpreter
