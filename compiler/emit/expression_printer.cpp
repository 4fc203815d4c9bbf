// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/expression_printer.h"

#include <algorithm>

#include "compiler/emit/literal.h"
#include "compiler/support/assert.h"

namespace isoshade::emit {

namespace {

using ir::Opcode;
using ir::ValueId;

constexpr std::string_view component_names[] = {"x", "y", "z", "w"};

/// Shorter ones are never what is given a name of its own to make room.
constexpr int fewest_named = 12;
constexpr int literal_columns = 6;
/// What is no longer than this shares a line with the next of its type: `int x0 = p[0], y0 = p[1];`; of an author's
/// nodes only the shortest, as `x2 = x * x, x4 = x2 * x2`.
constexpr int most_joined = 42;
constexpr int most_joined_node = 25;

/// Whether a compiler may contract it, or do it otherwise than written.
bool is_float_arithmetic(Opcode op) {
  return ir::is_primitive(op) && ir::info(op).rule == ir::Rule::same && op != Opcode::fneg &&
         op != Opcode::fabs;
}

bool combines_bits(Opcode op) { return op == Opcode::iand || op == Opcode::ior || op == Opcode::ixor; }

}  // namespace

std::string_view ExpressionPrinter::noun_of(const ir::Instruction& made) const {
  if (ir::is_primitive(made.op)) return op_shape(made.op).noun;
  if (made.op == Opcode::construct) return "vector";
  if (made.op == Opcode::call) {
    const FunctionText& called = context_.texts[made.imm];
    std::string_view name = called.noun.empty() ? called.name : called.noun;
    if (name.starts_with("iso_")) name.remove_prefix(4);
    return name;
  }
  return made.op == Opcode::load ? "word" : "value";
}

std::string ExpressionPrinter::name_value(ValueId value, const ir::Instruction& made) {
  const uint32_t names = function_.values[value].names;
  if (names != 0) return names_.take(function_.origins[names].node);
  const std::string_view noun = noun_of(made);
  if (made.origin == 0) return names_.take(noun);
  std::string wanted = function_.origins[made.origin].node;
  return names_.take(wanted.append("_").append(noun));
}

void ExpressionPrinter::print_doc(uint32_t origin) {
  if (const std::string& doc = function_.origins[origin].doc; !doc.empty())
    comment_lines(body_, doc, indent_);
}

void ExpressionPrinter::end_line(ValueId value) {
  const ir::Origin& from = function_.origins[function_.values[value].names];
  if (from.line != 0 && from.node != written_[value].text)
    body_.append("  // ").append(comment_text(from.node)).append(" :").append(std::to_string(from.line));
  body_ += "\n";
}

void ExpressionPrinter::set_name(ValueId value, std::string name) {
  Written& written = written_[value];
  written = {std::move(name)};
  written.columns = static_cast<int>(written.text.size());
}

const ir::Instruction* ExpressionPrinter::definition(ValueId value) const {
  const ir::InstructionId id = nesting_[value].made_by;
  return id == ir::none ? nullptr : &function_.instructions[id];
}

bool ExpressionPrinter::is_splat(ValueId value) const { return nesting_[value].shape == Shape::splat; }

ValueId ExpressionPrinter::splat_of(ValueId value) const {
  return function_.operands_of(*definition(value))[0];
}

ValueId ExpressionPrinter::behind(ValueId value) const { return is_splat(value) ? splat_of(value) : value; }

Operand ExpressionPrinter::operand(ValueId value) {
  if (is_splat(value)) write_splat(value, uniform_[value]);
  const Written& written = written_[value];
  const ir::Instruction* made = definition(value);
  return {written.text, function_.type(value), written.precedence, uniform_[value],
          made != nullptr && made->op == Opcode::constant};
}

void ExpressionPrinter::write_splat(ValueId value, bool uniform) {
  Written& written = written_[value];
  written.text.assign(language_.type(function_.type(value), uniform)).append("(");
  written.text.append(written_[splat_of(value)].text).append(")");
}

void ExpressionPrinter::put_exactly(std::string& out, ValueId value, bool uniform) {
  Operand written = operand(value);
  if (is_splat(value) && !uniform) {
    write_splat(value, false);
    written.text = written_[value].text;
    written.uniform = false;
  }
  language_.exactly(out, written, uniform);
}

void ExpressionPrinter::put(std::string& out, const Operand& operand, const Room& room) {
  if (room.holds(operand.precedence))
    out += operand.text;
  else
    out.append("(").append(operand.text).append(")");
}

void ExpressionPrinter::need_name(ValueId value) {
  const ValueId number = behind(value);
  if (!written_[number].pending) return;
  state(number, std::move(written_[number]));
}

bool ExpressionPrinter::is_exact(std::span<const ValueId> values) const {
  return std::ranges::any_of(values, [&](ValueId value) { return written_[behind(value)].exact; });
}

int ExpressionPrinter::columns_of(ValueId value) const {
  constexpr int around_splat = 6;
  return written_[behind(value)].columns + (is_splat(value) ? around_splat : 0);
}

int ExpressionPrinter::make_room(std::span<const ValueId> operands, int columns) {
  const int most = most_columns - static_cast<int>(indent_);
  for (const ValueId value : operands) columns += columns_of(value);
  // What a line can hold is little; a long list of arguments has names alone.
  while (columns > most) {
    ValueId longest = ir::none;
    for (const ValueId value : operands)
      if (written_[behind(value)].pending && columns_of(value) >= fewest_named &&
          (longest == ir::none || columns_of(value) > columns_of(longest)))
        longest = value;
    if (longest == ir::none) break;
    columns -= columns_of(longest);
    need_name(longest);
    columns += columns_of(longest);
    if (operands.size() > 16)
      for (const ValueId value : operands) need_name(value);
  }
  return columns;
}

void ExpressionPrinter::state(ValueId value, Written&& made) {
  const ir::Instruction& instruction = *definition(value);
  const ir::Origin& node = function_.origins[function_.values[value].names];
  const Declared declared{function_.type(value), uniform_[value], made.exact};
  std::string name = name_value(value, instruction);
  const int columns = static_cast<int>(name.size()) + made.columns + 5;
  const bool is_plain =
      node.line == 0 || (node.doc.empty() && name == node.node);  // nothing is to be said of it
  const bool is_short = is_plain && columns <= (node.line == 0 ? most_joined : most_joined_node);
  const bool joins = is_short && declared_end_ != 0 && body_.size() == declared_end_ &&
                     declared == declared_ &&
                     declared_columns_ + columns + static_cast<int>(indent_) <= most_columns + 16;
  if (joins) {
    body_.resize(body_.size() - 2);  // ";\n"
    body_ += ",";
  } else {
    print_doc(function_.values[value].names);
    language_.local_type(indent(), declared.type, declared.uniform, declared.exact);
    declared_columns_ = declared.type.is_float() || declared.exact ? 13 : 4;
  }
  body_.append(" ").append(name).append(" = ").append(made.text).append(";");
  spare_.swap(made.text);
  set_name(value, std::move(name));
  end_line(value);
  declared_ = declared;
  declared_columns_ += columns;
  declared_end_ = is_short ? body_.size() : 0;
}

Written ExpressionPrinter::begin() {
  Written made;
  made.text.swap(spare_);
  made.text.clear();
  made.text.reserve(64);
  return made;
}

void ExpressionPrinter::give_back(ValueId value) {
  if (Written& written = written_[value]; written.pending && spare_.empty()) spare_.swap(written.text);
}

void ExpressionPrinter::finish(ValueId value, Written&& made) {
  if (nesting_[value].has_statement) return state(value, std::move(made));
  made.pending = true;
  written_[value] = std::move(made);
}

void ExpressionPrinter::print_constant(const ir::Instruction& instruction) {
  const ir::Type type = function_.type(instruction.first_result);
  Written& written = written_[instruction.first_result];
  written.text = type == ir::int_type ? integer(instruction.imm) : language_.literal(type, instruction.imm);
  written.columns = literal_columns;
  if (written.text.starts_with('-')) written.precedence = Precedence::prefix;
}

void ExpressionPrinter::print_extract(const ir::Instruction& instruction) {
  const ValueId vector = function_.operands_of(instruction)[0];
  need_name(vector);
  std::string text(operand(vector).text);
  set_name(instruction.first_result, text.append(".").append(component_names[instruction.imm]));
}

void ExpressionPrinter::print_construct(const ir::Instruction& instruction) {
  const ValueId result = instruction.first_result;
  auto operands = function_.operands_of(instruction);
  if (is_splat(result)) return;
  if (nesting_[result].shape == Shape::words) return print_words(instruction);
  Written made = begin();
  made.columns = make_room(operands, 6 + 2 * static_cast<int>(operands.size()));
  made.exact = is_exact(operands);
  made.text.append(language_.type(function_.type(result), uniform_[result])).append("(");
  if (const auto whole = leading_vector(operands)) {
    made.text += operand(*whole).text;
    operands = operands.subspan(function_.type(*whole).width);
  }
  for (const ValueId value : operands) {
    separate(made.text);
    made.text += operand(value).text;
  }
  made.text += ")";
  finish(result, std::move(made));
}

std::optional<ValueId> ExpressionPrinter::leading_vector(std::span<const ValueId> operands) const {
  const ir::Instruction* first = definition(operands[0]);
  if (first == nullptr || first->op != Opcode::extract) return std::nullopt;
  const ValueId vector = function_.operands_of(*first)[0];
  const uint32_t width = function_.type(vector).width;
  if (width < 2 || width >= operands.size()) return std::nullopt;
  for (uint32_t i = 0; i < width; ++i) {
    const ir::Instruction* component = definition(operands[i]);
    if (component == nullptr || component->op != Opcode::extract || component->imm != i ||
        function_.operands_of(*component)[0] != vector)
      return std::nullopt;
  }
  return vector;
}

void ExpressionPrinter::print_load(const ir::Instruction& instruction) {
  const ValueId value = function_.operands_of(instruction)[0];
  const std::string& buffer = context_.module.buffers[instruction.imm].name;
  Written made = begin();
  const Index index =
      nesting_[value].shape == Shape::offset ? split_index(function_, nesting_, value) : Index{value, 0};
  const std::string text =
      print_index(instruction.imm, index, static_cast<int>(buffer.size()) + 2, made.columns);
  language_.load(made.text, buffer, text);
  finish(instruction.first_result, std::move(made));
}

void ExpressionPrinter::print_words(const ir::Instruction& instruction) {
  const auto operands = function_.operands_of(instruction);
  const ir::Instruction& load = *definition(operands[0]);
  const Index index = split_index(function_, nesting_, function_.operands_of(load)[0]);
  const std::string& reader = context_.readers[load.imm].take(operands.size());
  Written made = begin();
  const std::string text = print_index(load.imm, index, static_cast<int>(reader.size()) + 2, made.columns);
  made.text.append(reader).append("(").append(language_.outside());
  separate(made.text);
  made.text.append(text).append(")");
  finish(instruction.first_result, std::move(made));
}

std::string ExpressionPrinter::print_index(uint32_t buffer, const Index& index, int columns,
                                           int& all_columns) {
  std::string text;
  if (index.base != ir::none) {
    if (written_[index.base].exact) need_name(index.base);
    columns = make_room({&index.base, 1}, columns + 6);
    const Operand base = operand(index.base);
    const bool is_sum = index.constant != 0 || !context_.records[buffer].empty();
    put(text, base, {is_sum ? Precedence::sum : Precedence::choice, Precedence::sum});
  }
  const ir::Instruction* made = index.base == ir::none ? nullptr : definition(index.base);
  uint32_t constant = index.constant;
  const bool is_constant = made == nullptr ? index.base == ir::none : made->op == Opcode::constant;
  const bool is_record = context_.module.buffers[buffer].one_record
                             ? is_constant
                             : made == nullptr || made->op != Opcode::iadd;
  if (is_record) {
    const uint32_t word = made != nullptr && made->op == Opcode::constant ? made->imm : constant;
    if (const std::string* name = context_.records[buffer].take(word, constant)) {
      if (made != nullptr && made->op == Opcode::constant) text.clear();
      text.append(text.empty() ? "" : " + ").append(*name);
      columns += static_cast<int>(name->size()) + 3;
    }
  }
  if (constant != 0 || text.empty()) text.append(text.empty() ? "" : " + ").append(integer(constant));
  all_columns = columns;
  return text;
}

void ExpressionPrinter::print_primitive(const ir::Instruction& instruction) {
  const ValueId result = instruction.first_result;
  const auto operands = function_.operands_of(instruction);
  const OpShape& shape = op_shape(instruction.op);
  if (nesting_[result].shape == Shape::offset) need_name(operands[0]);
  if (shape.repeats)
    for (const ValueId value : operands) need_name(value);
  Written made = begin();
  made.columns = make_room(operands, shape.columns);
  made.exact = is_float_arithmetic(instruction.op) || is_exact(operands);
  if (shape.is_statement) return print_statement(instruction);
  const OpText& text = language_.op_text(instruction.op);
  made.precedence = text.precedence;
  fill(made.text, instruction, text);
  for (const ValueId value : operands) give_back(value);
  if (nesting_[result].shape == Shape::offset)
    written_[result] = std::move(made);
  else
    finish(result, std::move(made));
}

void ExpressionPrinter::print_statement(const ir::Instruction& instruction) {
  const ValueId result = instruction.first_result;
  const OpText& text = language_.op_text(instruction.op);
  const std::string name = name_value(result, instruction);
  temporaries_.clear();
  for (const std::string_view suffix : op_shape(instruction.op).suffixes)
    temporaries_.emplace_back(suffix, names_.take(name + std::string(suffix)));
  set_name(result, name);
  if (!text.is_statement) {
    language_.local_type(indent(), function_.type(result), uniform_[result], false);
    body_.append(" ").append(name).append(" = ");
  } else {
    indent();
  }
  fill(body_, instruction, text);
  if (!text.is_statement) body_ += ";";
  end_line(result);
}

void ExpressionPrinter::fill(std::string& out, const ir::Instruction& instruction, const OpText& text) {
  const ValueId result = instruction.first_result;
  const auto operands = function_.operands_of(instruction);
  // Of two vectors one may be a number: `color * 2.0`.
  bool may_be_number = ir::is_primitive(instruction.op) && ir::info(instruction.op).rule == ir::Rule::same &&
                       operands.size() == 2 && !(is_splat(operands[0]) && is_splat(operands[1]));
  for (const OpText::Piece& piece : text.pieces) {
    out += piece.before;
    if (piece.hole == OpText::result) {
      out += piece.suffix.empty() ? std::string_view(written_[result].text) : temporary(piece.suffix);
      continue;
    }
    const ValueId value = operands[static_cast<size_t>(piece.hole)];
    const Operand plain = operand(may_be_number ? behind(value) : value);
    const bool is_condition = instruction.op == Opcode::select && piece.hole == 0;
    if (piece.is_argument && !is_condition) {
      put_exactly(out, value, uniform_[result]);
    } else if (plain.literal && combines_bits(instruction.op)) {
      out += integer(definition(value)->imm, true);
    } else {
      put(out, plain, piece.room);
    }
  }
  out += text.end;
}

std::string_view ExpressionPrinter::temporary(std::string_view suffix) const {
  for (const auto& [of, name] : temporaries_)
    if (of == suffix) return name;
  support::bug("a text that declares what it has not");
}

}  // namespace isoshade::emit
