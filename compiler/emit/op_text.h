// SPDX-License-Identifier: Apache-2.0
// The texts of ops in all languages (targets/*/ops.def), taken apart once: where the operands stand, and which of them need
// brackets.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "compiler/emit/target_id.h"
#include "compiler/ir/op.h"

namespace isoshade::emit {

/// How tightly the outermost operator of an expression binds, loosest first. GLSL and C++ agree.
enum class Precedence : uint8_t {
  choice,  // ?:
  disjunction,
  conjunction,
  bit_or,
  bit_xor,
  bit_and,
  equality,
  relation,
  shift,
  sum,
  product,
  prefix,
  primary,
};

/// What may stand in an operand's place without brackets: what binds at least as tightly as `least`, or is `also`.
/// Stricter than the grammar where compilers warn and readers stumble: `(a << 8) + b`, `(a & b) | c`, `(a && b) || c`.
struct Room {
  Precedence least = Precedence::choice;
  Precedence also = Precedence::choice;
  bool holds(Precedence operand) const { return operand >= least || operand == also; }
};

/// The text of one op in one language.
struct OpText {
  static constexpr int result = -1;

  struct Piece {
    std::string_view before;  ///< literally, in front of the hole
    int hole;                 ///< an operand's index, or `result`
    std::string_view suffix;  ///< behind `$=`: a further name that the text declares
    Room room;
    bool is_argument = false;  ///< of a function or a type, whole: `f($0)`
  };
  std::vector<Piece> pieces;
  std::string_view end;  ///< behind the last hole
  Precedence precedence = Precedence::primary;
  bool is_statement = false;
  bool repeats = false;  ///< an operand stands in it more than once, so it must be a name
  int columns = 0;       ///< without operands
  std::string_view what;  ///< the operator or the function called
};

/// The text of an op in a language that has it.
const OpText& op_text(TargetId target, ir::Opcode op);
/// Whether the language has the op. If not, a pass must replace it.
bool has_op(TargetId target, ir::Opcode op);

/// What is common to the texts of an op in all languages, so that they nest alike.
struct OpShape {
  bool is_statement, repeats;
  int columns;
  std::string_view noun;  ///< for what the op computes, for names of values that have none: "sum", "product"
  std::vector<std::string_view> suffixes;  ///< of the names that a text declares beside the result
};

const OpShape& op_shape(ir::Opcode op);

}  // namespace isoshade::emit
