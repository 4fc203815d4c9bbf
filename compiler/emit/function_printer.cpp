// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/function_printer.h"

#include "compiler/ir/uniformity.h"
#include "compiler/support/assert.h"

namespace isoshade::emit {

namespace {

constexpr std::string_view component_names[] = {"x", "y", "z", "w"};

class FunctionPrinter {
 public:
  FunctionPrinter(std::string& out, const ir::Module& module, const ir::Function& function,
                  const FunctionText& text, const Language& language, const std::vector<FunctionText>& texts,
                  const Names& globals)
      : out_(out),
        module_(module),
        function_(function),
        text_(text),
        language_(language),
        texts_(texts),
        names_(Scope::local, &globals, function.values.size()),
        values_(function.values.size()) {}

  void print() {
    find_used();
    language_.function_head(out_, function_, text_);
    declare_parameters();
    if (function_.is_declaration()) {
      out_ += ");  // yours to provide\n";
      return;
    }
    uniform_ = ir::uniform_values(function_);
    out_ += ") {\n";
    print_block(0);
    out_ += "  return ";
    print_returned();
    out_ += ";\n}\n";
  }

 private:
  std::string& indent() { return out_.append(indent_, ' '); }

  /// What stands before the next part of a list in parentheses.
  void separate() {
    if (out_.back() != '(') out_ += ", ";
  }

  /// Behind the statement that makes a node's value stands `// a :12`.
  void end_line(ir::ValueId value) {
    const uint32_t origin = function_.values[value].names;
    const ir::Origin& from = function_.origins[origin];
    if (from.line != 0)
      out_.append("  // ").append(comment_text(from.node)).append(" :").append(std::to_string(from.line));
    out_ += "\n";
  }

  void end_statement(ir::ValueId value) {
    out_ += ";";
    end_line(value);
  }

  std::string name_value(ir::ValueId value, uint32_t origin) {
    const uint32_t names = function_.values[value].names;
    if (names != 0) return names_.take(function_.origins[names].node);
    return names_.take(origin != 0 ? function_.origins[origin].node + "_t" : "t");
  }

  // Which values are used at all, and which only where an expression may stand: a sum as an index, a word
  // that is loaded for one vector. Nothing else is nested: one operator a statement is what keeps it exact.
  void find_used() {
    used_.assign(values_.size(), false);
    nested_.assign(values_.size(), true);
    std::vector<bool> once(values_.size(), false);
    for (const ir::Block& block : function_.blocks) {
      for (ir::InstructionId id : block.instructions) {
        const ir::Instruction& instruction = function_.instructions[id];
        for (ir::ValueId value : function_.operands_of(instruction)) {
          if (instruction.op == ir::Opcode::construct) nested_[value] = nested_[value] && !once[value];
          if (instruction.op == ir::Opcode::construct) once[value] = true;
          if (instruction.op != ir::Opcode::construct && instruction.op != ir::Opcode::load)
            nested_[value] = false;
          used_[value] = true;
        }
      }
      for (ir::ValueId value : block.yields) {
        used_[value] = true;
        nested_[value] = false;
      }
    }
  }

  void declare_parameters() {
    for (size_t i = 0; i < function_.parameters.size(); ++i) {
      const ir::Parameter& parameter = function_.parameters[i];
      std::string name;
      if (parameter.group.empty()) {
        name = names_.take(parameter.name);
        const bool used = !function_.is_declaration() && used_[function_.blocks[0].parameters[i]];
        separate();
        language_.parameter(out_, parameter.type, parameter.uniform, name, used);
      } else {
        if (i == 0 || function_.parameters[i - 1].group != parameter.group) {
          group_ = names_.take(parameter.group);
          separate();
          language_.group_type(out_, text_.groups[i], parameter.uniform);
          out_.append(" ").append(group_);
        }
        name = group_ + "." + text_.fields[i];
      }
      if (!function_.is_declaration()) values_[function_.blocks[0].parameters[i]] = name;
    }
  }

  Operand operand(ir::ValueId value) const {
    const bool literal = literals_.size() > value && literals_[value];
    return {values_[value], function_.type(value), uniform_[value], literal};
  }
  const std::string& text(ir::ValueId value) const { return values_[value]; }

  void print_returned() {
    const std::vector<ir::ValueId>& yields = function_.blocks[0].yields;
    if (yields.size() == 1) return language_.exactly(out_, operand(yields[0]), false);
    std::vector<Operand> fields;
    for (ir::ValueId value : yields) fields.push_back(operand(value));
    language_.make_record(out_, text_.result_type, false, fields);
  }

  void print_block(ir::BlockId block) {
    indent_ += 2;
    for (ir::InstructionId id : function_.blocks[block].instructions) print(function_.instructions[id]);
    indent_ -= 2;
  }

  /// `const F name = `; an expression and end_statement() follow.
  void begin_definition(const ir::Instruction& instruction) {
    const ir::ValueId value = instruction.first_result;
    values_[value] = name_value(value, instruction.origin);
    indent().append(language_.declared_type(function_.type(value), uniform_[value])).append(" ");
    out_.append(values_[value]).append(" = ");
  }

  void print(const ir::Instruction& instruction) {
    const auto operands = function_.operands_of(instruction);
    const ir::ValueId result = instruction.first_result;
    switch (instruction.op) {
      case ir::Opcode::constant:
        values_[result] = language_.literal(function_.type(result), instruction.imm);
        if (literals_.empty()) literals_.resize(values_.size());
        literals_[result] = true;
        return;
      case ir::Opcode::hidden_zero: values_[result] = hidden_zero; return;
      case ir::Opcode::extract:
        values_[result].append(text(operands[0])).append(".").append(component_names[instruction.imm]);
        return;
      case ir::Opcode::construct:
        begin_definition(instruction);
        out_.append(language_.type(function_.type(result), uniform_[result])).append("(");
        for (ir::ValueId value : operands) {
          separate();
          language_.exactly(out_, operand(value), uniform_[result]);
        }
        out_ += ")";
        return end_statement(result);
      case ir::Opcode::load: {
        const std::string& buffer = module_.buffers[instruction.imm].name;
        if (nested_[result]) return language_.load(values_[result], buffer, text(operands[0]));
        begin_definition(instruction);
        language_.load(out_, buffer, text(operands[0]));
        return end_statement(result);
      }
      case ir::Opcode::iadd:
        if (!nested_[result]) return print_primitive(instruction);
        values_[result].append(text(operands[0])).append(" + ").append(text(operands[1]));
        return;
      case ir::Opcode::call: return print_call(instruction);
      case ir::Opcode::branch: return print_branch(instruction);
      case ir::Opcode::loop: return print_loop(instruction);
      default: return print_primitive(instruction);
    }
  }

  /// Names for what the text of an op declares beside its result, `$=_low`. They are taken for all languages, so that
  /// what follows is called alike in each.
  void take_temporaries(const ir::OpInfo& row, ir::ValueId result) {
    temporaries_.clear();
    for (std::string_view rest : {row.glsl, row.cpp}) {
      for (size_t hole; (hole = rest.find("$=_")) != std::string_view::npos;) {
        rest.remove_prefix(hole + 2);
        const std::string_view suffix = suffix_of(rest);
        if (name_of(suffix).empty())
          temporaries_.push_back({suffix, names_.take(values_[result] + std::string(suffix))});
      }
    }
  }

  std::string_view name_of(std::string_view suffix) const {
    for (const auto& [of, name] : temporaries_)
      if (of == suffix) return name;
    return {};
  }

  /// The rest of the name that begins with `$=`.
  static std::string_view suffix_of(std::string_view text) {
    const size_t end = text.find_first_not_of("_abcdefghijklmnopqrstuvwxyz");
    return text.starts_with('_') ? text.substr(0, end) : std::string_view();
  }

  /// What stands in an op's text for `$=`, the result, or `$0`, an operand.
  void fill(char hole, const ir::Instruction& instruction, std::string_view pattern) {
    const ir::ValueId result = instruction.first_result;
    if (hole == '=') {
      out_ += values_[result];
      return;
    }
    const ir::ValueId value = function_.operands_of(instruction)[static_cast<size_t>(hole - '0')];
    if (instruction.op == ir::Opcode::select && hole == '0')
      out_ += text(value);
    else
      language_.argument(out_, operand(value), uniform_[result], pattern);
  }

  void print_primitive(const ir::Instruction& instruction) {
    const ir::ValueId result = instruction.first_result;
    const std::string_view pattern = language_.op_text(ir::info(instruction.op));
    const bool statement = pattern.starts_with(';');
    if (statement) {
      values_[result] = name_value(result, instruction.origin);
      indent();
    } else {
      begin_definition(instruction);
    }
    take_temporaries(ir::info(instruction.op), result);
    std::string_view rest = pattern.substr(statement ? 1 : 0);
    for (size_t hole; (hole = rest.find('$')) != std::string_view::npos;) {
      out_ += rest.substr(0, hole);
      const char what = rest[hole + 1];
      rest.remove_prefix(hole + 2);
      const std::string_view suffix = suffix_of(rest);
      suffix.empty() ? fill(what, instruction, pattern) : void(out_ += name_of(suffix));
      rest.remove_prefix(suffix.size());
    }
    out_ += rest;
    statement ? end_line(result) : end_statement(result);
  }

  /// `Surface surface; surface.a = x; surface.b = y;` for each group of a call; returns the names, at the first
  /// operand of each. Not constructed: where the call returns a struct, glslang 12 takes the arguments' fields
  /// for those of the result, and crashes on a constructor that has fewer.
  std::vector<std::string> print_groups(const ir::Instruction& instruction) {
    const std::vector<ir::Parameter>& parameters = module_.functions[instruction.imm].parameters;
    const FunctionText& called = texts_[instruction.imm];
    const auto operands = function_.operands_of(instruction);
    std::vector<std::string> names(operands.size());
    size_t first = 0;
    for (size_t i = 0; i < operands.size(); ++i) {
      const ir::Parameter& parameter = parameters[i];
      if (parameter.group.empty()) continue;
      if (i == 0 || parameter.group != parameters[i - 1].group) {
        first = i;
        names[i] = names_.take(parameter.group);
        language_.group_value(indent(), called.groups[i], parameter.uniform);
        out_.append(" ").append(names[i]).append(";\n");
      }
      indent().append(names[first]).append(".").append(called.fields[i]).append(" = ");
      language_.exactly(out_, operand(operands[i]), parameter.uniform);
      out_ += ";\n";
    }
    return names;
  }

  /// `f(a, b)`.
  void print_call_expression(const ir::Instruction& instruction, const std::vector<std::string>& groups) {
    const ir::Function& callee = module_.functions[instruction.imm];
    const FunctionText& called = texts_[instruction.imm];
    language_.callee(out_, called, uniform_[instruction.first_result]);
    out_ += called.loads && language_.passes_buffers() ? "(buffers" : "(";
    const auto operands = function_.operands_of(instruction);
    for (size_t i = 0; i < operands.size(); ++i) {
      const bool plain = callee.parameters[i].group.empty();
      if (!plain && groups[i].empty()) continue;  // another field of the same group
      separate();
      out_ += plain ? text(operands[i]) : groups[i];
    }
    out_ += ")";
  }

  void print_call(const ir::Instruction& instruction) {
    const FunctionText& called = texts_[instruction.imm];
    const ir::ValueId first = instruction.first_result;
    const std::vector<std::string> groups = print_groups(instruction);
    if (instruction.result_count == 1) {
      begin_definition(instruction);
    } else {
      const std::string name =
          names_.take(instruction.origin != 0 ? function_.origins[instruction.origin].node : "t");
      language_.result_record(indent(), called.result_type, uniform_[first]);
      out_.append(" ").append(name).append(" = ");
      for (uint32_t i = 0; i < instruction.result_count; ++i)
        values_[first + i] = name + "." + called.result_fields[i];
    }
    print_call_expression(instruction, groups);
    end_statement(first);
  }

  void declare_results(const ir::Instruction& instruction) {
    for (uint32_t i = 0; i < instruction.result_count; ++i) {
      const ir::ValueId value = instruction.first_result + i;
      values_[value] = name_value(value, instruction.origin);
    }
  }

  void print_branch(const ir::Instruction& instruction) {
    declare_results(instruction);
    for (uint32_t i = 0; i < instruction.result_count; ++i) {
      const ir::ValueId value = instruction.first_result + i;
      language_.variable(indent(), function_.type(value), uniform_[value], values_[value]);
      out_ += language_.no_value();
      end_statement(value);
    }
    const Operand condition = operand(function_.operands_of(instruction)[0]);
    for (int side = 0; side < 2; ++side) {
      language_.branch_head(indent(), condition.text, side == 1);
      out_ += "\n";
      const ir::BlockId block = instruction.blocks[side];
      print_block(block);
      indent_ += 2;
      for (uint32_t i = 0; i < instruction.result_count; ++i) {
        const ir::ValueId value = instruction.first_result + i;
        language_.branch_value(indent(), condition, values_[value],
                               operand(function_.blocks[block].yields[i]), uniform_[value], side == 1);
        out_ += "\n";
      }
      indent_ -= 2;
      indent() += "}\n";
    }
  }

  void print_loop(const ir::Instruction& instruction) {
    const auto operands = function_.operands_of(instruction);
    const ir::Block& body = function_.blocks[instruction.blocks[0]];
    support::assert_that(uniform_[operands[0]], "a loop's count is uniform");
    declare_results(instruction);
    for (uint32_t i = 0; i < instruction.result_count; ++i) {
      const ir::ValueId value = instruction.first_result + i;
      language_.variable(indent(), function_.type(value), uniform_[value], values_[value]);
      out_ += " = ";
      language_.exactly(out_, operand(operands[i + 1]), uniform_[value]);
      end_statement(value);
      values_[body.parameters[i + 1]] = values_[value];
    }
    const std::string index = names_.take("index");
    values_[body.parameters[0]] = index;
    indent().append("for (int ").append(index).append(" = 0; ").append(index).append(" < ");
    out_.append(text(operands[0])).append("; ++").append(index).append(") {\n");
    print_block(instruction.blocks[0]);
    indent_ += 2;
    // All at once: what one carried value becomes may be what another was.
    std::vector<std::string> next(instruction.result_count);
    for (uint32_t i = 0; i < instruction.result_count; ++i) {
      const ir::ValueId value = instruction.first_result + i;
      language_.exactly(next[i], operand(body.yields[i]), uniform_[value]);
      if (instruction.result_count == 1) continue;
      const std::string name = names_.take(values_[value] + "_next");
      indent().append(language_.declared_type(function_.type(value), uniform_[value])).append(" ");
      out_.append(name).append(" = ").append(next[i]).append(";\n");
      next[i] = name;
    }
    for (uint32_t i = 0; i < instruction.result_count; ++i)
      indent().append(values_[instruction.first_result + i]).append(" = ").append(next[i]).append(";\n");
    indent_ -= 2;
    indent() += "}\n";
  }

  std::string& out_;
  const ir::Module& module_;
  const ir::Function& function_;
  const FunctionText& text_;
  const Language& language_;
  const std::vector<FunctionText>& texts_;
  Names names_;
  std::vector<std::string> values_;  ///< how each value is written
  std::vector<bool> uniform_;
  std::vector<bool> literals_;
  std::vector<bool> used_;
  std::vector<bool> nested_;
  std::vector<std::pair<std::string_view, std::string>>
      temporaries_;  ///< of the op that is printed, by suffix
  std::string group_;
  size_t indent_ = 0;
};

}  // namespace

void print_function(std::string& out, const ir::Module& module, const ir::Function& function,
                    const FunctionText& text, const Language& language,
                    const std::vector<FunctionText>& texts, const Names& globals) {
  FunctionPrinter(out, module, function, text, language, texts, globals).print();
}

}  // namespace isoshade::emit
