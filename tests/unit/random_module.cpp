// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/random_module.h"

#include "compiler/functions/library.h"
#include "compiler/ir/float_bits.h"

namespace isoshade::ir {

const std::vector<uint32_t>& special_floats() {
  static const std::vector<uint32_t> list{
      0x00000000, 0x80000000, 0x3f800000, 0xbf800000, 0x7f800000, 0xff800000, 0x7fc00000,
      0x00800000, 0x80800000, 0x7f7fffff, 0xff7fffff, 0x3f000000, 0x40000000, 0x3f800001,
      0x3f7fffff, 0x4b800000, 0x4b800001, 0x4effffff, 0xcf000000, 0x00ffffff, 0x1f800000,
      0x20000001, 0x40490fdb, 0x0d7ff800, 0x32800400, 0x3e99999a};
  return list;
}

const std::vector<uint32_t>& special_ints() {
  static const std::vector<uint32_t> list{
      0,          1,          0xffffffff, 2,          31,         32,         0x7fffffff, 0x80000000,
      0x80000001, 0x7fffff80, 0x7fffffbf, 0x7fffffc0, 0x00ffffff, 0x01000001, 0x01000003, 0xfeffffff,
      0x3f800000, 0x7fc00000, 0x7f800001, 0x007fffff, 0x80000005, 0x0000ffff, 0x00010000};
  return list;
}

uint32_t RandomModule::float_bits() {
  if (below(5) == 0) return below(2) == 0 ? 0 : sign_bit;
  if (below(4) != 0) return special_floats()[below(static_cast<uint32_t>(special_floats().size()))];
  return canonical_float(static_cast<uint32_t>(random_()));
}

uint32_t RandomModule::int_bits() {
  if (below(3) != 0) return special_ints()[below(static_cast<uint32_t>(special_ints().size()))];
  return static_cast<uint32_t>(random_()) >> below(32);
}

std::vector<uint32_t> RandomModule::words(const std::vector<Parameter>& parameters) {
  std::vector<uint32_t> words;
  for (const Parameter& p : parameters)
    for (int c = 0; c < p.type.width; ++c)
      words.push_back(p.type.is_float() ? float_bits() : p.type == int_type ? int_bits() : below(2));
  return words;
}

std::vector<uint32_t> RandomModule::buffer_words(size_t size) {
  std::vector<uint32_t> words;
  for (size_t i = 0; i < size; ++i) words.push_back(below(2) == 0 ? float_bits() : int_bits());
  return words;
}

Type RandomModule::any_type() {
  const Type types[] = {float_type, float_type,     float_type,     int_type,      int_type,
                        bool_type,  vector_type(2), vector_type(3), vector_type(4)};
  return types[below(9)];
}

ValueId RandomModule::constant(Builder& b, Type type) {
  if (type == bool_type) return b.constant(below(2) != 0);
  if (type == int_type) return b.constant_bits(int_type, int_bits());
  if (type.width == 1) return b.constant_bits(float_type, float_bits());
  const bool splat = below(2) == 0;
  std::vector<ValueId> components{constant(b, float_type)};
  while (components.size() < type.width)
    components.push_back(splat           ? components[0]
                         : below(3) == 0 ? pick(b, float_type)
                                         : constant(b, float_type));
  return b.construct(components);
}

// A value that is there, the newer the likelier, or a constant.
ValueId RandomModule::pick(Builder& b, Type type) {
  if (below(4) == 0) return constant(b, type);
  for (int attempt = 0; attempt < 12; ++attempt) {
    const auto size = static_cast<uint32_t>(visible_.size());
    const uint32_t back = below(2) == 0 ? below(size) : below(size < 8 ? size : 8);
    const ValueId value = visible_[size - 1 - back];
    if (b.type(value) == type) return value;
  }
  return constant(b, type);
}

// 0 to 3, from the first parameter, which is uniform, or known.
ValueId RandomModule::uniform_int(Builder& b) {
  if (below(2) == 0) return b.constant(static_cast<int32_t>(below(4)) - 1);
  return b.op(Opcode::iand, {b.parameter(0), b.constant(3)});
}

void RandomModule::add(Builder& b, ValueId value) {
  visible_.push_back(value);
  if (below(3) == 0) b.name(value, b.add_origin("n" + std::to_string(below(40)), below(100)));
}

std::vector<ValueId> RandomModule::block(Builder& b, const std::vector<Type>& types, int depth) {
  for (uint32_t n = 1 + below(5); n != 0; --n) step(b, depth + 1);
  std::vector<ValueId> yields;
  for (Type type : types) yields.push_back(pick(b, type));
  return yields;
}

void RandomModule::branch(Builder& b, int depth) {
  std::vector<Type> types;
  for (uint32_t n = 1 + below(3); n != 0; --n) types.push_back(any_type());
  const ValueId condition = pick(b, bool_type);
  const std::vector<ValueId> outer = visible_;
  const auto side = [&] {
    visible_ = outer;
    return block(b, types, depth);
  };
  const auto results = b.branch(condition, side, side);
  visible_ = outer;
  for (ValueId result : results) add(b, result);
}

void RandomModule::loop(Builder& b, int depth) {
  std::vector<Type> types;
  std::vector<ValueId> initial;
  for (uint32_t n = below(4); n != 0; --n) {
    types.push_back(any_type());
    initial.push_back(pick(b, types.back()));
  }
  const std::vector<ValueId> outer = visible_;
  const ValueId count = uniform_int(b);
  const auto results = b.loop(count, initial, [&](ValueId index, std::span<const ValueId> carried) {
    visible_.push_back(index);
    visible_.insert(visible_.end(), carried.begin(), carried.end());
    return block(b, types, depth);
  });
  visible_ = outer;
  for (ValueId result : results) add(b, result);
}

void RandomModule::call(Builder& b) {
  const Module& module = b.module();
  uint32_t callee = below(static_cast<uint32_t>(module.functions.size()));
  // Only earlier functions of ours, so that calls are acyclic.
  if (module.functions[callee].name == b.function().name || module.functions[callee].name[0] != 'f') return;
  std::vector<ValueId> arguments{uniform_int(b)};
  for (size_t i = 1; i < module.functions[callee].parameters.size(); ++i)
    arguments.push_back(pick(b, module.functions[callee].parameters[i].type));
  for (ValueId result : b.call(callee, arguments)) add(b, result);
}

void RandomModule::library_call(Builder& b) {
  const auto& variants = functions::variants();
  const functions::Variant& variant = variants[below(static_cast<uint32_t>(variants.size()))];
  std::vector<ValueId> arguments;
  for (Type type : variant.parameters) arguments.push_back(pick(b, type));
  for (ValueId result : functions::call_library(b, variant.row, arguments)) add(b, result);
}

// Arithmetic with a zero, or the same arithmetic twice with the operands in either order.
void RandomModule::known_shape(Builder& b) {
  const Opcode ops[] = {Opcode::fadd, Opcode::fsub, Opcode::fmul, Opcode::fdiv, Opcode::flt};
  const ValueId x = pick(b, float_type);
  if (below(2) == 0) {
    const ValueId zero = b.constant_bits(float_type, below(2) == 0 ? 0 : sign_bit);
    const Opcode op = ops[below(3)];
    return add(b, below(2) == 0 ? b.op(op, {x, zero}) : b.op(op, {zero, x}));
  }
  const ValueId y = pick(b, float_type);
  const Opcode op = ops[below(5)];
  add(b, b.op(op, {x, y}));
  add(b, below(2) == 0 ? b.op(op, {y, x}) : b.op(op, {x, y}));
}

void RandomModule::step(Builder& b, int depth) {
  b.set_origin(below(2) == 0 ? 0 : b.add_origin("n" + std::to_string(below(40)), below(100)));
  const uint32_t kind = below(100);
  if (kind < 5 && depth < 4) return branch(b, depth);
  if (kind < 9 && depth < 4) return loop(b, depth);
  if (kind < 13) return call(b);
  if (kind < 17 && options_.library_calls) return library_call(b);
  if (kind < 21 && options_.loads) return add(b, b.load(below(2), pick(b, int_type)));
  if (kind < 27) {
    const Type type = vector_type(2 + static_cast<int>(below(3)));
    return add(b, b.extract(pick(b, type), below(type.width)));
  }
  if (kind < 33) {
    std::vector<ValueId> components;
    const ValueId vector = pick(b, vector_type(2 + static_cast<int>(below(3))));
    for (uint32_t c = 0; c < b.type(vector).width; ++c)
      components.push_back(below(6) == 0 ? pick(b, float_type) : b.extract(vector, c));
    return add(b, b.construct(components));
  }
  if (kind < 42) return known_shape(b);
  if (kind < 45) {
    ValueId i = pick(b, int_type);
    if (options_.defined) i = b.op(Opcode::isar, {i, b.constant(1)});  // no rounding up to 2^31
    return add(b, b.op(Opcode::ftoi, {b.op(Opcode::itof, {i})}));
  }
  primitive(b);
}

void RandomModule::primitive(Builder& b) {
  const auto op = static_cast<Opcode>(below(primitive_count));
  const OpInfo& row = info(op);
  Type type =
      row.rule == Rule::same && below(3) == 0 ? vector_type(2 + static_cast<int>(below(3))) : float_type;
  if (row.rule == Rule::choose) type = any_type();
  std::vector<ValueId> operands;
  for (int i = 0; i < row.arity; ++i) {
    const bool ints = row.rule == Rule::integer || row.rule == Rule::icompare || row.rule == Rule::to_float;
    const bool truth = row.rule == Rule::logic || (row.rule == Rule::choose && i == 0);
    operands.push_back(i > 0 && below(10) == 0 && !(row.rule == Rule::choose && i == 1)
                           ? operands.back()
                           : pick(b, ints    ? int_type
                                     : truth ? bool_type
                                             : type));
  }
  if (options_.defined || below(2) == 0) operands.back() = harmless(b, row.precondition, operands.back());
  add(b, b.op(op, operands));
}

// The operand where the precondition holds, else another one. Those of shifts are about the last operand, the
// others about the only one.
ValueId RandomModule::harmless(Builder& b, Precondition precondition, ValueId operand) {
  switch (precondition) {
    case Precondition::none: return operand;
    case Precondition::finite_in_int_range: {
      const ValueId above = b.op(Opcode::fge, {operand, b.constant(-2147483648.0f)});
      const ValueId below = b.op(Opcode::flt, {operand, b.constant(2147483648.0f)});
      return b.op(Opcode::select, {b.op(Opcode::band, {above, below}), operand, b.constant(1.5f)});
    }
    case Precondition::not_nan:
      return b.op(Opcode::select, {b.op(Opcode::feq, {operand, operand}), operand, b.constant(2.5f)});
    case Precondition::not_denormal_bits: return b.op(Opcode::fbits, {b.op(Opcode::bitsf, {operand})});
    case Precondition::shift_amount: return b.op(Opcode::iand, {operand, b.constant(31)});
  }
  return operand;
}

void RandomModule::function(Module& module, const std::string& name, int size) {
  Function function;
  function.name = name;
  function.parameters.push_back({"count", int_type, "", true});
  for (uint32_t i = 0, n = 1 + below(5); i < n; ++i)
    function.parameters.push_back(
        {"p" + std::to_string(i), any_type(), i >= 3 ? "group_" + name : "", below(4) == 0 && i > 9});
  for (uint32_t i = 0, n = 1 + below(3); i < n; ++i)
    function.results.push_back({"r" + std::to_string(i), any_type()});
  module.functions.push_back(function);
  const auto index = static_cast<uint32_t>(module.functions.size() - 1);
  Builder b(module, index);
  visible_.clear();
  for (size_t i = 0; i < function.parameters.size(); ++i) visible_.push_back(b.parameter(i));
  for (int i = 0; i < size; ++i) step(b, 1);
  std::vector<ValueId> results;
  for (const Result& result : function.results) results.push_back(pick(b, result.type));
  b.finish(results);
}

void RandomModule::add_to(Module& module, const Options& options) {
  options_ = options;
  for (uint32_t i = 0, n = below(3); i < n; ++i)
    function(module, "f" + std::to_string(i), 3 + static_cast<int>(below(12)));
  function(module, "main", 5 + static_cast<int>(below(50)));
}

Module RandomModule::make(const Options& options) {
  Module module;
  module.buffers = {{"floats", Scalar::floating}, {"ints", Scalar::integer}};
  add_to(module, options);
  return module;
}

}  // namespace isoshade::ir
