// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/op_text.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

namespace isoshade::emit {

namespace {

struct Operator {
  std::string_view text;
  Precedence precedence;
  Room left, right;  ///< what its operands may be
};

using enum Precedence;

// Longer texts before those that begin them.
constexpr Operator operators[] = {
    {"<<", shift, {prefix, primary}, {prefix, primary}},
    {">>", shift, {prefix, primary}, {prefix, primary}},
    {"<=", relation, {sum, primary}, {sum, primary}},
    {">=", relation, {sum, primary}, {sum, primary}},
    {"==", equality, {sum, primary}, {sum, primary}},
    {"!=", equality, {sum, primary}, {sum, primary}},
    {"&&", conjunction, {equality, conjunction}, {equality, primary}},
    {"||", disjunction, {equality, disjunction}, {equality, primary}},
    {"<", relation, {sum, primary}, {sum, primary}},
    {">", relation, {sum, primary}, {sum, primary}},
    {"+", sum, {sum, primary}, {product, primary}},
    {"-", sum, {sum, primary}, {product, primary}},
    {"*", product, {product, primary}, {prefix, primary}},
    {"/", product, {product, primary}, {prefix, primary}},
    {"&", bit_and, {prefix, bit_and}, {prefix, primary}},
    {"^", bit_xor, {prefix, bit_xor}, {prefix, primary}},
    {"|", bit_or, {prefix, bit_or}, {prefix, primary}},
    {"?", choice, {equality, primary}, {equality, primary}},
    {":", choice, {equality, primary}, {choice, choice}},
};
constexpr Operator not_operator{"!", prefix, {}, {prefix, primary}};

/// The operator that `text` begins with, behind spaces. Between operands: no `!`.
const Operator* operator_at(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  for (const Operator& o : operators)
    if (text.starts_with(o.text)) return &o;
  return nullptr;
}

/// The operator that `text` ends with.
const Operator* operator_before(std::string_view text) {
  while (text.ends_with(' ')) text.remove_suffix(1);
  if (text.ends_with('!')) return &not_operator;
  for (const Operator& o : operators)
    if (text.ends_with(o.text)) return &o;
  return nullptr;
}

/// What both neighbours of a place leave room for.
Room both(const Room& a, const Room& b) {
  if (a.least == choice) return b;
  if (b.least == choice) return a;
  return {std::max(a.least, b.least), primary};
}

/// The loosest operator of the text that no brackets enclose.
std::pair<Precedence, std::string_view> loosest(std::string_view text) {
  std::pair<Precedence, std::string_view> found{primary, text.substr(0, text.find('('))};
  int depth = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '(') ++depth;
    if (text[i] == ')') --depth;
    if (depth != 0) continue;
    const bool at_operator = i > 0 && text[i - 1] == ' ' && text[i] != '$';
    const Operator* o = at_operator ? operator_at(text.substr(i)) : nullptr;
    if (text[i] == '!' && i == 0) o = &not_operator;
    if (o != nullptr && o->precedence < found.first) found = {o->precedence, o->text};
  }
  return found;
}

std::string_view suffix_of(std::string_view text) {
  const size_t end = std::min(text.find_first_not_of("_abcdefghijklmnopqrstuvwxyz"), text.size());
  return text.starts_with('_') ? text.substr(0, end) : std::string_view();
}

}  // namespace

OpText parse_op_text(std::string_view text) {
  OpText op;
  op.is_statement = text.starts_with(';');
  if (op.is_statement) text.remove_prefix(1);
  if (!op.is_statement) std::tie(op.precedence, op.what) = loosest(text);
  std::array<bool, 4> seen{};
  std::string_view rest = text;
  for (size_t hole; (hole = rest.find('$')) != std::string_view::npos;) {
    OpText::Piece& piece = op.pieces.emplace_back();
    piece.before = rest.substr(0, hole);
    piece.hole = rest[hole + 1] == '=' ? OpText::result : rest[hole + 1] - '0';
    rest.remove_prefix(hole + 2);
    op.columns += static_cast<int>(hole);
    if (piece.hole == OpText::result) {
      piece.suffix = suffix_of(rest);
      rest.remove_prefix(piece.suffix.size());
      continue;
    }
    op.repeats |= std::exchange(seen[static_cast<size_t>(piece.hole)], true);
    const Operator* before = operator_before(piece.before);
    const Operator* after = operator_at(rest);
    const std::string_view left = piece.before.substr(0, piece.before.find_last_not_of(' ') + 1);
    const bool opens = left.ends_with('(') || left.ends_with(',');
    piece.is_argument = opens && (rest.starts_with(')') || rest.starts_with(','));
    piece.room = both(before != nullptr ? before->right : Room{}, after != nullptr ? after->left : Room{});
  }
  op.end = rest;
  op.columns += static_cast<int>(rest.size());
  return op;
}

std::vector<OpText> parse_op_texts(std::string_view ir::OpInfo::*column) {
  std::vector<OpText> texts;
  for (int op = 0; op < ir::primitive_count; ++op)
    texts.push_back(parse_op_text(ir::info(static_cast<ir::Opcode>(op)).*column));
  return texts;
}

std::string_view noun(ir::Opcode op) {
  struct Noun {
    std::string_view what, noun;
  };
  // By the operator or the function that the op's C++ says.
  static constexpr Noun nouns[] = {
      {"+", "sum"},
      {"-", "difference"},
      {"*", "product"},
      {"/", "quotient"},
      {"&", "masked"},
      {"|", "joined"},
      {"^", "toggled"},
      {"<", "is_less"},
      {"<=", "is_at_most"},
      {">", "is_more"},
      {">=", "is_at_least"},
      {"==", "is_equal"},
      {"!=", "is_unequal"},
      {"!", "is_not"},
      {"sqrt", "root"},
      {"floor", "whole"},
      {"negate", "negated"},
      {"abs", "magnitude"},
      {"select", "chosen"},
      {"to_int", "whole"},
      {"to_float", "number"},
      {"bits", "word"},
      {"bits_nonnan", "word"},
      {"from_bits", "number"},
      {"from_bits_normal", "number"},
      {"mul_hi", "high"},
      {"unsigned_mul_hi", "high"},
      {"shift_left", "shifted"},
      {"shift_right", "shifted"},
      {"shift_right_signed", "shifted"},
      {"unsigned_less", "is_less"},
  };
  const ir::OpInfo& row = ir::info(op);
  const std::string_view what = parse_op_text(row.cpp).what;
  if (row.rule == ir::Rule::logic && what != "!") return "holds";
  const auto found = std::ranges::find(nouns, what, &Noun::what);
  return found != std::end(nouns) ? found->noun : "value";
}

}  // namespace isoshade::emit
