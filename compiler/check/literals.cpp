// SPDX-License-Identifier: Apache-2.0
#include "compiler/check/literals.h"

#include <bit>

namespace isoshade::check {

using graph::Literal;

namespace {

bool is_tuple(Type type) { return (nodes::vector_types | nodes::color_types).has(type); }

void begin(TypedGraph& typed, Type type, Operand& operand) {
  operand.from = Operand::From::words;
  operand.type = operand.needed = type;
  operand.index = static_cast<uint32_t>(typed.words.size());
}

}  // namespace

bool converts(Type from, Type to) {
  if (from == to) return true;
  if (from == Type::floating) return is_tuple(to);
  return from == Type::integer && to == Type::floating;
}

bool fits(const Literal& literal, Type type) {
  return graph::fits(type, literal) || (is_tuple(type) && literal.kind == Literal::Kind::number);
}

void place(TypedGraph& typed, const Literal& literal, Type type, Operand& operand) {
  if (type == Type::floating || (is_tuple(type) && literal.kind == Literal::Kind::number))
    return place(typed, literal.number, type, operand);
  begin(typed, type, operand);
  if (type == Type::boolean) typed.words.push_back(literal.boolean ? 1 : 0);
  if (type == Type::integer) typed.words.push_back(static_cast<uint32_t>(literal.integer));
  for (const float number : literal.numbers) typed.words.push_back(std::bit_cast<uint32_t>(number));
}

void place(TypedGraph& typed, float value, Type type, Operand& operand) {
  begin(typed, type, operand);
  for (int i = 0; i < graph::float_count(type); ++i) typed.words.push_back(std::bit_cast<uint32_t>(value));
}

std::string described(const Literal& literal) {
  switch (literal.kind) {
    case Literal::Kind::boolean: return "a boolean";
    case Literal::Kind::number: return "a number";
    case Literal::Kind::numbers: return "an array of " + std::to_string(literal.numbers.size()) + " numbers";
    case Literal::Kind::string: return "a string";
  }
  return {};
}

}  // namespace isoshade::check
