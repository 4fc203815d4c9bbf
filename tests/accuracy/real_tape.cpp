// SPDX-License-Identifier: Apache-2.0
#include "tests/accuracy/real_tape.h"

#include <algorithm>
#include <bit>

#include "backends/reference/functions.h"
#include "compiler/functions/library.h"
#include "compiler/ir/evaluate.h"

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
  if (operation.op == Opcode::select && follow) return cells_[in[floats_.word(in[0]) != 0 ? 1 : 2]];
  static const Cell absent;
  const auto operand = [&](size_t i) -> const Cell& { return i < in.size() ? cells_[in[i]] : absent; };
  Cell result;
  reference::compute(operation.op, operand(0), operand(1), operand(2), result);
  return result;
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
