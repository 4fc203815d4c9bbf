// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/identities.h"

#include "compiler/ir/float_bits.h"

namespace isoshade::passes {

namespace {

using namespace ir;
using Result = std::optional<ValueId>;

constexpr uint32_t minus_one_bits = one_bits | sign_bit;
constexpr uint32_t all_bits = ~0u;

class Identities {
 public:
  Identities(Editor& editor, const Instruction& made) : e_(editor), op_(made.op) {
    a_ = e_.operand(made, 0);
    if (made.operand_count > 1) b_ = e_.operand(made, 1);
    if (made.operand_count > 2) c_ = e_.operand(made, 2);
    type_ = e_.function().type(made.first_result);
  }

  Result find() {
    switch (info(op_).rule) {
      case Rule::same: return floats();
      case Rule::integer: return ints();
      case Rule::logic: return truths();
      case Rule::choose: return choices();
      case Rule::icompare: return a_ == b_ ? bool_constant(holds_for_equals()) : std::nullopt;
      case Rule::compare:
        // The others tell whether x is NaN.
        return a_ == b_ && (op_ == Opcode::flt || op_ == Opcode::fgt) ? bool_constant(false) : std::nullopt;
      case Rule::to_float: return bits_of_bits();
      case Rule::to_int: return std::nullopt;
    }
    return std::nullopt;
  }

 private:
  bool is(ValueId value, uint32_t bits) const { return e_.known_splat(value) == bits; }
  Result bool_constant(bool value) { return e_.constant(bool_type, value); }
  Result zero() { return e_.constant(int_type, 0); }
  /// What `op` was applied to, to give this value.
  Result inside(ValueId value, Opcode op) const {
    const Instruction* made = e_.definition(value, op);
    return made != nullptr ? Result(e_.operand(*made, 0)) : std::nullopt;
  }
  Result negated(ValueId value) {
    if (const Result inner = inside(value, Opcode::fneg)) return inner;
    return e_.make(Opcode::fneg, {value});
  }

  Result floats() {
    switch (op_) {
      case Opcode::fadd:
        if (is(b_, sign_bit)) return a_;
        if (is(a_, sign_bit)) return b_;
        break;
      case Opcode::fsub:
        if (is(b_, 0)) return a_;
        break;
      case Opcode::fmul:
        if (is(b_, one_bits)) return a_;
        if (is(a_, one_bits)) return b_;
        if (is(b_, minus_one_bits)) return negated(a_);
        if (is(a_, minus_one_bits)) return negated(b_);
        break;
      case Opcode::fdiv:
        if (is(b_, one_bits)) return a_;
        if (is(b_, minus_one_bits)) return negated(a_);
        break;
      case Opcode::fneg: return inside(a_, Opcode::fneg);
      case Opcode::fabs:
        if (e_.definition(a_, Opcode::fabs) != nullptr) return a_;
        if (const Result inner = inside(a_, Opcode::fneg))
          return e_.definition(*inner, Opcode::fabs) != nullptr ? inner : e_.make(Opcode::fabs, {*inner});
        break;
      case Opcode::floor:
        if (e_.definition(a_, Opcode::floor) != nullptr || e_.definition(a_, Opcode::itof) != nullptr)
          return a_;
        break;
      default: break;
    }
    return std::nullopt;
  }

  Result ints() {
    switch (op_) {
      case Opcode::iadd:
        if (is(b_, 0)) return a_;
        if (is(a_, 0)) return b_;
        break;
      case Opcode::isub:
        if (is(b_, 0)) return a_;
        if (a_ == b_) return zero();
        break;
      case Opcode::imul:
        if (is(a_, 0) || is(b_, 0)) return zero();
        if (is(b_, 1)) return a_;
        if (is(a_, 1)) return b_;
        break;
      case Opcode::imulhi:
        if (is(a_, 0) || is(b_, 0)) return zero();
        break;
      case Opcode::umulhi:
        if (is(a_, 0) || is(b_, 0) || is(a_, 1) || is(b_, 1)) return zero();
        break;
      case Opcode::iand:
        if (is(a_, 0) || is(b_, 0)) return zero();
        if (a_ == b_ || is(b_, all_bits)) return a_;
        if (is(a_, all_bits)) return b_;
        break;
      case Opcode::ior:
        if (a_ == b_ || is(b_, 0) || is(a_, all_bits)) return a_;
        if (is(a_, 0) || is(b_, all_bits)) return b_;
        break;
      case Opcode::ixor:
        if (a_ == b_) return zero();
        if (is(b_, 0)) return a_;
        if (is(a_, 0)) return b_;
        break;
      case Opcode::ishl:
      case Opcode::ishr:
      case Opcode::isar:
        if (is(a_, 0) || is(b_, 0)) return a_;
        break;
      default: break;
    }
    return std::nullopt;
  }

  Result truths() {
    switch (op_) {
      case Opcode::band:
        if (a_ == b_ || is(b_, 1) || is(a_, 0)) return a_;
        if (is(a_, 1) || is(b_, 0)) return b_;
        break;
      case Opcode::bor:
        if (a_ == b_ || is(b_, 0) || is(a_, 1)) return a_;
        if (is(a_, 0) || is(b_, 1)) return b_;
        break;
      case Opcode::bxor:
        if (a_ == b_) return bool_constant(false);
        if (is(b_, 0)) return a_;
        if (is(a_, 0)) return b_;
        if (is(b_, 1)) return inverted(a_);
        if (is(a_, 1)) return inverted(b_);
        break;
      case Opcode::bnot: return inside(a_, Opcode::bnot);
      default: break;
    }
    return std::nullopt;
  }

  Result inverted(ValueId value) {
    if (const Result inner = inside(value, Opcode::bnot)) return inner;
    return e_.make(Opcode::bnot, {value});
  }

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
    if (type_ == bool_type && is(b_, 0) && is(c_, 1)) return inverted(a_);
    if (const Result inner = inside(a_, Opcode::bnot)) return e_.make(Opcode::select, {*inner, c_, b_});
    return std::nullopt;
  }

  bool known_alike() const {
    for (uint32_t i = 0; i < type_.width; ++i) {
      const auto b = e_.known(b_, i);
      if (!b || b != e_.known(c_, i)) return false;
    }
    return true;
  }

  bool holds_for_equals() const { return op_ == Opcode::ile || op_ == Opcode::ige || op_ == Opcode::ieq; }

  // A float's bits as a float again: NaN has become canonical, which is the same NaN.
  Result bits_of_bits() const {
    if (op_ == Opcode::itof) return std::nullopt;
    if (const Result inner = inside(a_, Opcode::fbits)) return inner;
    return inside(a_, Opcode::fbits_nonnan);
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
