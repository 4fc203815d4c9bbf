// SPDX-License-Identifier: Apache-2.0
// The algebra of the primitive ops, from laws.def.
#pragma once

#include <span>

#include "compiler/ir/op.h"

namespace isoshade::ir {

/// An operand or the result in a law.
struct Term {
  enum class Kind : uint8_t {
    absent,    ///< of a unary op's second operand
    any,       ///< x
    constant,  ///< of these bits, in all components
    of_any,    ///< op(x)
  };
  Kind kind = Kind::absent;
  Opcode op{};
  uint32_t bits = 0;
  friend bool operator==(const Term&, const Term&) = default;
};

/// op(left, right) is `is`.
struct Law {
  Opcode op;
  Term left, right, is;
};

/// The laws of an op, unary or binary; those of an op that commutes hold in the other order, too.
std::span<const Law> laws_of(Opcode op);
/// Whether op(x, y) is op(y, x).
bool commutes(Opcode op);
/// Whether an op on floats never rounds: it picks, negates or cuts an operand, and makes whole numbers of whole ones.
bool is_exact(Opcode op);
/// The comparison of floats, or of ints, that says of (y, x) what `comparison` says of (x, y).
Opcode swapped(Opcode comparison);
/// The comparison that holds where `comparison` does not, unless an operand is NaN.
Opcode opposite(Opcode comparison);

}  // namespace isoshade::ir
