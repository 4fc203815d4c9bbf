// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/function_printer.h"

#include "compiler/ir/uniformity.h"
#include "compiler/support/check.h"

namespace isoshade::emit {

namespace {

constexpr std::string_view component_names[] = {"x", "y", "z", "w"};

class FunctionPrinter {
 public:
  FunctionPrinter(const ir::Module& module, const ir::Function& function, const FunctionText& text,
                  const Language& language, const std::vector<FunctionText>& texts, const Names& globals)
      : module_(module),
        function_(function),
        text_(text),
        language_(language),
        texts_(texts),
        names_(&globals, function.values.size()),
        values_(function.values.size()) {}

  std::string print() {
    find_used();
    const std::vector<std::string> parameters = declare_parameters();
    out_ = language_.function_head(function_, text_, parameters);
    if (function_.is_declaration()) return out_ + ";  // yours to provide\n";
    uniform_ = ir::uniform_values(function_);
    out_.reserve(80 * function_.instructions.size());
    out_ += " {\n";
    print_block(0);
    return out_ + "  return " + returned() + ";\n}\n";
  }

 private:
  void line(std::string_view text) { out_.append(indent_, ' ').append(text).append("\n"); }

  /// `// a :12` behind the statement that makes a node's value.
  std::string comment(ir::ValueId value) const {
    const uint32_t origin = function_.values[value].names;
    const ir::Origin& from = function_.origins[origin];
    if (from.line == 0) return "";
    return "  // " + comment_text(from.node) + " :" + std::to_string(from.line);
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

  std::vector<std::string> declare_parameters() {
    std::vector<std::string> declared;
    Names fields;
    for (size_t i = 0; i < function_.parameters.size(); ++i) {
      const ir::Parameter& parameter = function_.parameters[i];
      std::string name;
      if (parameter.group.empty()) {
        name = names_.take(parameter.name);
        const bool used = !function_.is_declaration() && used_[function_.blocks[0].parameters[i]];
        declared.push_back(language_.parameter(parameter.type, parameter.uniform, name, used));
      } else {
        if (i == 0 || function_.parameters[i - 1].group != parameter.group) {
          fields = Names();
          group_ = names_.take(parameter.group);
          declared.push_back(language_.group_type(record_name(parameter.group), parameter.uniform) + " " +
                             group_);
        }
        name = group_ + "." + fields.take(parameter.name);
      }
      if (!function_.is_declaration()) values_[function_.blocks[0].parameters[i]] = name;
    }
    return declared;
  }

  Operand operand(ir::ValueId value) const {
    const bool literal = literals_.size() > value && literals_[value];
    return {values_[value], function_.type(value), uniform_[value], literal};
  }
  const std::string& text(ir::ValueId value) const { return values_[value]; }

  std::string returned() const {
    const std::vector<ir::ValueId>& yields = function_.blocks[0].yields;
    if (yields.size() == 1) return language_.exactly(operand(yields[0]), false);
    std::vector<std::string> fields;
    for (ir::ValueId value : yields) fields.push_back(language_.exactly(operand(value), false));
    return language_.make_record(text_.result_type, false, fields);
  }

  void print_block(ir::BlockId block) {
    indent_ += 2;
    for (ir::InstructionId id : function_.blocks[block].instructions) print(function_.instructions[id]);
    indent_ -= 2;
  }

  /// `const F name = expression;`
  void define(const ir::Instruction& instruction, const std::string& expression) {
    const ir::ValueId value = instruction.first_result;
    values_[value] = name_value(value, instruction.origin);
    out_.append(indent_, ' ').append(language_.declared_type(function_.type(value), uniform_[value]));
    out_.append(" ").append(values_[value]).append(" = ").append(expression).append(";");
    out_.append(comment(value)).append("\n");
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
      case ir::Opcode::extract:
        values_[result] = text(operands[0]) + "." + std::string(component_names[instruction.imm]);
        return;
      case ir::Opcode::construct: {
        std::string components;
        for (ir::ValueId value : operands)
          components +=
              (components.empty() ? "" : ", ") + language_.exactly(operand(value), uniform_[result]);
        return define(instruction,
                      language_.type(function_.type(result), uniform_[result]) + "(" + components + ")");
      }
      case ir::Opcode::load: {
        const std::string word = language_.load(module_.buffers[instruction.imm].name, text(operands[0]));
        if (!nested_[result]) return define(instruction, word);
        values_[result] = word;
        return;
      }
      case ir::Opcode::iadd:
        if (!nested_[result]) return print_primitive(instruction);
        values_[result] = text(operands[0]) + " + " + text(operands[1]);
        return;
      case ir::Opcode::call: return print_call(instruction);
      case ir::Opcode::branch: return print_branch(instruction);
      case ir::Opcode::loop: return print_loop(instruction);
      default: return print_primitive(instruction);
    }
  }

  void print_primitive(const ir::Instruction& instruction) {
    const auto operands = function_.operands_of(instruction);
    const ir::ValueId result = instruction.first_result;
    const std::string_view pattern = language_.op_text(ir::info(instruction.op));
    const bool statement = pattern.starts_with(';');
    if (statement) values_[result] = name_value(result, instruction.origin);
    std::string filled;
    for (size_t i = statement ? 1 : 0; i < pattern.size(); ++i) {
      if (pattern[i] != '$') {
        filled += pattern[i];
      } else if (pattern[++i] == '=') {
        filled += values_[result];
      } else {
        const ir::ValueId value = operands[static_cast<size_t>(pattern[i] - '0')];
        const bool condition = instruction.op == ir::Opcode::select && pattern[i] == '0';
        filled += condition ? text(value) : language_.argument(operand(value), uniform_[result], pattern);
      }
    }
    if (statement) return line(filled + comment(result));
    define(instruction, filled);
  }

  void print_call(const ir::Instruction& instruction) {
    const ir::Function& callee = module_.functions[instruction.imm];
    const FunctionText& called = texts_[instruction.imm];
    const bool uniform = uniform_[instruction.first_result];
    std::vector<std::string> arguments;
    if (called.loads && language_.passes_buffers()) arguments.push_back("buffers");
    const auto operands = function_.operands_of(instruction);
    for (size_t i = 0; i < operands.size();) {
      const ir::Parameter& parameter = callee.parameters[i];
      if (parameter.group.empty()) {
        arguments.push_back(text(operands[i++]));
        continue;
      }
      std::vector<std::string> fields;
      for (; i < operands.size() && callee.parameters[i].group == parameter.group; ++i)
        fields.push_back(language_.exactly(operand(operands[i]), parameter.uniform));
      arguments.push_back(language_.make_record(record_name(parameter.group), parameter.uniform, fields));
    }
    std::string list;
    for (const std::string& argument : arguments) list += (list.empty() ? "" : ", ") + argument;
    const std::string expression = language_.callee(called, uniform) + "(" + list + ")";
    if (callee.results.size() == 1) return define(instruction, expression);
    const std::string name =
        names_.take(instruction.origin != 0 ? function_.origins[instruction.origin].node : "t");
    line(language_.result_type(callee, called, uniform) + " " + name + " = " + expression + ";" +
         comment(instruction.first_result));
    for (uint32_t i = 0; i < instruction.result_count; ++i)
      values_[instruction.first_result + i] = name + "." + called.result_fields[i];
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
      line(language_.variable(function_.type(value), uniform_[value], values_[value]) +
           std::string(language_.no_value()) + ";" + comment(value));
    }
    const Operand condition = operand(function_.operands_of(instruction)[0]);
    for (int side = 0; side < 2; ++side) {
      line(language_.branch_head(condition.text, side == 1));
      const ir::BlockId block = instruction.blocks[side];
      print_block(block);
      indent_ += 2;
      for (uint32_t i = 0; i < instruction.result_count; ++i) {
        const ir::ValueId value = instruction.first_result + i;
        line(language_.branch_value(condition, values_[value], operand(function_.blocks[block].yields[i]),
                                    uniform_[value], side == 1));
      }
      indent_ -= 2;
      line("}");
    }
  }

  void print_loop(const ir::Instruction& instruction) {
    const auto operands = function_.operands_of(instruction);
    const ir::Block& body = function_.blocks[instruction.blocks[0]];
    support::check(uniform_[operands[0]], "a loop's count is uniform");
    declare_results(instruction);
    for (uint32_t i = 0; i < instruction.result_count; ++i) {
      const ir::ValueId value = instruction.first_result + i;
      line(language_.variable(function_.type(value), uniform_[value], values_[value]) + " = " +
           language_.exactly(operand(operands[i + 1]), uniform_[value]) + ";" + comment(value));
      values_[body.parameters[i + 1]] = values_[value];
    }
    const std::string index = names_.take("index");
    values_[body.parameters[0]] = index;
    line("for (int " + index + " = 0; " + index + " < " + text(operands[0]) + "; ++" + index + ") {");
    print_block(instruction.blocks[0]);
    indent_ += 2;
    // All at once: what one carried value becomes may be what another was.
    std::vector<std::string> next(instruction.result_count);
    for (uint32_t i = 0; i < instruction.result_count; ++i) {
      const ir::ValueId value = instruction.first_result + i;
      next[i] = language_.exactly(operand(body.yields[i]), uniform_[value]);
      if (instruction.result_count == 1) continue;
      const std::string name = names_.take(values_[value] + "_next");
      line(language_.declared_type(function_.type(value), uniform_[value]) + " " + name + " = " + next[i] +
           ";");
      next[i] = name;
    }
    for (uint32_t i = 0; i < instruction.result_count; ++i)
      line(values_[instruction.first_result + i] + " = " + next[i] + ";");
    indent_ -= 2;
    line("}");
  }

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
  std::string group_;
  std::string out_;
  size_t indent_ = 0;
};

}  // namespace

std::string print_function(const ir::Module& module, const ir::Function& function, const FunctionText& text,
                           const Language& language, const std::vector<FunctionText>& texts,
                           const Names& globals) {
  return FunctionPrinter(module, function, text, language, texts, globals).print();
}

}  // namespace isoshade::emit
