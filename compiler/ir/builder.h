// SPDX-License-Identifier: Apache-2.0
// Builds functions instruction by instruction. Misuse (wrong types, a value out of scope) is a bug and aborts.
#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::ir {

class Builder {
 public:
  /// Builds `function`, which must have its parameters and results declared and no body yet.
  Builder(Module& module, uint32_t function);

  Module& module() { return module_; }
  Function& function() { return module_.functions[function_]; }
  Type type(ValueId value) { return function().type(value); }

  ValueId parameter(size_t index) { return function().blocks[0].parameters[index]; }

  ValueId constant(float value);  ///< denormals are flushed, NaN made canonical
  ValueId constant(int32_t value);
  ValueId constant(bool value);
  ValueId constant_bits(Type type, uint32_t bits);

  /// A primitive op, ddx or ddy; checks arity and the row's type rule.
  ValueId op(Opcode op, std::span<const ValueId> operands);
  ValueId op(Opcode o, std::initializer_list<ValueId> operands) { return op(o, std::span(operands)); }

  ValueId construct(std::span<const ValueId> components);
  ValueId extract(ValueId vector, uint32_t component);  ///< a scalar's component 0 is itself
  ValueId load(uint32_t buffer, ValueId index);
  std::vector<ValueId> call(uint32_t callee, std::span<const ValueId> arguments);

  using Body = std::function<std::vector<ValueId>()>;
  using LoopBody = std::function<std::vector<ValueId>(ValueId index, std::span<const ValueId> carried)>;
  /// Runs `then` or `other`; both yield values of the same types, which are returned.
  std::vector<ValueId> branch(ValueId condition, const Body& then, const Body& other);
  /// Runs `body` for index 0 .. count-1. `count` is uniform.
  std::vector<ValueId> loop(ValueId count, std::span<const ValueId> initial, const LoopBody& body);

  /// Ends the function. Types must be the declared results'.
  void finish(std::span<const ValueId> results);

  /// Instructions made from here on come from this origin (an index into the function's origins).
  void set_origin(uint32_t origin) { origin_ = origin; }
  uint32_t add_origin(std::string node, uint32_t line, std::string doc = {});
  /// Gives `value` the name of the origin's node.
  void name(ValueId value, uint32_t origin);

 private:
  ValueId new_value(Type type);
  InstructionId append(Opcode op, uint32_t imm, std::span<const ValueId> operands,
                       std::span<const Type> results);
  BlockId new_block();
  /// Begins and ends the blocks of a branch or loop; `enter` returns the block around them.
  BlockId enter();
  void leave(BlockId outer);

  Module& module_;
  uint32_t function_;
  BlockId block_ = 0;
  int depth_ = 1;  ///< of the block
  uint32_t origin_ = 0;
};

/// The result type of a primitive op, ddx or ddy, or nothing if the operands do not fit its rule.
std::optional<Type> result_type(Opcode op, std::span<const Type> operands);

}  // namespace isoshade::ir
