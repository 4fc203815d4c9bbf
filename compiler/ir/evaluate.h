// SPDX-License-Identifier: Apache-2.0
// What each primitive op computes, on the bits of one component: the executable meaning of ops.def.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "compiler/ir/float_bits.h"
#include "compiler/ir/op.h"

namespace isoshade::ir {

/// Whether operands `a` and `b` satisfy a precondition.
inline bool holds(Precondition precondition, uint32_t a, uint32_t b) {
  switch (precondition) {
    case Precondition::none: return true;
    case Precondition::finite_in_int_range: {
      const float x = std::bit_cast<float>(a);
      return x >= -2147483648.0f && x < 2147483648.0f;  // both bounds are floats, and no float lies between
    }
    case Precondition::not_nan: return !is_nan(a);
    case Precondition::not_denormal_bits: return !is_denormal(a);
    case Precondition::shift_amount: return b < 32;
  }
  return true;
}

/// Toward minus infinity, by means of exact operations only; keeps the sign of zeros.
inline float floor_of(float x) {
  if (!(x > -8388608.0f && x < 8388608.0f)) return x;  // already integral, or infinite, or NaN
  const float truncated = static_cast<float>(static_cast<int32_t>(x));
  const float result = x < truncated ? truncated - 1.0f : truncated;
  return std::bit_cast<float>(std::bit_cast<uint32_t>(result) | (std::bit_cast<uint32_t>(x) & sign_bit));
}

/// The result of a primitive op on one component; bools are 0 or 1. Needs lanes::FpGuard. Where the row's
/// precondition does not hold the result is defined too, but by this function alone: targets differ.
inline uint32_t evaluate(Opcode op, uint32_t a, uint32_t b, uint32_t c) {
  const float x = std::bit_cast<float>(a);
  const float y = std::bit_cast<float>(b);
  const auto i = static_cast<int32_t>(a);
  const auto j = static_cast<int32_t>(b);
  const auto bits = [](float value) { return std::bit_cast<uint32_t>(value); };
  switch (op) {
    case Opcode::fadd: return bits(x + y);
    case Opcode::fsub: return bits(x - y);
    case Opcode::fmul: return bits(x * y);
    case Opcode::fdiv: return bits(x / y);
    case Opcode::fsqrt: return bits(std::sqrt(x));
    case Opcode::floor: return bits(floor_of(x));
    case Opcode::fneg: return a ^ sign_bit;
    case Opcode::fabs: return a & ~sign_bit;
    case Opcode::flt: return x < y;
    case Opcode::fle: return x <= y;
    case Opcode::fgt: return x > y;
    case Opcode::fge: return x >= y;
    case Opcode::feq: return x == y;
    case Opcode::fne: return x != y;
    case Opcode::select: return a != 0 ? b : c;
    case Opcode::ftoi:
      return holds(Precondition::finite_in_int_range, a, b) ? static_cast<uint32_t>(static_cast<int32_t>(x))
                                                            : sign_bit;
    case Opcode::itof: return bits(static_cast<float>(i));
    case Opcode::fbits:
    case Opcode::fbits_nonnan: return canonical_nan(a);
    case Opcode::bitsf:
    case Opcode::bitsf_normal: return flush_denormal(a);
    case Opcode::iadd: return a + b;
    case Opcode::isub: return a - b;
    case Opcode::imul: return a * b;
    case Opcode::imulhi: return static_cast<uint32_t>(static_cast<uint64_t>(int64_t{i} * int64_t{j}) >> 32);
    case Opcode::umulhi: return static_cast<uint32_t>((uint64_t{a} * uint64_t{b}) >> 32);
    case Opcode::iand: return a & b;
    case Opcode::ior: return a | b;
    case Opcode::ixor: return a ^ b;
    case Opcode::ishl: return a << (b & 31);
    case Opcode::ishr: return a >> (b & 31);
    case Opcode::isar: return static_cast<uint32_t>(i >> (b & 31));
    case Opcode::ilt: return i < j;
    case Opcode::ile: return i <= j;
    case Opcode::igt: return i > j;
    case Opcode::ige: return i >= j;
    case Opcode::ieq: return a == b;
    case Opcode::ine: return a != b;
    case Opcode::ult: return a < b;
    case Opcode::band: return a & b;
    case Opcode::bor: return a | b;
    case Opcode::bxor: return a ^ b;
    case Opcode::bnot: return a ^ 1;
#define FORM(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
      break;
  }
  return 0;  // not a primitive op
}

}  // namespace isoshade::ir
