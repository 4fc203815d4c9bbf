// SPDX-License-Identifier: Apache-2.0
#include "compiler/prove/flatten.h"

namespace isoshade::prove {

using ir::Opcode;
using ir::Scalar;

std::vector<uint32_t> Pool::key(const Operation& o, std::span<const uint32_t> operands) {
  std::vector<uint32_t> key{static_cast<uint32_t>(o.kind),
                            static_cast<uint32_t>(o.op),
                            static_cast<uint32_t>(o.scalar),
                            o.component,
                            o.index,
                            o.bits};
  key.insert(key.end(), operands.begin(), operands.end());
  return key;
}

uint32_t Pool::make(Operation operation, std::span<const uint32_t> operands) {
  const auto next = static_cast<uint32_t>(tape_.operations.size());
  const auto [found, is_new] = made_.emplace(key(operation, operands), next);
  if (!is_new) return found->second;
  operation.first = static_cast<uint32_t>(tape_.operands.size());
  operation.count = static_cast<uint32_t>(operands.size());
  const Words copy(operands.begin(), operands.end());  // `operands` may lie in the vector that grows
  tape_.operands.insert(tape_.operands.end(), copy.begin(), copy.end());
  tape_.operations.push_back(operation);
  return next;
}

uint32_t Pool::make_op(Opcode op, std::initializer_list<uint32_t> operands, Scalar scalar, uint32_t place) {
  return make({.kind = Kind::op, .op = op, .scalar = scalar, .place = place}, operands);
}

uint32_t Pool::constant(Scalar scalar, uint32_t bits) {
  return make({.kind = Kind::constant, .scalar = scalar, .bits = bits}, {});
}

uint32_t Pool::find(const Operation& operation, std::span<const uint32_t> operands) const {
  const auto found = made_.find(key(operation, operands));
  return found == made_.end() ? none : found->second;
}

}  // namespace isoshade::prove
