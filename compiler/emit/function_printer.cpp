// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/function_printer.h"

#include <algorithm>

#include "compiler/emit/expression_printer.h"
#include "compiler/ir/uniformity.h"
#include "compiler/support/assert.h"

namespace isoshade::emit {

namespace {

using ir::Opcode;
using ir::ValueId;

class FunctionPrinter : private ExpressionPrinter {
 public:
  FunctionPrinter(std::string& out, const ir::Function& function, const FunctionText& text,
                  const TextContext& context)
      : ExpressionPrinter(function, context), out_(out), text_(text) {}

  bool print() {
    std::string parameters;
    if (function_.is_declaration()) {
      declare_parameters(parameters);
      language_.function_head(out_, function_, text_, false);
      out_.append(parameters).append(");  // yours to provide\n");
      return false;
    }
    nesting_ = find_nesting(function_);
    uniform_ = ir::uniform_values(function_);
    find_used();
    declare_parameters(parameters);
    print_block(0);
    std::string returned;
    const bool exact = print_returned(returned);
    language_.function_head(out_, function_, text_, exact);
    out_.append(parameters).append(") {");
    const bool is_line = body_.empty() && line_columns() <= 117;
    out_.append(is_line ? "" : "\n")
        .append(body_)
        .append(is_line ? " return " : "  return ")
        .append(returned);
    out_.append(is_line ? "; }" : ";");
    if (function_.results.size() == 1) name_returned(function_.blocks[0].yields[0]);
    out_ += is_line ? "\n" : "\n}\n";
    return is_line;
  }

  Names take_names() { return std::move(names_); }

 private:
  void find_used() {
    used_.assign(written_.size(), false);
    for (const ir::Instruction& instruction : function_.instructions)
      for (const ValueId value : function_.operands_of(instruction)) used_[value] = true;
    for (const ir::Block& block : function_.blocks)
      for (const ValueId value : block.yields) used_[value] = true;
  }

  void declare_parameters(std::string& out) {
    if (text_.has_signature) {
      for (const std::string& name : text_.local_names) names_.hold(name);
      for (size_t i = 0; i < function_.parameters.size(); ++i) place(i);
      out += text_.signature;
      if (text_.is_given_host && !language_.outside().empty() && !out.empty()) out.insert(0, ", ");
      return;
    }
    std::string group;
    for (size_t i = 0; i < function_.parameters.size(); ++i) {
      const ir::Parameter& parameter = function_.parameters[i];
      std::string name;
      if (i > 0 && (parameter.group.empty() || function_.parameters[i - 1].group != parameter.group) &&
          !out.empty())
        out += ", ";
      if (parameter.group.empty()) {
        name = names_.take(parameter.name);
        const bool used = !function_.is_declaration() && used_[function_.blocks[0].parameters[i]];
        language_.parameter(out, parameter.type, parameter.uniform, name, used);
      } else {
        if (i == 0 || function_.parameters[i - 1].group != parameter.group) {
          group = names_.take(parameter.group);
          language_.group_type(out, text_.groups[i], parameter.uniform);
          out.append(" ").append(group);
        }
        name = group + "." + text_.fields[i];
      }
      if (!function_.is_declaration()) set_name(function_.blocks[0].parameters[i], std::move(name));
    }
    if (text_.loads && !language_.outside().empty() && !out.empty()) out.insert(0, ", ");
  }

  /// A parameter that the signature does not declare.
  void place(size_t i) {
    const ParameterText& text = text_.parameters[i];
    const ValueId value = function_.blocks[0].parameters[i];
    if (!text.is_call) return set_name(value, text.text);
    if (!used_[value]) return;
    const ir::Parameter& parameter = function_.parameters[i];
    std::string name = names_.take(parameter.name);
    body_.append("  ");
    language_.local_type(body_, parameter.type, parameter.uniform, false);
    body_.append(" ").append(name).append(" = ").append(text.text).append(";\n");
    set_name(value, std::move(name));
  }

  /// About as long as the function would be in one line, in all languages alike.
  int line_columns() const {
    int columns = returned_columns_ + static_cast<int>(text_.name.size()) + 24;
    for (const ir::Parameter& parameter : function_.parameters)
      columns += static_cast<int>(parameter.name.size()) + 7;
    return columns;
  }

  /// Behind `return`, the node whose only statement it is.
  void name_returned(ValueId value) {
    const ir::Origin& node = function_.origins[function_.values[value].names];
    if (written_[value].pending && node.line != 0)
      out_.append("  // ").append(comment_text(node.node)).append(" :").append(std::to_string(node.line));
  }

  bool print_returned(std::string& out) {
    indent_ = 2;
    const std::vector<ValueId>& yields = function_.blocks[0].yields;
    returned_columns_ = make_room(yields, static_cast<int>(text_.result_type.size()));
    if (yields.size() == 1 && written_[yields[0]].pending) print_doc(function_.values[yields[0]].names);
    const bool exact = is_exact(yields);
    if (yields.size() == 1) {
      put_exactly(out, yields[0], false);
      return exact;
    }
    std::vector<Operand> fields;
    for (const ValueId value : yields) fields.push_back(operand(value));
    language_.make_record(out, text_.result_type, false, fields);
    return exact;
  }

  void print_block(ir::BlockId block) {
    indent_ += 2;
    for (const ir::InstructionId id : function_.blocks[block].instructions) print(function_.instructions[id]);
    indent_ -= 2;
  }

  void print(const ir::Instruction& instruction) {
    const ValueId result = instruction.first_result;
    if (instruction.result_count == 1 && !nesting_[result].is_used) return;
    switch (instruction.op) {
      case Opcode::constant: return print_constant(instruction);
      case Opcode::hidden_zero: return set_name(result, std::string(hidden_zero));
      case Opcode::extract: return print_extract(instruction);
      case Opcode::construct: return print_construct(instruction);
      case Opcode::load: return print_load(instruction);
      case Opcode::call: return print_call(instruction);
      case Opcode::branch: return print_branch(instruction);
      case Opcode::loop: return print_loop(instruction);
      case Opcode::ddx:
      case Opcode::ddy: support::bug("a derivative in what is printed");
#define OP(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
        return print_primitive(instruction);
    }
  }

  /// `Surface surface; surface.a = x; surface.b = y;` for each group of a call; returns the names, at the first
  /// operand of each. Not constructed: where the call returns a struct, glslang 12 takes the arguments' fields
  /// for those of the result, and crashes on a constructor that has fewer.
  std::vector<std::string> print_groups(const ir::Instruction& instruction) {
    const std::vector<ir::Parameter>& parameters = context_.module.functions[instruction.imm].parameters;
    const FunctionText& called = context_.texts[instruction.imm];
    const auto operands = function_.operands_of(instruction);
    const bool one_lane = uniform_[instruction.first_result];
    std::vector<std::string> names(operands.size());
    size_t first = 0;
    for (size_t i = 0; i < operands.size(); ++i) {
      const ir::Parameter& parameter = parameters[i];
      if (parameter.group.empty()) continue;
      if (i == 0 || parameter.group != parameters[i - 1].group) {
        first = i;
        names[i] = names_.take(parameter.group);
        language_.group_value(indent(), called.groups[i], parameter.uniform, one_lane);
        body_.append(" ").append(names[i]).append(";\n");
      }
      indent().append(names[first]).append(".").append(called.fields[i]).append(" = ");
      put_exactly(body_, operands[i], parameter.uniform || one_lane);
      body_ += ";\n";
    }
    return names;
  }

  void print_call(const ir::Instruction& instruction) {
    const ir::Function& callee = context_.module.functions[instruction.imm];
    const FunctionText& called = context_.texts[instruction.imm];
    const ValueId first = instruction.first_result;
    const auto operands = function_.operands_of(instruction);
    Written made = begin();
    made.exact = is_exact(operands);
    const std::vector<std::string> groups =
        std::ranges::any_of(called.groups, [](const std::string& group) { return !group.empty(); })
            ? print_groups(instruction)
            : std::vector<std::string>();
    std::vector<ValueId> plain;
    plain.reserve(operands.size());
    for (size_t i = 0; i < operands.size(); ++i)
      if (callee.parameters[i].group.empty()) plain.push_back(operands[i]);
    made.columns = make_room(plain, static_cast<int>(called.name.size() + 2 + 2 * plain.size()));
    language_.callee(made.text, called, uniform_[first]);
    made.text += "(";
    if (called.loads) made.text += language_.outside();
    if (!called.leading.empty()) {
      separate(made.text);
      made.text += called.leading;
    }
    int column = static_cast<int>(called.name.size() + indent_) + 1;
    for (size_t i = 0; i < operands.size(); ++i) {
      const bool is_plain = callee.parameters[i].group.empty();
      if (!is_plain && groups[i].empty()) continue;  // another field of the same group
      separate(made.text);
      const int columns = 2 + (is_plain ? columns_of(operands[i]) : static_cast<int>(groups[i].size()));
      column += columns;
      if (column > most_columns + 8 && columns < column) {
        if (made.text.back() == ' ') made.text.pop_back();
        made.text.append("\n").append(indent_ + 4, ' ');
        column = static_cast<int>(indent_) + 4 + columns;
      }
      made.text += is_plain ? operand(operands[i]).text : std::string_view(groups[i]);
    }
    made.text += ")";
    if (instruction.result_count == 1) return finish(first, std::move(made));
    print_doc(instruction.origin);
    const std::string name =
        names_.take(instruction.origin != 0 ? std::string_view(function_.origins[instruction.origin].node)
                                            : noun_of(instruction));
    language_.local_record(indent(), called.result_type, uniform_[first], made.exact);
    body_.append(" ").append(name).append(" = ").append(made.text).append(";\n");
    for (uint32_t i = 0; i < instruction.result_count; ++i)
      set_name(first + i, name + "." + called.result_fields[i]);
  }

  void declare_results(const ir::Instruction& instruction) {
    for (uint32_t i = 0; i < instruction.result_count; ++i) {
      const ValueId value = instruction.first_result + i;
      print_doc(function_.values[value].names);
      set_name(value, name_value(value, instruction));
    }
  }

  /// Makes a yield ready to be assigned to a variable. The declaration of an int or a bool promises no exactness.
  void prepare_assigned(ValueId value) {
    make_room({&value, 1}, 0);
    if (!function_.type(value).is_float() && written_[value].exact) need_name(value);
  }

  void print_branch(const ir::Instruction& instruction) {
    const ValueId condition = function_.operands_of(instruction)[0];
    need_name(condition);
    declare_results(instruction);
    for (uint32_t i = 0; i < instruction.result_count; ++i) {
      const ValueId value = instruction.first_result + i;
      language_.variable(indent(), function_.type(value), uniform_[value], written_[value].text);
      body_.append(language_.no_value()).append(";");
      end_line(value);
    }
    for (int side = 0; side < 2; ++side) {
      language_.branch_head(indent(), operand(condition), side == 1);
      body_ += "\n";
      const ir::BlockId block = instruction.blocks[static_cast<size_t>(side)];
      print_block(block);
      indent_ += 2;
      for (uint32_t i = 0; i < instruction.result_count; ++i) {
        const ValueId value = instruction.first_result + i, yield = function_.blocks[block].yields[i];
        prepare_assigned(yield);
        language_.branch_value(indent(), operand(condition), written_[value].text, operand(yield),
                               uniform_[value], side == 1);
        body_ += "\n";
      }
      indent_ -= 2;
      indent() += "}\n";
    }
  }

  void print_loop(const ir::Instruction& instruction) {
    const auto operands = function_.operands_of(instruction);
    const ir::Block& body = function_.blocks[instruction.blocks[0]];
    support::assert_that(uniform_[operands[0]], "a loop's count is uniform");
    need_name(operands[0]);
    for (const ValueId initial : operands.subspan(1)) prepare_assigned(initial);
    declare_results(instruction);
    for (uint32_t i = 0; i < instruction.result_count; ++i) {
      const ValueId value = instruction.first_result + i;
      language_.variable(indent(), function_.type(value), uniform_[value], written_[value].text);
      body_ += " = ";
      put_exactly(body_, operands[i + 1], uniform_[value]);
      body_ += ";";
      end_line(value);
      set_name(body.parameters[i + 1], written_[value].text);
    }
    const std::string index = names_.take("index");
    set_name(body.parameters[0], index);
    indent().append("for (int ").append(index).append(" = 0; ").append(index).append(" < ");
    body_.append(operand(operands[0]).text).append("; ++").append(index).append(") {\n");
    print_block(instruction.blocks[0]);
    indent_ += 2;
    // All at once: what one carried value becomes may be what another was.
    std::vector<std::string> next(instruction.result_count);
    for (uint32_t i = 0; i < instruction.result_count; ++i) {
      const ValueId value = instruction.first_result + i;
      prepare_assigned(body.yields[i]);
      put_exactly(next[i], body.yields[i], uniform_[value]);
      if (instruction.result_count == 1) continue;
      const std::string name = names_.take(written_[value].text + "_next");
      language_.local_type(indent(), function_.type(value), uniform_[value], false);
      body_.append(" ").append(name).append(" = ").append(next[i]).append(";\n");
      next[i] = name;
    }
    for (uint32_t i = 0; i < instruction.result_count; ++i)
      indent()
          .append(written_[instruction.first_result + i].text)
          .append(" = ")
          .append(next[i])
          .append(";\n");
    indent_ -= 2;
    indent() += "}\n";
  }

  std::string& out_;
  const FunctionText& text_;
  std::vector<bool> used_;  ///< by value
  int returned_columns_ = 0;
};

}  // namespace

bool print_function(std::string& out, const ir::Function& function, const FunctionText& text,
                    const TextContext& context, Names* locals) {
  FunctionPrinter printer(out, function, text, context);
  const bool is_line = printer.print();
  if (locals != nullptr) *locals = printer.take_names();
  return is_line;
}

}  // namespace isoshade::emit
