// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/printer.h"

#include <array>
#include <bit>
#include <charconv>
#include <unordered_set>

namespace isoshade::ir {

namespace {

std::string quoted(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out = "\"";
  for (char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (byte < 0x20 || byte == 0x7f) {
      out += {'\\', 'x', digits[byte >> 4], digits[byte & 15]};
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string hex(uint32_t bits) {
  std::array<char, 8> digits;
  const auto end = std::to_chars(digits.begin(), digits.end(), bits, 16).ptr;
  const std::string text(digits.begin(), end);
  return "0x" + std::string(digits.size() - text.size(), '0') + text;
}

std::string full_name(const Parameter& parameter) {
  return parameter.group.empty() ? parameter.name : parameter.group + "." + parameter.name;
}

std::string type_suffix(Type type) { return type == float_type ? "" : ": " + std::string(name(type)); }

class Printer {
 public:
  Printer(const Module& module, const Function& function) : module_(module), f_(function) {
    names_.assign(f_.values.size(), "%?");
    if (!f_.is_declaration()) {
      for (size_t i = 0; i < f_.blocks[0].parameters.size(); ++i)
        define(f_.blocks[0].parameters[i], i < f_.parameters.size() ? full_name(f_.parameters[i]) : "");
      number(0);
    }
  }

  std::string function() {
    out_ = "func @" + f_.name + "(";
    for (size_t i = 0; i < f_.parameters.size(); ++i) {
      const Parameter& p = f_.parameters[i];
      if (i != 0) out_ += ", ";
      out_ += "%" + full_name(p) + ": " + std::string(name(p.type)) + (p.uniform ? " uniform" : "");
      if (p.least) out_ += " least " + hex(std::bit_cast<uint32_t>(*p.least));
      if (p.most) out_ += " most " + hex(std::bit_cast<uint32_t>(*p.most));
    }
    out_ += ") -> (";
    for (size_t i = 0; i < f_.results.size(); ++i)
      out_ += (i != 0 ? ", " : "") + f_.results[i].name + ": " + std::string(name(f_.results[i].type));
    out_ += ")";
    if (!f_.document.empty()) out_ += " from " + quoted(f_.document);
    if (!f_.library.empty()) out_ += " library " + quoted(f_.library);
    if (!f_.is_declaration()) {
      out_ += " {\n";
      block(0, 1, "return");
      out_ += "}";
    }
    out_ += "\n";
    return std::move(out_);
  }

  std::string instruction(InstructionId id) {
    head(f_.instructions[id]);
    return std::move(out_);
  }

 private:
  void define(ValueId value, const std::string& name) {
    std::string text = name.empty() ? std::to_string(count_) : name;
    if (!used_.insert(text).second) used_.insert(text += "." + std::to_string(count_));
    names_[value] = "%" + text;
    ++count_;
  }
  void define(ValueId value) { define(value, f_.origins[f_.values[value].names].node); }

  // Numbers come in the order of the text, whatever the values' own are.
  void number(BlockId block) {
    for (InstructionId id : f_.blocks[block].instructions) {
      const Instruction& instruction = f_.instructions[id];
      for (uint32_t i = 0; i < instruction.result_count; ++i) define(instruction.first_result + i);
      for (BlockId inner : instruction.blocks) {
        if (inner == none) continue;
        for (ValueId parameter : f_.blocks[inner].parameters) define(parameter);
        number(inner);
      }
    }
  }

  // What a value is called where it is defined, seen from an instruction of the given origin.
  std::string definition(ValueId value, uint32_t origin) const {
    const uint32_t names = f_.values[value].names;
    std::string text = names_[value];
    const Origin& node = f_.origins[names];
    if (names == 0 || node == f_.origins[origin]) return text;
    const bool default_origin = node.line == 0 && f_.origins[origin].node != node.node;
    return default_origin ? text : text + ":" + std::to_string(node.line);
  }

  void list(std::span<const ValueId> values) {
    for (size_t i = 0; i < values.size(); ++i) out_ += (i != 0 ? ", " : "") + names_[values[i]];
  }

  // Everything of an instruction's line but its origin.
  void head(const Instruction& instruction) {
    for (uint32_t i = 0; i < instruction.result_count; ++i) {
      const ValueId value = instruction.first_result + i;
      out_ += (i != 0 ? ", " : "") + definition(value, instruction.origin) + type_suffix(f_.type(value));
    }
    if (instruction.result_count != 0) out_ += " = ";
    out_ += name(instruction.op);
    if (instruction.op == Opcode::hidden_zero) return;
    out_ += ' ';
    const auto operands = f_.operands_of(instruction);
    switch (instruction.op) {
      case Opcode::constant: constant(f_.type(instruction.first_result), instruction.imm); break;
      case Opcode::extract:
        list(operands);
        out_ += ", " + std::to_string(instruction.imm);
        break;
      case Opcode::load:
        out_ += module_.buffers[instruction.imm].name + "[" + names_[operands[0]] + "]";
        break;
      case Opcode::call:
        out_ += "@" + module_.functions[instruction.imm].name + "(";
        list(operands);
        out_ += ")";
        break;
      case Opcode::loop: loop(instruction); break;
      case Opcode::construct:
      case Opcode::hidden_zero:
      case Opcode::branch:
      case Opcode::ddx:
      case Opcode::ddy:
#define OP(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
        list(operands);
    }
  }

  void loop(const Instruction& instruction) {
    const auto operands = f_.operands_of(instruction);
    const std::vector<ValueId>& parameters = f_.blocks[instruction.blocks[0]].parameters;
    out_ += definition(parameters[0], instruction.origin) + " < " + names_[operands[0]];
    for (size_t i = 1; i < operands.size(); ++i)
      out_ += ", " + definition(parameters[i], instruction.origin) + type_suffix(f_.type(parameters[i])) +
              " = " + names_[operands[i]];
  }

  void constant(Type type, uint32_t bits) {
    out_ += name(type);
    out_ += ' ';
    const auto value = static_cast<int32_t>(bits);
    if (type == bool_type) {
      out_ += bits != 0 ? "true" : "false";
    } else if (type == int_type) {
      out_ += std::to_string(value);
      if (value < -0xffff || value > 0xffff) comment_ = "  # " + hex(bits);
    } else {
      out_ += hex(bits);
      std::array<char, 32> decimal;
      const auto end = std::to_chars(decimal.begin(), decimal.end(), std::bit_cast<float>(bits)).ptr;
      comment_ = "  # " + std::string(decimal.begin(), end);
    }
  }

  void block(BlockId id, size_t depth, std::string_view last) {
    const std::string indent(2 * depth, ' ');
    for (InstructionId instruction_id : f_.blocks[id].instructions) {
      const Instruction& instruction = f_.instructions[instruction_id];
      out_ += indent;
      head(instruction);
      const bool has_blocks = instruction.blocks[0] != none;
      if (has_blocks) out_ += " {";
      if (instruction.origin != 0) {
        const Origin& origin = f_.origins[instruction.origin];
        out_ += "  ; " + origin.node + ":" + std::to_string(origin.line);
      }
      out_ += comment_ + "\n";
      comment_.clear();
      if (!has_blocks) continue;
      block(instruction.blocks[0], depth + 1, "yield");
      if (instruction.blocks[1] != none) {
        out_ += indent + "} else {\n";
        block(instruction.blocks[1], depth + 1, "yield");
      }
      out_ += indent + "}\n";
    }
    out_ += indent;
    out_ += last;
    out_ += f_.blocks[id].yields.empty() ? "" : " ";
    list(f_.blocks[id].yields);
    out_ += "\n";
  }

  const Module& module_;
  const Function& f_;
  std::string out_;
  std::string comment_;  ///< ends the line
  std::vector<std::string> names_;
  std::unordered_set<std::string> used_;
  uint32_t count_ = 0;
};

}  // namespace

std::string print(const Module& module, const Function& function) {
  return Printer(module, function).function();
}

std::string print_instruction(const Module& module, const Function& function, InstructionId instruction) {
  return Printer(module, function).instruction(instruction);
}

std::string print(const Module& module) {
  std::string text;
  for (const Buffer& buffer : module.buffers)
    text += "buffer " + buffer.name + ": " + std::string(name(Type{buffer.element, 1})) + "\n";
  for (const Function& function : module.functions) {
    if (!text.empty()) text += "\n";
    text += print(module, function);
  }
  return text;
}

}  // namespace isoshade::ir
