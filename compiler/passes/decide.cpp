// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/passes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <utility>

#include "compiler/ir/float_bits.h"
#include "compiler/passes/editor.h"
#include "compiler/passes/known_ranges.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::passes {

namespace {

using namespace ir;
using Result = std::optional<ValueId>;

class Decider {
 public:
  Decider(Function& f, RangeWalker& walker, const std::vector<KnownRanges>& arguments)
      : f_(f), edit_(f), walker_(walker), frame_{&f, std::vector<KnownRanges>(f.values.size())} {
    for (size_t i = 0; i < arguments.size(); ++i) frame_.values[f.blocks[0].parameters[i]] = arguments[i];
  }

  void run() {
    edit_.run([this](InstructionId id) { visit(id); });
  }

 private:
  void visit(InstructionId id) {
    const Instruction made = f_.instructions[id];
    if (made.op == Opcode::branch || made.op == Opcode::loop) {
      edit_.keep(id);
      // The blocks are walked as they are edited, in the same order.
      bool first = true;
      walker_.instruction(frame_, made, [&](BlockId) {
        if (std::exchange(first, false)) edit_.descend(id);
      });
      return;
    }
    walker_.instruction(frame_, made, {});
    const Result with = chosen(made);
    if (!with) return edit_.keep(id);
    frame_.values.resize(f_.values.size());
    frame_.values[*with] = frame_.values[made.first_result];
    edit_.replace(made.first_result, *with);
  }

  /// Whether something holds for every component.
  template <class Holds>
  bool each(const Instruction& made, Holds holds) const {
    for (uint32_t c = 0; c < f_.type(made.first_result).width; ++c)
      if (!holds(c)) return false;
    return true;
  }
  const KnownRange& of(ValueId value, uint32_t c) const {
    return frame_.values[value][f_.type(value).width == 1 ? 0 : c];
  }
  bool is_scalar(const Instruction& made) const { return f_.type(made.first_result).width == 1; }
  bool may_replace(const Instruction& made, ValueId by) const {
    return f_.type(made.first_result) == f_.type(by);
  }

  Result chosen(const Instruction& made) {
    if (made.op == Opcode::call) return called(made, walker_.row_of(made.imm));
    if (made.op == Opcode::fabs) return magnitude(made);
    if (!is_primitive(made.op)) return std::nullopt;
    if (made.op == Opcode::fadd || made.op == Opcode::fsub)
      if (const Result same = without_zero(made)) return same;
    return only_value(made);
  }

  /// The constant if a result can have no other value. A zero must have a known sign.
  Result only_value(const Instruction& made) {
    const Type type = f_.type(made.first_result);
    std::array<uint32_t, 4> words{};
    for (uint32_t c = 0; c < type.width; ++c) {
      const KnownRange& range = of(made.first_result, c);
      if (!range.is_point() || (type.is_float() && static_cast<double>(static_cast<float>(range.lo)) != range.lo))
        return std::nullopt;
      if (type.is_float() && range.is_zero() && range.may_be_minus_zero) return std::nullopt;
      words[c] = type.is_float() ? std::bit_cast<uint32_t>(static_cast<float>(range.lo) + 0.0f)
                                 : static_cast<uint32_t>(static_cast<int64_t>(range.lo));
    }
    return edit_.constant(type, std::span(words).first(type.width));
  }

  // x + 0 and x - 0 are x, whatever the sign of the zero, if x is no -0.
  Result without_zero(const Instruction& made) const {
    const ValueId x = edit_.operand(made, 0), y = edit_.operand(made, 1);
    const auto leaves = [&](ValueId value, ValueId zero) {
      return may_replace(made, value) && each(made, [&](uint32_t c) {
               return of(value, c).is_never_minus_zero() && of(zero, c).is_zero();
             });
    };
    if (leaves(x, y)) return x;
    return made.op == Opcode::fadd && leaves(y, x) ? Result(y) : std::nullopt;
  }

  Result magnitude(const Instruction& made) {
    const ValueId x = edit_.operand(made, 0);
    const bool positive = each(made, [&](uint32_t c) { return of(x, c).is_plus(); });
    return positive ? Result(x) : std::nullopt;
  }

  Result called(const Instruction& made, std::string_view row) {
    const auto operand = [&](uint32_t i) { return edit_.operand(made, i); };
    if (row == "min") return lesser(made, operand(0), operand(1));
    if (row == "max") return greater(made, operand(0), operand(1));
    if (row == "clamp") return clamped(made, operand(0), operand(1), operand(2));
    return row == "saturate" ? saturated(made, operand(0)) : std::nullopt;
  }

  bool all_known(const Instruction& made, ValueId a, ValueId b) const {
    return each(made, [&](uint32_t c) { return of(a, c) && of(b, c); });
  }
  /// a <= b, a < b
  bool at_most(const Instruction& made, ValueId a, ValueId b) const {
    return all_known(made, a, b) && each(made, [&](uint32_t c) { return of(a, c).hi <= of(b, c).lo; });
  }
  bool below(const Instruction& made, ValueId a, ValueId b) const {
    return all_known(made, a, b) && each(made, [&](uint32_t c) { return of(a, c).hi < of(b, c).lo; });
  }

  // min(a, b) is b < a ? b : a, and max(a, b) is a < b ? b : a.
  Result lesser(const Instruction& made, ValueId a, ValueId b) const {
    if (at_most(made, a, b) && may_replace(made, a)) return a;
    return below(made, b, a) && may_replace(made, b) ? Result(b) : std::nullopt;
  }
  Result greater(const Instruction& made, ValueId a, ValueId b) const {
    if (at_most(made, b, a) && may_replace(made, a)) return a;
    return below(made, a, b) && may_replace(made, b) ? Result(b) : std::nullopt;
  }

  Result clamped(const Instruction& made, ValueId x, ValueId low, ValueId high) {
    const bool above = at_most(made, low, x), beneath = at_most(made, x, high);
    if (above && beneath && may_replace(made, x)) return x;
    if (!is_scalar(made)) return std::nullopt;
    if (above) return edit_.make(Opcode::select, {edit_.make(Opcode::flt, {high, x}), high, x});
    // max(x, low) is at most high.
    if (beneath && at_most(made, low, high))
      return edit_.make(Opcode::select, {edit_.make(Opcode::flt, {x, low}), low, x});
    return std::nullopt;
  }

  // saturate(x) is x > 0 ? (x < 1 ? x : 1) : 0; it makes either zero +0.
  Result saturated(const Instruction& made, ValueId x) {
    const auto all = [&](auto holds) {
      return each(made, [&](uint32_t c) { return of(x, c) && holds(of(x, c)); });
    };
    const bool above = all([](const KnownRange& b) { return b.is_plus(); });
    const bool beneath = all([](const KnownRange& b) { return b.hi <= 1; });
    if (above && beneath) return x;
    if (!is_scalar(made) || (!above && !beneath)) return std::nullopt;
    const Opcode op = above ? Opcode::flt : Opcode::fgt;
    const ValueId end = edit_.constant(float_type, above ? one_bits : 0);
    return edit_.make(Opcode::select, {edit_.make(op, {x, end}), x, end});
  }

  Function& f_;
  Editor edit_;
  RangeWalker& walker_;
  RangeFrame frame_;
};

/// Whether a function declares ranges, which its parameters have whoever calls it.
bool declares_ranges(const Function& f) {
  return std::ranges::any_of(f.parameters, [](const Parameter& p) { return p.least && p.most; });
}

std::vector<KnownRanges> any_arguments(const Function& f) {
  std::vector<KnownRanges> arguments;
  for (const Parameter& parameter : f.parameters) arguments.push_back(RangeWalker::any(parameter.type));
  return arguments;
}

}  // namespace

void decide(Module& module, functions::Tier tier) {
  const lanes::FpGuard guard;
  RangeWalker walker(module, tier);
  for (uint32_t f = 0; f < module.functions.size(); ++f)
    if (declares_ranges(module.functions[f])) walker.walk(f, any_arguments(module.functions[f]));
  if (!walker.finished()) return;
  // Other callers could pass anything; lowering makes no such calls.
  for (uint32_t f = 0; f < module.functions.size(); ++f) {
    if (!walker.arguments_of(f).empty()) continue;
    for (const Instruction& made : module.functions[f].instructions)
      if (made.op == Opcode::call && !declares_ranges(module.functions[made.imm]) &&
          !walker.arguments_of(made.imm).empty())
        return;
  }
  for (uint32_t f = 0; f < module.functions.size(); ++f) {
    const std::vector<KnownRanges> arguments = walker.arguments_of(f);
    if (!arguments.empty() && walker.met_decisions(f)) Decider(module.functions[f], walker, arguments).run();
  }
}

}  // namespace isoshade::passes
