// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/validator.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <unordered_set>
#include <utility>

#include "compiler/ir/builder.h"
#include "compiler/ir/call_graph.h"
#include "compiler/ir/float_bits.h"
#include "compiler/ir/lexer.h"
#include "compiler/ir/uniformity.h"

namespace isoshade::ir {

namespace {

bool is_type(Type type) {
  return type.scalar == Scalar::floating ? type.width >= 1 && type.width <= 4
                                         : type == bool_type || type == int_type;
}

// The signature of a function; its types are what calls are checked against, so all are checked before any
// body.
std::string check_signature(const Function& f) {
  if (!is_identifier(f.name)) return "its name is not an identifier";
  std::set<std::pair<std::string_view, std::string_view>> names;
  std::unordered_set<std::string_view> groups, plain;
  std::string_view group;
  for (const Parameter& p : f.parameters) {
    const std::string which = "parameter " + p.name + ": ";
    if (!is_identifier(p.name)) return which + "its name is not an identifier";
    if (!p.group.empty() && !is_identifier(p.group)) return which + "its group's name is not an identifier";
    if (!is_type(p.type)) return which + "no such type";
    if (!names.emplace(p.group, p.name).second) return which + "there are two of this name";
    if (p.group.empty()) plain.insert(p.name);
    if (p.group != group && !p.group.empty() && !groups.insert(p.group).second)
      return which + "its group is not consecutive";
    group = p.group;
  }
  for (std::string_view name : groups)
    if (plain.contains(name)) return "a group and a parameter are both called " + std::string(name);
  std::unordered_set<std::string_view> results;
  for (const Result& r : f.results) {
    if (!is_identifier(r.name)) return "result " + r.name + ": its name is not an identifier";
    if (!is_type(r.type)) return "result " + r.name + ": no such type";
    if (!results.insert(r.name).second) return "two results are called " + r.name;
  }
  if (f.origins.empty() || f.origins[0] != Origin{}) return "origin 0 is not nowhere";
  for (size_t i = 1; i < f.origins.size(); ++i)
    if (!is_identifier(f.origins[i].node))
      return "the node of origin " + std::to_string(i) + " is not an identifier";
  return {};
}

class BodyValidator {
 public:
  BodyValidator(const Module& module, const Function& function)
      : module_(module),
        f_(function),
        visible_(f_.values.size(), false),
        defined_(f_.values.size(), false),
        listed_(f_.instructions.size(), false),
        entered_(f_.blocks.size(), false) {}

  std::string run() {
    std::vector<Type> parameters, results;
    for (const Parameter& p : f_.parameters) parameters.push_back(p.type);
    for (const Result& r : f_.results) results.push_back(r.type);
    for (size_t i = 0; i < f_.values.size(); ++i)
      if (f_.values[i].names >= f_.origins.size()) return "value " + std::to_string(i) + " names no origin";
    if (std::string e = block(0, parameters, results, 1); !e.empty()) return e;
    return uniformity();
  }

 private:
  // Whether it was marked already.
  static bool mark(std::vector<bool>& marks, uint32_t index) {
    const bool before = marks[index];
    marks[index] = true;
    return before;
  }

  std::string define(ValueId value, Type type, const char* what) {
    if (value >= f_.values.size()) return std::string(what) + " is no value";
    if (mark(defined_, value)) return std::string(what) + " is already defined";
    if (f_.type(value) != type) return std::string(what) + " has the wrong type";
    visible_[value] = true;
    scope_.push_back(value);
    return {};
  }

  bool is_visible(ValueId value) const { return value < visible_.size() && visible_[value]; }

  std::string block(BlockId id, std::span<const Type> parameters, std::span<const Type> yields, int depth) {
    if (depth > max_block_depth) return "blocks nest too deep";
    if (id >= f_.blocks.size()) return "no such block";
    if (mark(entered_, id)) return "a block has two places";
    const Block& block = f_.blocks[id];
    const size_t outer = scope_.size();
    if (block.parameters.size() != parameters.size()) return "a block has the wrong number of parameters";
    for (size_t i = 0; i < parameters.size(); ++i)
      if (std::string e = define(block.parameters[i], parameters[i], "a block's parameter"); !e.empty())
        return e;
    for (InstructionId instruction : block.instructions) {
      if (instruction >= f_.instructions.size()) return "no such instruction";
      if (mark(listed_, instruction)) return "an instruction has two places";
      if (std::string e = this->instruction(f_.instructions[instruction], depth); !e.empty())
        return "instruction " + std::to_string(instruction) + " (" +
               std::string(known(f_.instructions[instruction].op) ? name(f_.instructions[instruction].op)
                                                                  : "?") +
               "): " + e;
    }
    if (block.yields.size() != yields.size()) return "a block yields the wrong number of values";
    for (size_t i = 0; i < yields.size(); ++i) {
      if (!is_visible(block.yields[i])) return "a yielded value is not visible";
      if (f_.type(block.yields[i]) != yields[i]) return "a yielded value has the wrong type";
    }
    for (; scope_.size() > outer; scope_.pop_back()) visible_[scope_.back()] = false;
    return {};
  }

  static bool known(Opcode op) { return op <= Opcode::ddy; }

  std::string instruction(const Instruction& made, int depth) {
    if (!known(made.op)) return "no such op";
    if (made.origin >= f_.origins.size()) return "its origin does not exist";
    if (made.operand_count > f_.operands.size() ||
        made.first_operand > f_.operands.size() - made.operand_count)
      return "its operands are out of range";
    if (made.result_count > f_.values.size()) return "its results are out of range";
    std::vector<Type> operands, results;
    for (ValueId operand : f_.operands_of(made)) {
      if (!is_visible(operand)) return "operand " + std::to_string(operands.size()) + " is not visible";
      operands.push_back(f_.type(operand));
    }
    for (auto i = static_cast<size_t>(block_count(made.op)); i < made.blocks.size(); ++i)
      if (made.blocks[i] != none) return "it has a block too many";
    if (std::string e = types(made, operands, results, depth); !e.empty()) return e;
    if (results.size() != made.result_count) return "it has the wrong number of results";
    for (uint32_t i = 0; i < made.result_count; ++i)
      if (std::string e = define(made.first_result + i, results[i], "its result"); !e.empty()) return e;
    return {};
  }

  // Fills in the types that the results must have; validates the blocks inside.
  std::string types(const Instruction& made, std::span<const Type> operands, std::vector<Type>& results,
                    int depth) {
    if (immediate(made.op) == Immediate::none && made.imm != 0) return "it takes no immediate";
    switch (made.op) {
      case Opcode::constant: return constant(made, operands, results);
      case Opcode::construct:
        if (operands.size() < 2 || operands.size() > 4) return "a vector has 2 to 4 components";
        for (Type type : operands)
          if (type != float_type) return "components are floats";
        results = {vector_type(static_cast<int>(operands.size()))};
        return {};
      case Opcode::extract:
        if (operands.size() != 1 || operands[0].width < 2) return "it takes a vector";
        if (made.imm >= operands[0].width) return "no such component";
        results = {float_type};
        return {};
      case Opcode::hidden_zero:
        if (!operands.empty()) return "it takes no operand";
        results = {float_type};
        return {};
      case Opcode::load:
        if (operands.size() != 1 || operands[0] != int_type) return "it takes an int";
        if (made.imm >= module_.buffers.size()) return "no such buffer";
        results = {{module_.buffers[made.imm].element, 1}};
        return {};
      case Opcode::call: return call(made, operands, results);
      case Opcode::branch: return branch(made, operands, results, depth);
      case Opcode::loop: return loop(made, operands, results, depth);
      case Opcode::ddx:
      case Opcode::ddy:
#define OP(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
        if (const auto type = result_type(made.op, operands)) {
          results = {*type};
          return {};
        }
        return "its operands do not fit its rule";
    }
    return "it is no op";
  }

  std::string constant(const Instruction& made, std::span<const Type> operands, std::vector<Type>& results) {
    if (!operands.empty()) return "it takes no operand";
    if (made.first_result >= f_.values.size()) return "its result is no value";
    const Type type = f_.type(made.first_result);
    if (!is_type(type) || type.width != 1) return "a constant is a scalar";
    if (type == bool_type && made.imm > 1) return "a bool is 0 or 1";
    if (type == float_type && made.imm != canonical_float(made.imm))
      return is_nan(made.imm) ? "NaN is 0x7fc00000" : "a float is never denormal";
    results = {type};
    return {};
  }

  std::string call(const Instruction& made, std::span<const Type> operands, std::vector<Type>& results) {
    if (made.imm >= module_.functions.size()) return "no such function";
    const Function& callee = module_.functions[made.imm];
    const auto fits = [](const Parameter& p, Type type) { return p.type == type; };
    if (!std::equal(callee.parameters.begin(), callee.parameters.end(), operands.begin(), operands.end(),
                    fits))
      return "the arguments do not fit " + callee.name;
    for (const Result& result : callee.results) results.push_back(result.type);
    return {};
  }

  std::string branch(const Instruction& made, std::span<const Type> operands, std::vector<Type>& results,
                     int depth) {
    if (operands.size() != 1 || operands[0] != bool_type) return "it takes a bool";
    for (uint32_t i = 0; i < made.result_count; ++i) {
      if (made.first_result + i >= f_.values.size()) return "its result is no value";
      results.push_back(f_.type(made.first_result + i));
      if (!is_type(results.back())) return "its result has no type";
    }
    for (BlockId side : made.blocks)
      if (std::string e = block(side, {}, results, depth + 1); !e.empty()) return e;
    return {};
  }

  std::string loop(const Instruction& made, std::span<const Type> operands, std::vector<Type>& results,
                   int depth) {
    if (operands.empty() || operands[0] != int_type) return "it takes an int count";
    const std::vector<Type> parameters(operands.begin(),
                                       operands.end());  // an int index, then the carried values
    results.assign(operands.begin() + 1, operands.end());
    return block(made.blocks[0], parameters, results, depth + 1);
  }

  std::string uniformity() const {
    const std::vector<bool> uniform = uniform_values(f_);
    for (uint32_t i = 0; i < f_.instructions.size(); ++i) {
      const Instruction& made = f_.instructions[i];
      if (!listed_[i]) continue;
      const auto operands = f_.operands_of(made);
      if (made.op == Opcode::loop && !uniform[operands[0]])
        return "instruction " + std::to_string(i) + " (loop): its count is not uniform";
      if (made.op != Opcode::call) continue;
      const Function& callee = module_.functions[made.imm];
      for (size_t k = 0; k < operands.size(); ++k)
        if (callee.parameters[k].uniform && !uniform[operands[k]])
          return "instruction " + std::to_string(i) + " (call): " + callee.parameters[k].name + " of " +
                 callee.name + " is uniform, the argument is not";
    }
    return {};
  }

  const Module& module_;
  const Function& f_;
  std::vector<bool> visible_, defined_;  ///< by value
  std::vector<bool> listed_;             ///< by instruction
  std::vector<bool> entered_;            ///< by block
  std::vector<ValueId> scope_;           ///< what is visible, in the order it became so
};

}  // namespace

std::string validate(const Module& module) {
  std::unordered_set<std::string_view> buffers, functions;
  for (const Buffer& buffer : module.buffers) {
    if (!is_identifier(buffer.name)) return "buffer " + buffer.name + ": its name is not an identifier";
    if (!buffers.insert(buffer.name).second) return "two buffers are called " + buffer.name;
    if (buffer.element != Scalar::floating && buffer.element != Scalar::integer)
      return "buffer " + buffer.name + ": its elements are neither int nor float";
  }
  const auto in = [](const Function& f, const std::string& e) { return "function " + f.name + ": " + e; };
  for (const Function& f : module.functions) {
    if (std::string e = check_signature(f); !e.empty()) return in(f, e);
    if (!functions.insert(f.name).second) return "two functions are called " + f.name;
  }
  for (const Function& f : module.functions) {
    if (f.is_declaration()) continue;
    if (std::string e = BodyValidator(module, f).run(); !e.empty()) return in(f, e);
  }
  std::vector<uint32_t> all(module.functions.size());
  std::iota(all.begin(), all.end(), 0);
  if (!callees_first(module, all)) return "a function calls itself";
  return {};
}

}  // namespace isoshade::ir
