// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/op_text.h"

#include <algorithm>
#include <array>
#include <optional>
#include <tuple>
#include <utility>

#include "compiler/support/assert.h"

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

/// All rows of all languages, one after another; a row that begins a language has no op.
struct Row {
  std::optional<ir::Opcode> op;
  std::string_view text = {};  ///< empty: the language does not have the op
};
constexpr Row rows[] = {
#define TARGET(name) Row{std::nullopt},
#define TEXT(op, text) Row{ir::Opcode::op, text},
#define ABSENT(op) Row{ir::Opcode::op},
#include "compiler/targets/targets.def"
};

consteval bool each_language_lists_each_op_once() {
  std::array<std::array<int, ir::primitive_count>, target_count> listed{};
  size_t language = 0;
  for (const Row& row : rows) {
    if (!row.op)
      ++language;
    else
      ++listed[language - 1][static_cast<size_t>(*row.op)];
  }
  for (const auto& ops : listed)
    for (const int count : ops)
      if (count != 1) return false;
  return true;
}
static_assert(each_language_lists_each_op_once(), "an ops.def forgets an op of ir/ops.def, or has it twice");

using Texts = std::array<OpText, ir::primitive_count>;

const std::array<Texts, target_count>& all_texts() {
  static const auto all = [] {
    std::array<Texts, target_count> texts;
    size_t language = 0;
    for (const Row& row : rows) {
      if (!row.op)
        ++language;
      else
        texts[language - 1][static_cast<size_t>(*row.op)] = parse_op_text(row.text);
    }
    return texts;
  }();
  return all;
}

/// A noun for what an op computes.
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
  const std::string_view what = all_texts()[static_cast<size_t>(TargetId::cpp)][static_cast<size_t>(op)].what;
  if (ir::info(op).rule == ir::Rule::logic && what != "!") return "holds";
  const auto found = std::ranges::find(nouns, what, &Noun::what);
  return found != std::end(nouns) ? found->noun : "value";
}

OpShape make_shape(ir::Opcode op) {
  OpShape shape{false, false, 0, noun(op), {}};
  for (const Texts& texts : all_texts()) {
    const OpText& text = texts[static_cast<size_t>(op)];
    shape.is_statement |= text.is_statement;
    shape.repeats |= text.repeats;
    if (shape.columns == 0) shape.columns = text.columns;
    for (const OpText::Piece& piece : text.pieces)
      if (!piece.suffix.empty() && std::ranges::find(shape.suffixes, piece.suffix) == shape.suffixes.end())
        shape.suffixes.push_back(piece.suffix);
  }
  return shape;
}

}  // namespace

bool has_op(TargetId target, ir::Opcode op) {
  return !all_texts()[static_cast<size_t>(target)][static_cast<size_t>(op)].pieces.empty();
}

const OpText& op_text(TargetId target, ir::Opcode op) {
  support::assert_that(has_op(target, op), "a language prints an op that it does not have");
  return all_texts()[static_cast<size_t>(target)][static_cast<size_t>(op)];
}

const OpShape& op_shape(ir::Opcode op) {
  static const auto shapes = [] {
    std::vector<OpShape> all;
    for (int i = 0; i < ir::primitive_count; ++i) all.push_back(make_shape(static_cast<ir::Opcode>(i)));
    return all;
  }();
  return shapes[static_cast<size_t>(op)];
}

}  // namespace isoshade::emit
