// SPDX-License-Identifier: Apache-2.0
// The opcodes: the primitive ops of ops.def, and the few that give a function its structure.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace isoshade::ir {

enum class Opcode : uint8_t {
#define OP(name, arity, rule, glsl, cpp, precondition) name,
#include "compiler/ir/ops.def"
  // The rest have no row: they compute nothing.
  constant,     ///< imm: the bits of a bool (0, 1), int or float (never a denormal; NaN is 0x7fc00000)
  construct,    ///< 2-4 floats -> vector
  extract,      ///< vector, imm: component -> float
  hidden_zero,  ///< 0.0, but what makes it so is not in the program: nothing can be folded with it
  load,         ///< imm: buffer; int index -> the buffer's element; an index outside [0, size) is undefined
  call,         ///< imm: callee (an index into Module::functions)
  branch,       ///< bool; two blocks, each yields the results; only one is run
  loop,         ///< int count, initial values; one block with parameters (index, carried...), yields carried
  ddx,  ///< float or vector -> what it changes by per pixel to the right; only until passes/derivatives
  ddy,  ///< likewise, per pixel down
};

enum class Rule : uint8_t { same, compare, icompare, integer, logic, choose, to_int, to_float };
enum class Precondition : uint8_t { none, finite_in_int_range, not_nan, not_denormal_bits, shift_amount };

/// One row of ops.def.
struct OpInfo {
  std::string_view name;
  int arity;
  Rule rule;
  std::string_view glsl;
  std::string_view cpp;
  Precondition precondition;
};

inline constexpr int primitive_count = static_cast<int>(Opcode::constant);

constexpr bool is_primitive(Opcode op) { return op < Opcode::constant; }
constexpr bool is_derivative(Opcode op) { return op == Opcode::ddx || op == Opcode::ddy; }
/// The row of a primitive op.
const OpInfo& info(Opcode op);
/// Any opcode's name, as text IR has it.
std::string_view name(Opcode op);
std::optional<Opcode> opcode_from_name(std::string_view name);

}  // namespace isoshade::ir
