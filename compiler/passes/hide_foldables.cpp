// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/hide_foldables.h"

#include <array>
#include <optional>

#include "compiler/ir/evaluate.h"
#include "compiler/passes/editor.h"
#include "runtime/lanes/float_rules.h"

namespace isoshade::passes {

namespace {

using namespace ir;
using Bits = std::optional<uint32_t>;

constexpr uint32_t smallest_normal_bits = 0x00800000;

bool is_zero(Bits bits) { return bits && (*bits & ~sign_bit) == 0; }

// Whether an op on operands of which these bits are known leaves a driver something to fold.
bool is_foldable(Opcode op, int arity, Bits a, Bits b) {
  if (a && (arity == 1 || b)) return true;
  switch (op) {
    case Opcode::fmul:
    case Opcode::fdiv: return is_zero(a) || is_zero(b);
    case Opcode::fadd: return a == 0u || b == 0u;
    case Opcode::fsub: return is_zero(a) || b == sign_bit;
    default: return false;
  }
}

// Whether drivers take a choice among these for a bool made float, +-1 or 0, of which they lose the zero's sign.
bool is_float_of_bool(Bits a, Bits b) {
  const auto pair = [](Bits one, Bits zero) {
    return (one == one_bits && zero == sign_bit) || (one == (one_bits | sign_bit) && zero == 0u);
  };
  return pair(a, b) || pair(b, a);
}

class Hider {
 public:
  explicit Hider(Function& f) : f_(f), edit_(f) {}

  void run() {
    edit_.run([this](InstructionId id) { visit(id); });
  }

 private:
  void visit(InstructionId id) {
    const Instruction made = f_.instructions[id];
    if (made.blocks[0] != none) {
      edit_.keep(id);
      edit_.descend(id);
      if (made.op == Opcode::branch) hide_yields(made);
      return;
    }
    if (made.op == Opcode::select) return hide_select(id, made);
    if (made.op == Opcode::ftoi) {
      const Instruction* from = edit_.definition(edit_.operand(made, 0), Opcode::itof);
      if (from != nullptr) return edit_.replace(made.first_result, truncated(edit_.operand(*from, 0)));
    }
    if (const auto compared = compare_with_zero(made)) return edit_.replace(made.first_result, *compared);
    if (!is_primitive(made.op) || info(made.op).rule != Rule::same || !has_foldable(made))
      return edit_.keep(id);
    const uint32_t width = f_.type(made.first_result).width;
    edit_.replace(made.first_result, vector(width, [&](uint32_t c) { return component(made, c); }));
  }

  // A scalar, or a vector of the components that `component` makes.
  template <class Component>
  ValueId vector(uint32_t width, Component component) {
    std::array<ValueId, 4> components;
    for (uint32_t c = 0; c < width; ++c) components[c] = component(c);
    return width == 1 ? components[0] : edit_.make(Opcode::construct, std::span(components).first(width));
  }

  bool has_float_of_bool(ValueId a, ValueId b) const {
    for (uint32_t c = 0; c < f_.type(a).width; ++c)
      if (is_float_of_bool(edit_.known(a, c), edit_.known(b, c))) return true;
    return false;
  }

  void hide_select(InstructionId id, const Instruction& made) {
    const ValueId condition = edit_.operand(made, 0), a = edit_.operand(made, 1), b = edit_.operand(made, 2);
    if (!has_float_of_bool(a, b)) return edit_.keep(id);
    edit_.replace(made.first_result, vector(f_.type(a).width, [&](uint32_t c) {
                    const Bits x = edit_.known(a, c), y = edit_.known(b, c);
                    if (is_float_of_bool(x, y)) return choose(condition, *x, *y, f_.type(a).is_float());
                    const ValueId values[] = {condition, edit_.component(a, c), edit_.component(b, c)};
                    return edit_.make(Opcode::select, values);
                  }));
  }

  // A branch becomes a select in drivers.
  void hide_yields(const Instruction& made) {
    for (uint32_t k = 0; k < made.result_count; ++k) {
      const ValueId a = f_.blocks[made.blocks[0]].yields[k], b = f_.blocks[made.blocks[1]].yields[k];
      const ValueId result = made.first_result + k;
      if (!has_float_of_bool(a, b)) continue;
      edit_.replace(result, vector(f_.type(a).width, [&](uint32_t c) {
                      const Bits x = edit_.known(a, c), y = edit_.known(b, c);
                      return is_float_of_bool(x, y)
                                 ? choose(edit_.operand(made, 0), *x, *y, f_.type(a).is_float())
                                 : edit_.component(result, c);
                    }));
    }
  }

  // One of two constants, neither of which stands in the text.
  ValueId choose(ValueId condition, uint32_t a, uint32_t b, bool is_float) {
    constexpr uint32_t mask = 0x40000000;
    const ValueId masked = edit_.make(Opcode::select, {condition, integer(a ^ mask), integer(b ^ mask)});
    const ValueId bits = edit_.make(Opcode::ixor, {masked, integer(mask)});
    return is_float ? edit_.make(Opcode::bitsf_normal, {bits}) : bits;
  }

  Bits known(const Instruction& made, uint32_t operand, uint32_t component) const {
    return operand < made.operand_count ? edit_.known(edit_.operand(made, operand), component) : std::nullopt;
  }

  bool has_foldable(const Instruction& made) const {
    for (uint32_t c = 0; c < f_.type(made.first_result).width; ++c)
      if (is_foldable(made.op, info(made.op).arity, known(made, 0, c), known(made, 1, c))) return true;
    return false;
  }

  // One component of the result, without the shape.
  ValueId component(const Instruction& made, uint32_t c) {
    const Bits a = known(made, 0, c), b = known(made, 1, c);
    const auto operand = [&](uint32_t i) { return edit_.component(edit_.operand(made, i), c); };
    if (made.operand_count == 1)
      return a ? literal(evaluate(made.op, *a, 0, 0)) : edit_.make(made.op, {operand(0)});
    if (a && b) return literal(evaluate(made.op, *a, *b, 0));
    if (!is_foldable(made.op, 2, a, b)) return edit_.make(made.op, {operand(0), operand(1)});
    switch (made.op) {
      case Opcode::fmul: return a ? times_zero(operand(1), *a) : times_zero(operand(0), *b);
      case Opcode::fadd: return plus_zero(operand(a ? 1 : 0));
      case Opcode::fsub: {
        if (b) return plus_zero(operand(0));
        const ValueId negative = edit_.make(Opcode::fneg, {operand(1)});
        return *a == 0 ? plus_zero(negative) : negative;
      }
      default:
        return a ? zero_over(operand(1), *a)
                 : edit_.make(Opcode::fmul, {operand(0), literal(*b | infinity_bits)});
    }
  }

  // No float is denormal: what is above 0 is at least the smallest normal number.
  std::optional<ValueId> compare_with_zero(const Instruction& made) {
    if (!is_primitive(made.op) || info(made.op).rule != Rule::compare) return std::nullopt;
    const bool zero_first = is_zero(known(made, 0, 0));
    if (!zero_first && !is_zero(known(made, 1, 0))) return std::nullopt;
    const ValueId x = edit_.operand(made, zero_first ? 1 : 0);
    const auto with = [&](Opcode op, bool negative) {
      return edit_.make(op, {x, literal(smallest_normal_bits | (negative ? sign_bit : 0u))});
    };
    switch (made.op) {
      case Opcode::flt: return zero_first ? with(Opcode::fge, false) : with(Opcode::fle, true);
      case Opcode::fgt: return zero_first ? with(Opcode::fle, true) : with(Opcode::fge, false);
      case Opcode::fle: return zero_first ? with(Opcode::fgt, true) : with(Opcode::flt, false);
      case Opcode::fge: return zero_first ? with(Opcode::flt, false) : with(Opcode::fgt, true);
      default: return std::nullopt;
    }
  }

  ValueId literal(uint32_t bits) { return edit_.constant(float_type, bits); }
  ValueId integer(uint32_t bits) { return edit_.constant(int_type, bits); }

  // A zero whose sign is that of `zero` and the bits' together, or NaN.
  ValueId signed_zero(ValueId bits, uint32_t zero, ValueId is_nan) {
    ValueId sign = edit_.make(Opcode::iand, {bits, integer(sign_bit)});
    if (zero != 0) sign = edit_.make(Opcode::ixor, {sign, integer(sign_bit)});
    return edit_.make(Opcode::bitsf_normal, {edit_.make(Opcode::select, {is_nan, integer(nan_bits), sign})});
  }

  ValueId times_zero(ValueId x, uint32_t zero) {
    const ValueId bits = edit_.make(Opcode::fbits, {x});
    const ValueId exponent = edit_.make(Opcode::iand, {bits, integer(infinity_bits)});
    return signed_zero(bits, zero, edit_.make(Opcode::ieq, {exponent, integer(infinity_bits)}));
  }

  ValueId zero_over(ValueId x, uint32_t zero) {
    const ValueId bits = edit_.make(Opcode::fbits, {x});
    const ValueId magnitude = edit_.make(Opcode::iand, {bits, integer(~sign_bit)});
    const ValueId by_zero = edit_.make(Opcode::ieq, {magnitude, integer(0)});
    const ValueId by_nan = edit_.make(Opcode::ieq, {magnitude, integer(nan_bits)});
    return signed_zero(bits, zero, edit_.make(Opcode::bor, {by_zero, by_nan}));
  }

  ValueId plus_zero(ValueId x) {
    const ValueId bits = edit_.make(Opcode::fbits, {x});
    const ValueId is_minus_zero = edit_.make(Opcode::ieq, {bits, integer(sign_bit)});
    return edit_.make(Opcode::select, {is_minus_zero, literal(0), x});
  }

  ValueId truncated(ValueId i) {
    const ValueId high = edit_.make(Opcode::itof, {edit_.make(Opcode::isar, {i, integer(16)})});
    const ValueId low = edit_.make(Opcode::itof, {edit_.make(Opcode::iand, {i, integer(0xffff)})});
    const ValueId scaled = edit_.make(Opcode::fmul, {high, literal(0x47800000)});  // 65536
    return edit_.make(Opcode::ftoi, {edit_.make(Opcode::fadd, {scaled, low})});
  }

  Function& f_;
  Editor edit_;
};

}  // namespace

void hide_foldables(ir::Module& module) {
  const lanes::FpGuard guard;
  for (Function& function : module.functions)
    if (!function.is_declaration()) Hider(function).run();
}

}  // namespace isoshade::passes
