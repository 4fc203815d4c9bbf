// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/builder.h"

#include <bit>
#include <cmath>

#include "compiler/support/assert.h"

namespace isoshade::ir {

using support::assert_that;

std::optional<Type> result_type(Opcode op, std::span<const Type> operands) {
  if (is_derivative(op))
    return operands.size() == 1 && operands[0].is_float() ? std::optional(operands[0]) : std::nullopt;
  const OpInfo& row = info(op);
  if (operands.size() != static_cast<size_t>(row.arity)) return std::nullopt;
  const auto all = [&](Type type) {
    for (Type operand : operands)
      if (operand != type) return false;
    return true;
  };
  switch (row.rule) {
    case Rule::same:
      return operands[0].is_float() && all(operands[0]) ? std::optional(operands[0]) : std::nullopt;
    case Rule::compare: return all(float_type) ? std::optional(bool_type) : std::nullopt;
    case Rule::icompare: return all(int_type) ? std::optional(bool_type) : std::nullopt;
    case Rule::integer: return all(int_type) ? std::optional(int_type) : std::nullopt;
    case Rule::logic: return all(bool_type) ? std::optional(bool_type) : std::nullopt;
    case Rule::choose:
      return operands[0] == bool_type && operands[1] == operands[2] ? std::optional(operands[1])
                                                                    : std::nullopt;
    case Rule::to_int: return all(float_type) ? std::optional(int_type) : std::nullopt;
    case Rule::to_float: return all(int_type) ? std::optional(float_type) : std::nullopt;
  }
  return std::nullopt;
}

Builder::Builder(Module& module, uint32_t function) : module_(module), function_(function) {
  Function& f = this->function();
  assert_that(f.is_declaration(), "the function already has a body");
  // Most functions of the library have no more; a few allocations less for each.
  constexpr size_t usual = 32;
  f.values.reserve(f.parameters.size() + usual);
  f.instructions.reserve(usual);
  f.operands.reserve(2 * usual);
  if (!f.document.empty()) f.origins.reserve(usual);
  new_block();
  f.blocks[0].instructions.reserve(usual);
  f.blocks[0].parameters.reserve(f.parameters.size());
  for (const Parameter& parameter : f.parameters) f.blocks[0].parameters.push_back(new_value(parameter.type));
}

ValueId Builder::new_value(Type type) {
  function().values.push_back({type, 0});
  return static_cast<ValueId>(function().values.size() - 1);
}

BlockId Builder::new_block() {
  function().blocks.emplace_back();
  return static_cast<BlockId>(function().blocks.size() - 1);
}

InstructionId Builder::append(Opcode op, uint32_t imm, std::span<const ValueId> operands,
                              std::span<const Type> results) {
  Function& f = function();
  Instruction instruction;
  instruction.op = op;
  instruction.imm = imm;
  instruction.first_operand = static_cast<uint32_t>(f.operands.size());
  instruction.operand_count = static_cast<uint32_t>(operands.size());
  instruction.first_result = static_cast<ValueId>(f.values.size());
  instruction.result_count = static_cast<uint32_t>(results.size());
  instruction.origin = origin_;
  f.operands.insert(f.operands.end(), operands.begin(), operands.end());
  for (Type type : results) new_value(type);
  f.instructions.push_back(instruction);
  const auto id = static_cast<InstructionId>(f.instructions.size() - 1);
  f.blocks[block_].instructions.push_back(id);
  return id;
}

ValueId Builder::constant_bits(Type type, uint32_t bits) {
  const std::array results{type};
  return function().instructions[append(Opcode::constant, bits, {}, results)].first_result;
}

ValueId Builder::constant(float value) {
  uint32_t bits = std::bit_cast<uint32_t>(value);
  if ((bits & 0x7f800000u) == 0) bits &= 0x80000000u;
  if ((bits & 0x7fffffffu) > 0x7f800000u) bits = 0x7fc00000u;
  return constant_bits(float_type, bits);
}

ValueId Builder::constant(int32_t value) { return constant_bits(int_type, static_cast<uint32_t>(value)); }

ValueId Builder::constant(bool value) { return constant_bits(bool_type, value ? 1 : 0); }

ValueId Builder::op(Opcode op, std::span<const ValueId> operands) {
  assert_that(is_primitive(op) || is_derivative(op), "not a primitive op");
  std::array<Type, 3> types;
  assert_that(operands.size() <= types.size(), "too many operands");
  for (size_t i = 0; i < operands.size(); ++i) types[i] = type(operands[i]);
  const auto result = result_type(op, std::span(types).first(operands.size()));
  assert_that(result.has_value(), ir::name(op));
  const std::array results{*result};
  return function().instructions[append(op, 0, operands, results)].first_result;
}

ValueId Builder::construct(std::span<const ValueId> components) {
  if (components.size() == 1) return components[0];
  assert_that(components.size() >= 2 && components.size() <= 4, "a vector has 2 to 4 components");
  for (ValueId component : components) assert_that(type(component) == float_type, "components are floats");
  const std::array results{vector_type(static_cast<int>(components.size()))};
  return function().instructions[append(Opcode::construct, 0, components, results)].first_result;
}

ValueId Builder::extract(ValueId vector, uint32_t component) {
  assert_that(type(vector).is_float() && component < type(vector).width, "no such component");
  if (type(vector).width == 1) return vector;
  const std::array operands{vector};
  const std::array results{float_type};
  return function().instructions[append(Opcode::extract, component, operands, results)].first_result;
}

ValueId Builder::load(uint32_t buffer, ValueId index) {
  assert_that(type(index) == int_type, "an index is an int");
  const std::array operands{index};
  const std::array results{Type{module_.buffers[buffer].element, 1}};
  return function().instructions[append(Opcode::load, buffer, operands, results)].first_result;
}

namespace {
std::vector<ValueId> results_of(const Instruction& instruction) {
  std::vector<ValueId> values(instruction.result_count);
  for (uint32_t i = 0; i < instruction.result_count; ++i) values[i] = instruction.first_result + i;
  return values;
}
}  // namespace

std::vector<ValueId> Builder::call(uint32_t callee, std::span<const ValueId> arguments) {
  const Function& target = module_.functions[callee];
  assert_that(target.parameters.size() == arguments.size(), "wrong number of arguments");
  for (size_t i = 0; i < arguments.size(); ++i)
    assert_that(type(arguments[i]) == target.parameters[i].type, "wrong type of argument");
  std::vector<Type> results;
  for (const Result& result : target.results) results.push_back(result.type);
  return results_of(function().instructions[append(Opcode::call, callee, arguments, results)]);
}

BlockId Builder::enter() {
  assert_that(++depth_ <= max_block_depth, "blocks nest too deep");
  return block_;
}

void Builder::leave(BlockId outer) {
  --depth_;
  block_ = outer;
}

std::vector<ValueId> Builder::branch(ValueId condition, const Body& then, const Body& other) {
  assert_that(type(condition) == bool_type, "a condition is a bool");
  const BlockId outer = enter();
  const std::array<BlockId, 2> blocks{new_block(), new_block()};
  const std::array<const Body*, 2> bodies{&then, &other};
  for (int side = 0; side < 2; ++side) {
    block_ = blocks[side];
    std::vector<ValueId> yields = (*bodies[side])();
    function().blocks[blocks[side]].yields = std::move(yields);
  }
  leave(outer);
  const auto types_of = [&](BlockId block) {
    std::vector<Type> types;
    for (ValueId value : function().blocks[block].yields) types.push_back(type(value));
    return types;
  };
  const std::vector<Type> types = types_of(blocks[0]);
  assert_that(types == types_of(blocks[1]), "both sides yield the same types");
  const std::array operands{condition};
  Instruction& instruction = function().instructions[append(Opcode::branch, 0, operands, types)];
  instruction.blocks = blocks;
  return results_of(instruction);
}

std::vector<ValueId> Builder::loop(ValueId count, std::span<const ValueId> initial, const LoopBody& body) {
  assert_that(type(count) == int_type, "a count is an int");
  std::vector<Type> types;
  for (ValueId value : initial) types.push_back(type(value));
  const BlockId outer = enter();
  const BlockId inner = new_block();
  const ValueId index = new_value(int_type);
  std::vector<ValueId> carried;
  for (Type type : types) carried.push_back(new_value(type));
  function().blocks[inner].parameters.push_back(index);
  for (ValueId value : carried) function().blocks[inner].parameters.push_back(value);
  block_ = inner;
  std::vector<ValueId> yields = body(index, carried);
  leave(outer);
  assert_that(yields.size() == types.size(), "a loop yields what it carries");
  for (size_t i = 0; i < yields.size(); ++i)
    assert_that(type(yields[i]) == types[i], "a loop yields what it carries");
  function().blocks[inner].yields = std::move(yields);
  std::vector<ValueId> operands{count};
  operands.insert(operands.end(), initial.begin(), initial.end());
  Instruction& instruction = function().instructions[append(Opcode::loop, 0, operands, types)];
  instruction.blocks[0] = inner;
  return results_of(instruction);
}

void Builder::finish(std::span<const ValueId> results) {
  Function& f = function();
  assert_that(block_ == 0 && results.size() == f.results.size(), "wrong number of results");
  for (size_t i = 0; i < results.size(); ++i)
    assert_that(type(results[i]) == f.results[i].type, "wrong type of result");
  f.blocks[0].yields.assign(results.begin(), results.end());
}

uint32_t Builder::add_origin(std::string node, uint32_t line, std::string doc) {
  function().origins.push_back({std::move(node), line, std::move(doc)});
  return static_cast<uint32_t>(function().origins.size() - 1);
}

void Builder::name(ValueId value, uint32_t origin) { function().values[value].names = origin; }

}  // namespace isoshade::ir
