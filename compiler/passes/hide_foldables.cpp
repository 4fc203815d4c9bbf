// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/passes.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "compiler/ir/call_graph.h"
#include "compiler/ir/evaluate.h"
#include "compiler/ir/laws.h"
#include "compiler/passes/editor.h"
#include "runtime/lanes/float_rules.h"

namespace isoshade::passes {

namespace {

using namespace ir;
using Bits = std::optional<uint32_t>;

constexpr uint32_t smallest_normal_bits = 0x00800000;
constexpr uint32_t small_bits = 0x20800000;  // 2^-62
constexpr uint32_t large_bits = 0x5e800000;  // 2^62

bool is_zero(Bits bits) { return bits && (*bits & ~sign_bit) == 0; }

/// Whether a product with this may have to be flushed; true for infinities and NaN, too.
bool is_extreme(Bits bits) {
  return bits && !is_zero(bits) && ((*bits & ~sign_bit) < small_bits || (*bits & ~sign_bit) > large_bits);
}

bool is_plain(Bits bits) { return !is_zero(bits) && !is_extreme(bits); }

bool is_arithmetic(Opcode op) { return is_primitive(op) && info(op).rule == Rule::same; }

class Hider {
 public:
  Hider(const Module& module, Function& f, bool computes_on_results)
      : module_(module), f_(f), edit_(f), open_(f.values.size(), false) {
    yields_ = computes_on_results ? Yields::known : Yields::only_returned;
    for (ValueId parameter : f_.blocks[0].parameters) open_[parameter] = true;
  }

  void run() {
    edit_.run([this](InstructionId id) { visit(id); }, [this](BlockId block) { leave(block); });
  }

 private:
  /// What a driver can do with the values that a block yields.
  enum class Yields : uint8_t { only_returned, chosen, known };

  void visit(InstructionId id) {
    const Instruction made = f_.instructions[id];
    if (is_arithmetic(made.op)) return arithmetic(id, made);
    if (const auto compared = compare_with_zero(made)) return edit_.replace(made.first_result, *compared);
    switch (made.op) {
      case Opcode::construct: for_operands(made, 0, [&](ValueId v) { return chosen(v); }); break;
      case Opcode::call: arguments(made); break;
      case Opcode::branch: inside(id, Yields::chosen); break;
      case Opcode::loop: loop(id, made); break;
      case Opcode::constant:
      case Opcode::extract:
      case Opcode::hidden_zero:
      case Opcode::load:
      case Opcode::ddx:
      case Opcode::ddy: break;
#define OP(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
        primitive(made);
    }
    if (made.blocks[0] == none) edit_.keep(id);
    mark_open(made);
  }

  void primitive(const Instruction& made) {
    switch (info(made.op).rule) {
      case Rule::choose: for_operands(made, 1, [&](ValueId v) { return chosen(v); }); break;
      case Rule::to_int:
        if (made.op != Opcode::ftoi) break;
        // int(float(i))
        for_operands(made, 0, [&](ValueId v) {
          return is_open(v) ? edit_.make(Opcode::fadd, {v, zero()}) : v;
        });
        break;
      case Rule::to_float:
        for_operands(made, 0, [&](ValueId v) {
          return is_open(v) ? edit_.make(Opcode::ior, {v, bits()}) : v;
        });
        break;
      case Rule::same:
      case Rule::compare:
      case Rule::icompare:
      case Rule::integer:
      case Rule::logic: break;
    }
  }

  template <class Replace>
  void for_operands(const Instruction& made, uint32_t first, Replace replace) {
    for (uint32_t i = first; i < made.operand_count; ++i) {
      const ValueId with = replace(edit_.operand(made, i));
      f_.operands[made.first_operand + i] = with;
    }
  }

  /// Whether a driver that inlines calls may know the int, or see that the float was an int.
  bool is_open(ValueId value) const { return value < open_.size() && open_[value]; }

  void mark_open(const Instruction& made) {
    const auto operands = f_.operands_of(made);
    const auto open = [&](ValueId value) { return is_open(value); };
    bool is_open = false;
    switch (made.op) {
      case Opcode::constant: is_open = f_.type(made.first_result) == int_type; break;
      case Opcode::call:
      case Opcode::branch:
      case Opcode::loop: is_open = true; break;
      case Opcode::extract:
      case Opcode::construct: is_open = std::ranges::any_of(operands, open); break;
      case Opcode::hidden_zero:
      case Opcode::load:
      case Opcode::ddx:
      case Opcode::ddy: break;
#define OP(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
        is_open = primitive_is_open(made.op, operands);
    }
    for (uint32_t k = 0; k < made.result_count; ++k) open_[made.first_result + k] = is_open;
  }

  bool primitive_is_open(Opcode op, std::span<const ValueId> operands) const {
    const auto open = [&](ValueId value) { return is_open(value); };
    if (op == Opcode::itof) return true;
    if (info(op).rule == Rule::integer) return std::ranges::all_of(operands, open);
    return is_exact(op) && std::ranges::any_of(operands, open);  // a float that was an int still is one
  }

  void arithmetic(InstructionId id, const Instruction& made) {
    if (is_evaluated(made)) return edit_.replace(made.first_result, taken_apart(made));
    const bool multiplies = made.op == Opcode::fmul || made.op == Opcode::fdiv;
    for_operands(made, 0, [&](ValueId v) {
      const Bits bits = f_.type(v).width == 1 ? edit_.known(v, 0) : std::nullopt;
      return is_zero(bits) || (multiplies && is_extreme(bits)) ? hidden(v) : v;
    });
    edit_.keep(id);
    mark_open(made);
  }

  /// Whether all operands are constant in some component.
  bool is_evaluated(const Instruction& made) const {
    for (uint32_t c = 0; c < f_.type(made.first_result).width; ++c)
      if (evaluated(made, c)) return true;
    return false;
  }

  Bits evaluated(const Instruction& made, uint32_t c) const {
    std::array<uint32_t, 2> words{};
    for (uint32_t i = 0; i < made.operand_count; ++i) {
      const Bits word = edit_.known(edit_.operand(made, i), c);
      if (!word) return std::nullopt;
      words[i] = *word;
    }
    return evaluate(made.op, words[0], words[1], 0);
  }

  ValueId taken_apart(const Instruction& made) {
    const uint32_t width = f_.type(made.first_result).width;
    std::array<ValueId, 4> components;
    for (uint32_t c = 0; c < width; ++c) {
      if (const Bits word = evaluated(made, c)) {
        components[c] = is_plain(word) ? edit_.constant(float_type, *word) : hidden(float_type, *word);
        continue;
      }
      std::array<ValueId, 2> operands;
      for (uint32_t i = 0; i < made.operand_count; ++i)
        operands[i] = edit_.component(edit_.operand(made, i), c);
      components[c] = edit_.make(made.op, std::span(operands).first(made.operand_count));
    }
    return width == 1 ? components[0] : edit_.make(Opcode::construct, std::span(components).first(width));
  }

  // No float is denormal, so numbers above 0 are at least the smallest normal one.
  std::optional<ValueId> compare_with_zero(const Instruction& made) {
    if (!is_primitive(made.op) || info(made.op).rule != Rule::compare) return std::nullopt;
    const bool zero_first = is_zero(edit_.known(edit_.operand(made, 0), 0));
    if (!zero_first && !is_zero(edit_.known(edit_.operand(made, 1), 0))) return std::nullopt;
    const ValueId x = edit_.operand(made, zero_first ? 1 : 0);
    const auto with = [&](Opcode op, bool negative) {
      const uint32_t smallest = smallest_normal_bits | (negative ? sign_bit : 0u);
      return edit_.make(op, {x, edit_.constant(float_type, smallest)});
    };
    // x < 0 is x <= -smallest, x <= 0 is x < smallest, and so on.
    const Opcode op = zero_first ? swapped(made.op) : made.op;
    const RangeRule orders = info(op).range;
    const bool below = accepts(orders, RangeRule::less), above = accepts(orders, RangeRule::greater);
    if (below == above) return std::nullopt;  // == and !=
    const bool strict = !accepts(orders, RangeRule::equal);
    return with(swapped(opposite(op)), below == strict);
  }

  void arguments(const Instruction& made) {
    // Library functions without arithmetic choose among their arguments.
    const bool chooses = !module_.functions[made.imm].library.empty();
    for_operands(made, 0, [&](ValueId v) {
      if (!f_.type(v).is_float()) return v;
      const bool whole = edit_.definition(v, Opcode::construct) == nullptr || is_known(v);
      return chooses && whole ? chosen(v) : known(v);
    });
  }

  bool is_known(ValueId vector) const {
    for (uint32_t c = 0; c < f_.type(vector).width; ++c)
      if (!edit_.known(vector, c)) return false;
    return true;
  }

  void inside(InstructionId id, Yields yields) {
    edit_.keep(id);
    const Yields outer = std::exchange(yields_, yields);
    edit_.descend(id);
    yields_ = outer;
  }

  void loop(InstructionId id, const Instruction& made) {
    const ValueId count = edit_.operand(made, 0);
    if (edit_.known(count, 0)) f_.operands[made.first_operand] = hidden(count);
    for_operands(made, 1, [&](ValueId v) { return f_.type(v).is_float() ? known(v) : v; });
    for (ValueId parameter : f_.blocks[made.blocks[0]].parameters) open_[parameter] = true;
    inside(id, Yields::known);
  }

  void leave(BlockId block) {
    if (yields_ == Yields::only_returned) return;
    for (size_t k = 0; k < f_.blocks[block].yields.size(); ++k) {
      const ValueId value = f_.blocks[block].yields[k];
      const ValueId with = yields_ == Yields::chosen ? chosen(value) : known(value);
      f_.blocks[block].yields[k] = with;
    }
  }

  /// A value that is chosen at run time. Of floats only zeros and extremes must be hidden; of ints the bits of 1 and
  /// -1: drivers take a choice among the bits of 1 and -0 for a bool converted to float, and lose the zero's sign.
  ValueId chosen(ValueId value) {
    if (f_.type(value).width != 1 || f_.type(value) == bool_type) return value;
    const Bits word = edit_.known(value, 0);
    if (!word) return value;
    const bool hide = f_.type(value).is_float() ? !is_plain(word) : (*word & ~sign_bit) == one_bits;
    return hide ? hidden(value) : value;
  }

  /// A value that a driver will know if it is constant.
  ValueId known(ValueId value) {
    if (f_.type(value).width == 1) return edit_.known(value, 0) ? hidden(value) : value;
    const Instruction* vector = edit_.definition(value, Opcode::construct);
    if (vector == nullptr) return value;
    std::array<ValueId, 4> components;
    const uint32_t width = f_.type(value).width;
    for (uint32_t c = 0; c < width; ++c) components[c] = f_.operands[vector->first_operand + c];
    bool changed = false;
    for (uint32_t c = 0; c < width; ++c) {
      const ValueId component = std::exchange(components[c], known(components[c]));
      changed = changed || component != components[c];
    }
    if (!changed) return value;
    const ValueId made = edit_.make(Opcode::construct, std::span(components).first(width));
    f_.values[made].names = f_.values[value].names;
    return made;
  }

  ValueId zero() { return hidden(float_type, 0); }
  ValueId bits() {
    if (bits_ == none) {
      const ValueId z = zero();
      bits_ = edit_.at_head([&] { return edit_.make(Opcode::fbits_nonnan, {z}); });
    }
    return bits_;
  }

  ValueId hidden(ValueId constant) { return hidden(f_.type(constant), *edit_.known(constant, 0)); }

  ValueId hidden(Type type, uint32_t word) {
    for (const Hidden& made : hidden_)
      if (made.type == type && made.word == word) return made.value;
    const ValueId value = make_hidden(type, word);
    hidden_.push_back({type, word, value});
    return value;
  }

  ValueId make_hidden(Type type, uint32_t word) {
    if (type.is_float() && word == 0) return edit_.at_head([&] { return edit_.hidden_zero(); });
    const ValueId from = type.is_float() ? zero() : bits();
    return edit_.at_head([&] {
      if (type == bool_type)
        return edit_.make(word != 0 ? Opcode::ieq : Opcode::ine, {from, edit_.constant(int_type, 0)});
      if (type == int_type && word == 0) return from;
      if (type == int_type) return edit_.make(Opcode::iadd, {from, edit_.constant(int_type, word)});
      if (word == sign_bit) return edit_.make(Opcode::fneg, {from});
      return edit_.make(Opcode::fadd, {from, edit_.constant(float_type, word)});
    });
  }

  struct Hidden {
    Type type;
    uint32_t word;
    ValueId value;
  };

  const Module& module_;
  Function& f_;
  Editor edit_;
  std::vector<bool> open_;  ///< by value; those that were made here are not
  std::vector<Hidden> hidden_;
  ValueId bits_ = none;
  Yields yields_;
};

// By function: whether a caller may compute with its results.
std::vector<bool> find_computed(const Module& module, std::span<const uint32_t> entries) {
  std::vector<bool> computed(module.functions.size(), true);
  const auto order = callees_first(module, entries);
  for (uint32_t reached : *order) computed[reached] = false;
  for (auto caller = order->rbegin(); caller != order->rend(); ++caller) {
    const Function& f = module.functions[*caller];
    std::vector<bool> used(f.values.size(), computed[*caller]);
    for (const Block& block : f.blocks) {
      for (InstructionId id : block.instructions)
        for (ValueId operand : f.operands_of(f.instructions[id])) used[operand] = true;
      if (&block != &f.blocks[0])
        for (ValueId yield : block.yields) used[yield] = true;
    }
    for (const Block& block : f.blocks)
      for (InstructionId id : block.instructions) {
        const Instruction& made = f.instructions[id];
        if (made.op != Opcode::call) continue;
        for (uint32_t k = 0; k < made.result_count; ++k)
          if (used[made.first_result + k]) computed[made.imm] = true;
      }
  }
  return computed;
}

}  // namespace

void hide_foldables(ir::Module& module, std::span<const uint32_t> entries) {
  const lanes::FpGuard guard;
  const std::vector<bool> computed = find_computed(module, entries);
  for (uint32_t i = 0; i < module.functions.size(); ++i)
    if (!module.functions[i].is_declaration()) Hider(module, module.functions[i], computed[i]).run();
}

}  // namespace isoshade::passes
