// SPDX-License-Identifier: Apache-2.0
// The opcodes: the primitive ops of ops.def, and the few that give a function its structure.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace isoshade::ir {

enum class Opcode : uint8_t {
#define OP(name, ...) name,
#define FORM(name, immediate, blocks) name,
#include "compiler/ir/ops.def"
};

enum class Rule : uint8_t { same, compare, icompare, integer, logic, choose, to_int, to_float };
enum class Precondition : uint8_t { none, finite_in_int_range, not_nan, not_denormal_bits, shift_amount };

/// How the range of an op's result follows from those of its operands: prove/ends.cpp, and with errors
/// prove/bound_choice.cpp.
enum class RangeRule : uint8_t {
  // Comparisons: the set of orders of the operands that they accept, as bits.
  less = 1,
  equal = 2,
  less_or_equal = less | equal,
  greater = 4,
  not_equal = less | greater,
  greater_or_equal = equal | greater,
  // Floats.
  sum = 8,
  difference,
  product,
  quotient,
  root,
  floor,
  negative,
  magnitude,
  choice,
  // Ints and truth values.
  truncated,
  rounded,
  integer_sum,
  integer_difference,
  both,
  either,
  different,
  inverse,
  any,  ///< nothing is known of the result but its type
};

/// How an op's result changes with its operands: passes/tangents.cpp.
enum class ChangeRule : uint8_t {
  flat,  ///< nowhere but where it jumps
  sum,
  difference,
  product,
  quotient,
  root,
  negative,
  magnitude,
  choice,
};

/// What Instruction::imm is.
enum class Immediate : uint8_t { none, bits, component, buffer, function };

/// One OP row of ops.def.
struct OpInfo {
  std::string_view name;
  int arity;
  Rule rule;
  Precondition precondition;
  RangeRule range;
  ChangeRule change;
};

inline constexpr int primitive_count = 0
#define OP(name, ...) +1
#include "compiler/ir/ops.def"
    ;

constexpr bool is_primitive(Opcode op) { return static_cast<int>(op) < primitive_count; }
constexpr bool is_derivative(Opcode op) {
  return false
#define DERIVATIVE(name) || op == Opcode::name
#include "compiler/ir/ops.def"
      ;
}
constexpr Immediate immediate(Opcode op) {
  constexpr Immediate of[] = {
#define OP(name, ...) Immediate::none,
#define FORM(name, immediate, blocks) Immediate::immediate,
#include "compiler/ir/ops.def"
  };
  return of[static_cast<int>(op)];
}
constexpr int block_count(Opcode op) {
  constexpr int of[] = {
#define OP(name, ...) 0,
#define FORM(name, immediate, blocks) blocks,
#include "compiler/ir/ops.def"
  };
  return of[static_cast<int>(op)];
}
/// Whether a comparison accepts operands in this order, one of less, equal and greater.
constexpr bool accepts(RangeRule comparison, RangeRule order) {
  return (static_cast<int>(comparison) & static_cast<int>(order)) != 0;
}

/// The row of a primitive op.
const OpInfo& info(Opcode op);
/// Any opcode's name, as text IR has it.
std::string_view name(Opcode op);
std::optional<Opcode> opcode_from_name(std::string_view name);

}  // namespace isoshade::ir
