// SPDX-License-Identifier: Apache-2.0
#include "compiler/check/literals.h"

#include <bit>
#include <utility>

namespace isoshade::check {

using graph::Literal;

namespace {

bool is_tuple(Type type) { return (nodes::vector_types | nodes::color_types).has(type); }

void begin(TypedGraph& typed, Type type, Operand& operand) {
  operand.from = Operand::From::words;
  operand.type = operand.needed = type;
  operand.index = static_cast<uint32_t>(typed.words.size());
}

/// In every component of a tuple, on the diagonal of a matrix.
void place_number(TypedGraph& typed, float value, Type type, Operand& operand) {
  begin(typed, type, operand);
  if (type == Type::integer) typed.words.push_back(static_cast<uint32_t>(static_cast<int32_t>(value)));
  if (type == Type::boolean) typed.words.push_back(value != 0 ? 1 : 0);
  const int count = graph::float_count(type);
  const int step = type == Type::matrix33 ? 4 : type == Type::matrix44 ? 5 : 1;
  for (int i = 0; i < count; ++i) typed.words.push_back(i % step == 0 ? std::bit_cast<uint32_t>(value) : 0);
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
    return place_number(typed, literal.number, type, operand);
  begin(typed, type, operand);
  if (type == Type::boolean) typed.words.push_back(literal.boolean ? 1 : 0);
  if (type == Type::integer) typed.words.push_back(static_cast<uint32_t>(literal.integer));
  for (const float number : literal.numbers) typed.words.push_back(std::bit_cast<uint32_t>(number));
}

void place_file(TypedGraph& typed, File file, Operand& operand) {
  operand.from = Operand::From::file;
  operand.type = operand.needed = Type::filename;
  operand.index = static_cast<uint32_t>(typed.files.size());
  typed.files.push_back(std::move(file));
}

void place(TypedGraph& typed, const nodes::Default& value, Type type, Operand& operand) {
  if (const auto* attribute = std::get_if<nodes::SurfaceValue>(&value)) {
    operand.from = Operand::From::surface;
    operand.type = operand.needed = type;
    operand.index = static_cast<uint32_t>(attribute->index());
  } else if (const auto* numbers = std::get_if<std::array<float, 3>>(&value)) {
    begin(typed, type, operand);
    for (const float number : *numbers) typed.words.push_back(std::bit_cast<uint32_t>(number));
    typed.words.resize(operand.index + static_cast<size_t>(graph::float_count(type)));
  } else if (const auto* truth = std::get_if<bool>(&value); truth != nullptr && type == Type::boolean) {
    begin(typed, type, operand);
    typed.words.push_back(*truth ? 1 : 0);
  } else {
    place_number(typed, truth != nullptr ? 0.0f : std::get<float>(value), type, operand);
  }
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
