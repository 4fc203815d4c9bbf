// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/identities.h"

#include "compiler/ir/laws.h"

namespace isoshade::passes {

namespace {

using namespace ir;
using Result = std::optional<ValueId>;

class Identities {
 public:
  Identities(Editor& editor, const Instruction& made) : e_(editor), op_(made.op) {
    a_ = e_.operand(made, 0);
    if (made.operand_count > 1) b_ = e_.operand(made, 1);
    if (made.operand_count > 2) c_ = e_.operand(made, 2);
    type_ = e_.function().type(made.first_result);
  }

  Result find() { return op_ == Opcode::select ? choices() : by_laws(); }

 private:
  Result by_laws() {
    for (const Law& law : laws_of(op_)) {
      if (const Result found = by(law, a_, b_)) return found;
      if (!commutes(op_)) continue;
      if (const Result found = by(law, b_, a_)) return found;
    }
    return std::nullopt;
  }

  /// What the law makes of its op on these operands, if it is about them.
  Result by(const Law& law, ValueId left, ValueId right) {
    ValueId x = none;
    if (!fits(law.left, left, x) || !fits(law.right, right, x)) return std::nullopt;
    if (law.is == law.left) return left;
    if (law.is == law.right) return right;
    switch (law.is.kind) {
      case Term::Kind::any: return x;
      case Term::Kind::constant: return e_.constant(type_, law.is.bits);
      case Term::Kind::of_any: return applied(law.is.op, x);
      case Term::Kind::absent: break;
    }
    return std::nullopt;
  }

  /// Whether a value is what the term says; finds out what x is.
  bool fits(const Term& term, ValueId value, ValueId& x) const {
    const auto is_x = [&](ValueId given) {
      if (x == none) x = given;
      return x == given;
    };
    switch (term.kind) {
      case Term::Kind::absent: return true;
      case Term::Kind::any: return is_x(value);
      case Term::Kind::constant: return e_.known_splat(value) == term.bits;
      case Term::Kind::of_any: {
        const Instruction* made = e_.definition(value, term.op);
        return made != nullptr && is_x(e_.operand(*made, 0));
      }
    }
    return false;
  }

  /// A unary op of a value, by its laws if there is one.
  ValueId applied(Opcode op, ValueId value) {
    for (const Law& law : laws_of(op))
      if (const Result found = by(law, value, none)) return *found;
    return e_.make(op, {value});
  }

  bool is(ValueId value, uint32_t bits) const { return e_.known_splat(value) == bits; }

  // What a select on the same condition gives on that side.
  ValueId arm(ValueId value, uint32_t side) const {
    const Instruction* made = e_.definition(value, Opcode::select);
    return made != nullptr && e_.operand(*made, 0) == a_ ? e_.operand(*made, side) : value;
  }

  Result choices() {
    const ValueId then = arm(b_, 1), other = arm(c_, 2);
    if (then != b_ || other != c_) return e_.make(Opcode::select, {a_, then, other});
    if (is(a_, 1)) return b_;
    if (is(a_, 0)) return c_;
    if (b_ == c_ || known_alike()) return b_;
    if (type_ == bool_type && is(b_, 1) && is(c_, 0)) return a_;
    if (type_ == bool_type && is(b_, 0) && is(c_, 1)) return applied(Opcode::bnot, a_);
    if (const Instruction* made = e_.definition(a_, Opcode::bnot))
      return e_.make(Opcode::select, {e_.operand(*made, 0), c_, b_});
    return std::nullopt;
  }

  bool known_alike() const {
    for (uint32_t i = 0; i < type_.width; ++i) {
      const auto b = e_.known(b_, i);
      if (!b || b != e_.known(c_, i)) return false;
    }
    return true;
  }

  Editor& e_;
  Opcode op_;
  ValueId a_ = none, b_ = none, c_ = none;
  Type type_;
};

}  // namespace

std::optional<ValueId> identity(Editor& editor, const Instruction& instruction) {
  return Identities(editor, instruction).find();
}

}  // namespace isoshade::passes
