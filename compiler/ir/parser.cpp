// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/parser.h"

#include <algorithm>
#include <bit>
#include <map>
#include <unordered_map>
#include <utility>

#include "compiler/ir/builder.h"
#include "compiler/ir/reader.h"

namespace isoshade::ir {

namespace {

using FunctionIndex = std::unordered_map<std::string, uint32_t>;

// One function's body, from after its '{' to after its '}'.
class BodyParser : Reader {
 public:
  BodyParser(const std::vector<Token>& tokens, size_t position, std::string& error, const Module& module,
             const FunctionIndex& functions, Function& function)
      : Reader(tokens, position, error), module_(module), functions_(functions), f_(function) {}

  bool run() {
    f_.blocks.emplace_back();
    for (const Parameter& parameter : f_.parameters) {
      const ValueId value = add_value(parameter.type);
      f_.blocks[0].parameters.push_back(value);
      labels_[parameter.group.empty() ? parameter.name : parameter.group + "." + parameter.name] = value;
    }
    return block(0, 1, "return");
  }

 private:
  // A value where it is defined: `%name:line: type`.
  struct Definition {
    ValueId value = none;
    std::string name;  ///< of its node, empty if it has none
    std::optional<uint32_t> line;
    std::optional<Type> type;
  };

  ValueId add_value(Type type) {
    f_.values.push_back({type, 0});
    return static_cast<ValueId>(f_.values.size() - 1);
  }

  uint32_t origin(std::string node, uint32_t line) {
    const auto [it, added] = origins_.try_emplace({std::move(node), line}, f_.origins.size());
    if (added) f_.origins.push_back({it->first.first, line});
    return it->second;
  }

  bool definition(Definition& out) {
    std::string label;
    if (!take(Kind::value, label, "a value")) return false;
    if (label[0] < '0' || label[0] > '9') {
      out.name = label.substr(0, label.find('.'));
      const std::string_view suffix = std::string_view(label).substr(out.name.size());
      if (!is_identifier(out.name) || suffix == "." ||
          !std::all_of(suffix.begin() + !suffix.empty(), suffix.end(),
                       [](char c) { return c >= '0' && c <= '9'; }))
        return fail("no name for a value: %" + label);
    }
    out.value = add_value(float_type);
    if (!labels_.emplace(label, out.value).second) return fail("%" + label + " is defined twice");
    while (accept(Kind::mark, ":")) {
      if (at(Kind::number) && !out.line && !out.type && !out.name.empty()) {
        if (!take_number(out.line.emplace(), "a line")) return false;
      } else if (out.type || !take_type(out.type.emplace())) {
        return fail("expected a type");
      }
    }
    return true;
  }

  bool set_type(const Definition& definition, Type type) {
    f_.values[definition.value].type = type;
    return !definition.type || *definition.type == type ||
           fail("the value is a " + std::string(ir::name(type)) + ", not a " +
                std::string(ir::name(*definition.type)));
  }

  bool reference(ValueId& out) {
    if (!at(Kind::value)) return fail("expected a value");
    const auto found = labels_.find(peek().text);
    if (found == labels_.end()) return fail("%" + peek().text + " is not defined before");
    out = found->second;
    next();
    return true;
  }

  bool references(std::vector<ValueId>& out) {
    do {
      if (!reference(out.emplace_back())) return false;
    } while (accept(Kind::mark, ","));
    return true;
  }

  bool block(BlockId id, int depth, std::string_view last) {
    if (depth > max_block_depth) return fail("blocks nest too deep");
    while (!at(Kind::word, last))
      if (!instruction(id, depth)) return false;
    next();
    std::vector<ValueId> yields;
    if (at(Kind::value) && !references(yields)) return false;
    f_.blocks[id].yields = std::move(yields);
    return expect("}");
  }

  bool instruction(BlockId block, int depth) {
    std::vector<Definition> results;
    if (at(Kind::value)) {
      do {
        if (!definition(results.emplace_back())) return false;
      } while (accept(Kind::mark, ","));
      if (!expect("=")) return false;
    }
    const auto op = at(Kind::word) ? opcode_from_name(peek().text) : std::nullopt;
    if (!op) return fail("expected an instruction");
    next();
    Instruction made;
    made.op = *op;
    std::vector<ValueId> operands;
    std::vector<Type> types;
    std::vector<Definition> carried;
    if (!operands_of(made, operands, types, carried)) return false;
    const bool has_block = made.op == Opcode::branch || made.op == Opcode::loop;
    if (has_block && !expect("{")) return false;
    if (accept(Kind::mark, ";")) {
      std::string node;
      uint32_t line = 0;
      if (!take(Kind::word, node, "a node") || !expect(":") || !take_number(line, "a line")) return false;
      made.origin = origin(node, line);
    }
    if (made.op != Opcode::branch && types.size() != results.size())
      return fail("the instruction has " + std::to_string(types.size()) + " results");
    for (size_t i = 0; i < types.size(); ++i)
      if (!set_type(results[i], types[i])) return false;
    name(results, made.origin);
    name(carried, made.origin);

    made.first_operand = static_cast<uint32_t>(f_.operands.size());
    made.operand_count = static_cast<uint32_t>(operands.size());
    f_.operands.insert(f_.operands.end(), operands.begin(), operands.end());
    made.first_result = results.empty() ? static_cast<ValueId>(f_.values.size()) : results[0].value;
    made.result_count = static_cast<uint32_t>(results.size());
    const auto id = static_cast<InstructionId>(f_.instructions.size());
    f_.instructions.push_back(made);
    f_.blocks[block].instructions.push_back(id);
    if (made.op == Opcode::branch) return sides(id, results, depth);
    if (made.op == Opcode::loop) return body(id, carried, depth);
    return true;
  }

  void name(const std::vector<Definition>& definitions, uint32_t instruction_origin) {
    for (const Definition& d : definitions) {
      if (d.name.empty()) continue;
      const bool same = !d.line && f_.origins[instruction_origin].node == d.name;
      f_.values[d.value].names = same ? instruction_origin : origin(d.name, d.line.value_or(0));
    }
  }

  BlockId open_block(InstructionId instruction, int which) {
    const auto block = static_cast<BlockId>(f_.blocks.size());
    f_.blocks.emplace_back();
    f_.instructions[instruction].blocks[static_cast<size_t>(which)] = block;
    return block;
  }

  bool sides(InstructionId id, const std::vector<Definition>& results, int depth) {
    const BlockId then = open_block(id, 0);
    if (!block(then, depth + 1, "yield")) return false;
    if (!accept(Kind::word, "else")) return fail("expected 'else'");
    if (!expect("{") || !block(open_block(id, 1), depth + 1, "yield")) return false;
    const std::vector<ValueId>& yields = f_.blocks[then].yields;
    if (yields.size() != results.size())
      return fail("a side yields as many values as the branch has results");
    for (size_t i = 0; i < results.size(); ++i)
      if (!set_type(results[i], f_.type(yields[i]))) return false;
    return true;
  }

  bool body(InstructionId id, const std::vector<Definition>& parameters, int depth) {
    const BlockId inner = open_block(id, 0);
    for (const Definition& parameter : parameters) f_.blocks[inner].parameters.push_back(parameter.value);
    return block(inner, depth + 1, "yield");
  }

  // An instruction's operands, and its results' types except for a branch, whose sides tell them.
  bool operands_of(Instruction& made, std::vector<ValueId>& operands, std::vector<Type>& types,
                   std::vector<Definition>& carried) {
    switch (made.op) {
      case Opcode::constant: return constant(made.imm, types);
      case Opcode::construct:
        if (!references(operands)) return false;
        if (operands.size() < 2 || operands.size() > 4) return fail("a vector has 2 to 4 components");
        types = {vector_type(static_cast<int>(operands.size()))};
        return true;
      case Opcode::extract:
        types = {float_type};
        return reference(operands.emplace_back()) && expect(",") && take_number(made.imm, "a component");
      case Opcode::hidden_zero: types = {float_type}; return true;
      case Opcode::load: {
        std::string buffer;
        if (!take(Kind::word, buffer, "a buffer")) return false;
        made.imm = module_.find_buffer(buffer);
        if (made.imm == none) return fail("no buffer " + buffer);
        types = {{module_.buffers[made.imm].element, 1}};
        return expect("[") && reference(operands.emplace_back()) && expect("]");
      }
      case Opcode::call: return call(made.imm, operands, types);
      case Opcode::branch: return reference(operands.emplace_back());
      case Opcode::loop: return loop(operands, types, carried);
      case Opcode::ddx:
      case Opcode::ddy:
#define OP(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
        return by_rule(made.op, operands, types);
    }
    return false;
  }

  bool by_rule(Opcode op, std::vector<ValueId>& operands, std::vector<Type>& types) {
    if (!references(operands)) return false;
    std::vector<Type> given;
    for (ValueId operand : operands) given.push_back(f_.type(operand));
    const auto type = result_type(op, given);
    if (!type) return fail("the operands do not fit " + std::string(ir::name(op)));
    types = {*type};
    return true;
  }

  bool constant(uint32_t& imm, std::vector<Type>& types) {
    if (!take_type(types.emplace_back())) return false;
    if (types[0] == bool_type) {
      imm = at(Kind::word, "true");
      return accept(Kind::word, "true") || accept(Kind::word, "false") || fail("expected true or false");
    }
    if (types[0].width != 1) return fail("a constant is a scalar");
    if (types[0] == float_type)
      return (at(Kind::number) && peek().text.starts_with("0x")) ? take_number(imm, "bits")
                                                                 : fail("expected 0x...");
    int32_t value = 0;
    if (!take_number(value, "an int")) return false;
    imm = static_cast<uint32_t>(value);
    return true;
  }

  bool call(uint32_t& imm, std::vector<ValueId>& operands, std::vector<Type>& types) {
    std::string callee;
    if (!take(Kind::function, callee, "a function") || !expect("(")) return false;
    const auto found = functions_.find(callee);
    if (found == functions_.end()) return fail("no function @" + callee);
    imm = found->second;
    for (const Result& result : module_.functions[imm].results) types.push_back(result.type);
    if (!at(Kind::mark, ")") && !references(operands)) return false;
    return expect(")");
  }

  bool loop(std::vector<ValueId>& operands, std::vector<Type>& types, std::vector<Definition>& parameters) {
    if (!definition(parameters.emplace_back()) || !expect("<") || !reference(operands.emplace_back()))
      return false;
    if (!set_type(parameters[0], int_type)) return false;
    while (accept(Kind::mark, ",")) {
      if (!definition(parameters.emplace_back()) || !expect("=") || !reference(operands.emplace_back()))
        return false;
      types.push_back(f_.type(operands.back()));
      if (!set_type(parameters.back(), types.back())) return false;
    }
    return true;
  }

  const Module& module_;
  const FunctionIndex& functions_;
  Function& f_;
  std::unordered_map<std::string, ValueId> labels_;
  std::map<std::pair<std::string, uint32_t>, uint32_t> origins_;
};

// Buffers and functions; bodies are read once all functions' types are known.
class ModuleParser : Reader {
 public:
  ModuleParser(const std::vector<Token>& tokens, std::string& error) : Reader(tokens, 0, error) {}

  bool run(Module& module) {
    while (!at(Kind::end)) {
      if (!(accept(Kind::word, "buffer") ? buffer(module) : function(module))) return false;
    }
    for (uint32_t i = 0; i < module.functions.size(); ++i)
      if (bodies_[i] != 0 &&
          !BodyParser(tokens_, bodies_[i], error_, module, functions_, module.functions[i]).run())
        return false;
    return true;
  }

 private:
  bool buffer(Module& module) {
    Buffer made;
    Type type;
    if (!take(Kind::word, made.name, "a name") || !expect(":") || !take_type(type)) return false;
    if (module.find_buffer(made.name) != none) return fail("two buffers " + made.name);
    if (type != int_type && type != float_type) return fail("a buffer's elements are int or float");
    made.element = type.scalar;
    module.buffers.push_back(std::move(made));
    return true;
  }

  bool function(Module& module) {
    if (!accept(Kind::word, "func")) return fail("expected 'func' or 'buffer'");
    Function made;
    if (!take(Kind::function, made.name, "@name") || !parameters(made) || !results(made)) return false;
    if (accept(Kind::word, "from") && !take(Kind::string, made.document, "a path")) return false;
    if (accept(Kind::word, "library") && !take(Kind::string, made.library, "a function's name")) return false;
    if (!functions_.emplace(made.name, module.functions.size()).second)
      return fail("two functions @" + made.name);
    module.functions.push_back(std::move(made));
    bodies_.push_back(at(Kind::mark, "{") ? position_ + 1 : 0);
    return bodies_.back() == 0 || skip_body();
  }

  bool skip_body() {
    int depth = 0;
    do {
      if (at(Kind::end) || at(Kind::bad)) return fail("the body does not end");
      depth += at(Kind::mark, "{") - at(Kind::mark, "}");
      next();
    } while (depth != 0);
    return true;
  }

  bool take_float(std::optional<float>& value) {
    uint32_t bits = 0;
    if (!take_number(bits, "bits")) return false;
    value = std::bit_cast<float>(bits);
    return true;
  }

  bool parameters(Function& out) {
    if (!expect("(")) return false;
    std::unordered_map<std::string, bool> seen;
    while (!accept(Kind::mark, ")")) {
      if (!out.parameters.empty() && !expect(",")) return false;
      Parameter& p = out.parameters.emplace_back();
      if (!take(Kind::value, p.name, "a parameter") || !expect(":") || !take_type(p.type)) return false;
      if (!seen.emplace(p.name, true).second) return fail("two parameters %" + p.name);
      if (const size_t dot = p.name.find('.'); dot != std::string::npos) {
        p.group = p.name.substr(0, dot);
        p.name.erase(0, dot + 1);
      }
      p.uniform = accept(Kind::word, "uniform");
      if (accept(Kind::word, "least") && !take_float(p.least)) return false;
      if (accept(Kind::word, "most") && !take_float(p.most)) return false;
    }
    return true;
  }

  bool results(Function& out) {
    if (!expect("->") || !expect("(")) return false;
    while (!accept(Kind::mark, ")")) {
      if (!out.results.empty() && !expect(",")) return false;
      Result& result = out.results.emplace_back();
      if (!take(Kind::word, result.name, "a result") || !expect(":") || !take_type(result.type)) return false;
    }
    return true;
  }

  FunctionIndex functions_;
  std::vector<size_t> bodies_;  ///< by function: the token after its '{', or 0
};

}  // namespace

std::optional<Module> parse(std::string_view text, std::string& error) {
  error.clear();
  const std::vector<Token> tokens = tokenise(text);
  Module module;
  if (!ModuleParser(tokens, error).run(module)) return std::nullopt;
  return module;
}

}  // namespace isoshade::ir
