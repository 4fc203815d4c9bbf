// SPDX-License-Identifier: Apache-2.0
// What decoded code consists of, and what each instruction set offers to execute it.
//
// The lanes of a batch are registers of the machine side by side, called groups. A register of the interpreter holds a
// value of each lane: words, or truth values in the form of the instruction set. Values that are the same in all lanes
// are scalars. Each operation is done for a range of groups, so that the side of a branch is only run for groups that
// have a lane which wants it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "compiler/ir/op.h"
#include "compiler/ir/type.h"

namespace isoshade::interpreter {

/// An array; its index is its number in lower::FrameBuffer. It has at least one element.
struct BufferView {
  const void* data;
  int size;
};

enum class Pool : uint8_t { none, scalars, words, masks };

/// Where a value is.
struct Place {
  Pool pool = Pool::none;
  uint32_t index = 0;
  friend bool operator==(Place, Place) = default;
};

struct Context {
  std::byte* words;
  std::byte* masks;
  uint32_t* scalars;
  const BufferView* buffers;
  uint32_t begin, end;  ///< the groups to work on
};

struct Step;
/// Does a step and returns the next one.
using Run = const Step*(const Step& step, Context& context);

/// The operands are offsets in bytes into a pool of registers, or numbers of scalars.
struct Step {
  Run* run;
  uint32_t to, a, b, c;
  uint32_t more;  ///< load: the buffer
};

enum class Kind : uint8_t {
  primitive,         ///< to = op(a, b, c)
  fused,             ///< to = op(inner(a, b), c), or op(c, inner(a, b))
  load,              ///< to = the element a of a buffer
  copy,              ///< to = a
  jump,              ///< to the step `b` further on
  jump_if_not,       ///< if scalar a is 0
  jump_unless_less,  ///< if scalar a >= scalar c
  /// Runs the steps up to the one `b` further on for the groups where mask a holds in any lane; those up to the one `c`
  /// further on for the groups where it does not hold in all lanes.
  split,
};

/// What decides which code executes a step.
struct Shape {
  Kind kind{};
  ir::Opcode op{};
  ir::Opcode inner{};        ///< of a fused step
  bool inner_first = false;  ///< of a fused step
  ir::Scalar type{};         ///< of the result; copy, select and load differ by it
  unsigned uniform = 0;      ///< bits 0 to 2: operands a, b and c are scalars
};

/// Integer operations that may be fused: those of which rotations, hashes and the signs of gradients consist. The inner one
/// is the first operand of the outer one, or any if that commutes.
struct IntegerPair {
  ir::Opcode inner, outer;
};
inline constexpr IntegerPair integer_pairs[] = {{ir::Opcode::ishl, ir::Opcode::ior},
                                                {ir::Opcode::ishr, ir::Opcode::ior},
                                                {ir::Opcode::ixor, ir::Opcode::isub},
                                                {ir::Opcode::ishl, ir::Opcode::iand}};

constexpr bool commutes(ir::Opcode op) { return op == ir::Opcode::ior || op == ir::Opcode::iand; }

/// Whether steps may be fused: the inner one to be the first or the second operand of the outer one.
constexpr bool may_fuse(ir::Opcode inner, ir::Opcode outer, bool inner_first) {
  const auto is_float = [](ir::Opcode op) {
    return op == ir::Opcode::fadd || op == ir::Opcode::fsub || op == ir::Opcode::fmul;
  };
  if (is_float(inner)) return is_float(outer);
  for (const IntegerPair& pair : integer_pairs)
    if (inner == pair.inner && outer == pair.outer) return inner_first || commutes(outer);
  return false;
}

struct LaneCode {
  int lanes;          ///< of a group
  size_t mask_bytes;  ///< of a group
  Run* (*find)(const Shape& shape);  ///< steps whose result is in lanes, and split
  void (*execute)(const Step* from, const Step* to, Context& context);
};

extern const LaneCode lane_code_4, lane_code_8, lane_code_16;

/// Steps whose result is a scalar, and jumps.
Run* find_scalar(const Shape& shape);

}  // namespace isoshade::interpreter
