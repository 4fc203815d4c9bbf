// SPDX-License-Identifier: Apache-2.0
#include "tests/accuracy/real_tape.h"

#include <algorithm>
#include <bit>

#include "backends/reference/functions.h"
#include "compiler/functions/library.h"
#include "compiler/ir/evaluate.h"
#include "compiler/support/assert.h"

namespace isoshade::accuracy {

using prove::Kind;
using prove::Operation;
using ir::Opcode;
using reference::Real;

void RealTape::run(std::span<const uint32_t> inputs, bool follow) {
  cells_.assign(tape_.operations.size(), {});
  for (uint32_t i = 0; i < tape_.operations.size(); ++i)
    cells_[i] = value_of(tape_.operations[i], i, inputs, follow);
}

RealTape::Cell RealTape::value_of(const Operation& operation, uint32_t index,
                                  std::span<const uint32_t> inputs, bool follow) {
  const auto in = tape_.operands_of(operation);
  const auto given = [&](uint32_t word) {
    const bool is_float = operation.scalar == ir::Scalar::floating;
    return Cell{is_float ? Real(std::bit_cast<float>(ir::flush_denormal(word))) : Real(), word};
  };
  switch (operation.kind) {
    case Kind::constant: return given(operation.bits);
    case Kind::input: return given(inputs[operation.index]);
    case Kind::op: return op(operation, follow);
    case Kind::least: return {std::min(cells_[in[0]].number, cells_[in[1]].number)};
    case Kind::greatest: return {std::max(cells_[in[0]].number, cells_[in[1]].number)};
    case Kind::dot: return {dot(in)};
    case Kind::row: return {row(operation)};
    case Kind::asked:
    case Kind::sum:
    case Kind::narrow: return cells_[in[0]];
    case Kind::unknown: return given(floats_.word(index));
    case Kind::enter: break;
  }
  return {};
}

RealTape::Cell RealTape::op(const Operation& operation, bool follow) {
  const auto in = tape_.operands_of(operation);
  const auto number = [&](size_t i) -> const Real& { return cells_[in[i]].number; };
  const auto word = [&](size_t i) { return i < in.size() ? cells_[in[i]].word : 0; };
  switch (operation.op) {
    case Opcode::fadd: return {number(0) + number(1)};
    case Opcode::fsub: return {number(0) - number(1)};
    case Opcode::fmul: return {number(0) * number(1)};
    case Opcode::fdiv: return {number(0) / number(1)};
    case Opcode::fsqrt: return {sqrt(number(0))};
    case Opcode::floor: return {floor(number(0))};
    case Opcode::fneg: return {-number(0)};
    case Opcode::fabs: return {abs(number(0))};
    case Opcode::flt: return {{}, number(0) < number(1)};
    case Opcode::fle: return {{}, number(0) <= number(1)};
    case Opcode::fgt: return {{}, number(0) > number(1)};
    case Opcode::fge: return {{}, number(0) >= number(1)};
    case Opcode::feq: return {{}, number(0) == number(1)};
    case Opcode::fne: return {{}, number(0) != number(1)};
    case Opcode::select: return cells_[in[(follow ? floats_.word(in[0]) : word(0)) != 0 ? 1 : 2]];
    case Opcode::itof: return {static_cast<int32_t>(word(0))};
    case Opcode::ftoi: {
      const auto cut = std::clamp<int64_t>(static_cast<int64_t>(number(0)), INT32_MIN, INT32_MAX);
      return {{}, static_cast<uint32_t>(static_cast<int32_t>(cut))};
    }
    case Opcode::fbits:
    case Opcode::fbits_nonnan: return {{}, std::bit_cast<uint32_t>(reference::stored(number(0)))};
    case Opcode::bitsf:
    case Opcode::bitsf_normal: return {std::bit_cast<float>(ir::flush_denormal(word(0)))};
    case Opcode::iadd:
    case Opcode::isub:
    case Opcode::imul:
    case Opcode::imulhi:
    case Opcode::umulhi:
    case Opcode::iand:
    case Opcode::ior:
    case Opcode::ixor:
    case Opcode::ishl:
    case Opcode::ishr:
    case Opcode::isar:
    case Opcode::ilt:
    case Opcode::ile:
    case Opcode::igt:
    case Opcode::ige:
    case Opcode::ieq:
    case Opcode::ine:
    case Opcode::ult:
    case Opcode::band:
    case Opcode::bor:
    case Opcode::bxor:
    case Opcode::bnot: return {{}, ir::evaluate(operation.op, word(0), word(1), word(2))};
    case Opcode::constant:
    case Opcode::construct:
    case Opcode::extract:
    case Opcode::hidden_zero:
    case Opcode::load:
    case Opcode::call:
    case Opcode::branch:
    case Opcode::loop:
    case Opcode::ddx:
    case Opcode::ddy: break;
  }
  support::bug("exact arithmetic has no such op");
}

Real RealTape::dot(std::span<const uint32_t> in) const {
  const size_t half = in.size() / 2;
  Real sum;
  for (size_t i = 0; i < half; ++i) sum = sum + cells_[in[i]].number * cells_[in[half + i]].number;
  return sum;
}

Real RealTape::row(const Operation& operation) const {
  const prove::Row& row = tape_.rows[operation.index];
  const ir::Function& function = tape_.module.functions[row.function];
  const auto in = tape_.operands_of(operation);
  // A row that works componentwise has the operands of one component: it computes all alike.
  const bool componentwise = prove::is_componentwise(row.rule->row);
  std::vector<Real> arguments, results(row.words);
  size_t next = 0;
  for (const ir::Parameter& parameter : function.parameters) {
    for (uint32_t c = 0; c < parameter.type.width; ++c)
      arguments.push_back(cells_[in[componentwise ? next : next++]].number);
    if (componentwise) ++next;
  }
  reference::evaluate(functions::variant_of(function), arguments, results);
  return results[operation.component];
}

}  // namespace isoshade::accuracy
