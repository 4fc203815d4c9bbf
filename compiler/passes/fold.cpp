// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/passes.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>

#include "compiler/functions/library.h"
#include "compiler/ir/call_graph.h"
#include "compiler/ir/evaluate.h"
#include "compiler/ir/interpreter.h"
#include "compiler/passes/editor.h"
#include "compiler/passes/identities.h"
#include "runtime/lanes/float_rules.h"

namespace isoshade::passes {

namespace {

using namespace ir;

// The budget for evaluating calls while a whole module is folded, so that no document makes it hang.
constexpr uint64_t step_budget = 20'000'000;
constexpr uint64_t steps_per_call = 1'000'000;

// Evaluates calls on constants: in the module itself, because no callee calls the function that is being folded, or, if
// bodies must be built first, in a copy that has all of them.
class CallEvaluator {
 public:
  CallEvaluator(const Module& module, std::optional<functions::Tier> tier) : module_(module), tier_(tier) {}

  /// False if the call must stay.
  bool evaluate(uint32_t callee, std::span<const uint32_t> arguments, std::span<uint32_t> results) {
    if (budget_ == 0 || (module_.functions[callee].is_declaration() && !tier_)) return false;
    if (!interpreter_) {
      if (tier_) {
        expanded_ = module_;
        functions::expand(expanded_, *tier_);
      }
      interpreter_.emplace(executable(), Preconditions::report);
    }
    if (!runnable(callee)) return false;
    const uint64_t limit = std::min(budget_, steps_per_call);
    interpreter_->limit_steps(limit);
    const uint64_t breaches = interpreter_->breaches();
    const bool ended = interpreter_->run(callee, arguments, results);
    budget_ -= limit - interpreter_->steps_left();
    return ended && interpreter_->breaches() == breaches;
  }

 private:
  const Module& executable() const { return tier_ ? expanded_ : module_; }

  // Whether a function reaches no declaration and no buffer.
  bool runnable(uint32_t function) {
    if (runnable_.empty()) runnable_.resize(executable().functions.size());
    std::optional<bool>& known = runnable_[function];
    if (!known) {
      const std::array entries{function};
      const auto reached = callees_first(executable(), entries);
      known = std::all_of(reached->begin(), reached->end(), [&](uint32_t f) {
        const auto& made = executable().functions[f].instructions;
        return !executable().functions[f].is_declaration() &&
               std::none_of(made.begin(), made.end(),
                            [](const Instruction& i) { return i.op == Opcode::load; });
      });
    }
    return *known;
  }

  const Module& module_;
  std::optional<functions::Tier> tier_;
  Module expanded_;
  std::optional<Interpreter> interpreter_;
  std::vector<std::optional<bool>> runnable_;  ///< by function
  uint64_t budget_ = step_budget;
};

class Folder {
 public:
  Folder(Function& f, CallEvaluator& calls) : f_(f), edit_(f), calls_(calls) {}

  void run() {
    edit_.run([this](InstructionId id) { visit(id); });
  }

 private:
  void visit(InstructionId id) {
    const Instruction made = f_.instructions[id];
    switch (made.op) {
      case Opcode::constant:
      case Opcode::hidden_zero:
      case Opcode::load: return edit_.keep(id);
      case Opcode::construct: return replace_or_keep(id, whole_vector(made));
      case Opcode::extract: return replace_or_keep(id, component(made));
      case Opcode::call: return call(id, made);
      case Opcode::branch: return branch(id, made);
      case Opcode::loop: return loop(id, made);
      case Opcode::ddx:
      case Opcode::ddy: return edit_.keep(id);
#define OP(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
        return replace_or_keep(id, folded(made));
    }
  }

  std::optional<ValueId> folded(const Instruction& made) {
    if (made.op == Opcode::select)
      if (const auto truth = known_truth(edit_.operand(made, 0))) return edit_.operand(made, *truth ? 1 : 2);
    if (const auto same = evaluated(made)) return same;
    if (const auto same = chosen(made)) return same;
    return identity(edit_, made);
  }

  void replace_or_keep(InstructionId id, std::optional<ValueId> with) {
    if (with)
      edit_.replace(f_.instructions[id].first_result, *with);
    else
      edit_.keep(id);
  }

  // The select that chooses operand `i` among two constants; null if there is none.
  const Instruction* choice(const Instruction& made, uint32_t i) const {
    const Instruction* select = edit_.definition(edit_.operand(made, i), Opcode::select);
    return select != nullptr && known_vector(edit_.operand(*select, 1)) &&
                   known_vector(edit_.operand(*select, 2))
               ? select
               : nullptr;
  }

  bool known_vector(ValueId value) const {
    for (uint32_t c = 0; c < f_.type(value).width; ++c)
      if (!edit_.known(value, c)) return false;
    return true;
  }

  // The result if the operands are `operand(i)` and all of their components are known.
  template <class Operand>
  std::optional<std::array<uint32_t, 4>> result_of(const Instruction& made, Operand operand) const {
    const OpInfo& row = info(made.op);
    std::array<uint32_t, 4> words{};
    for (uint32_t c = 0; c < f_.type(made.first_result).width; ++c) {
      std::array<uint32_t, 3> bits{};
      for (uint32_t i = 0; i < made.operand_count; ++i) {
        const ValueId value = operand(i);
        const auto known = edit_.known(value, f_.type(value).width == 1 ? 0 : c);
        if (!known) return std::nullopt;
        bits[i] = *known;
      }
      if (!holds(row.precondition, bits[0], bits[1])) return std::nullopt;
      words[c] = evaluate(made.op, bits[0], bits[1], bits[2]);
    }
    return words;
  }

  ValueId constant(const Instruction& made, const std::array<uint32_t, 4>& words) {
    const Type type = f_.type(made.first_result);
    return edit_.constant(type, std::span(words).first(type.width));
  }

  std::optional<ValueId> evaluated(const Instruction& made) {
    const auto words = result_of(made, [&](uint32_t i) { return edit_.operand(made, i); });
    return words ? std::optional(constant(made, *words)) : std::nullopt;
  }

  // An op on constants that one condition chooses becomes a choice of results. Drivers do the same, but without
  // flushing.
  std::optional<ValueId> chosen(const Instruction& made) {
    if (made.op == Opcode::select) return std::nullopt;
    ValueId condition = none;
    for (uint32_t i = 0; i < made.operand_count; ++i) {
      const Instruction* select = choice(made, i);
      if (select == nullptr) continue;
      if (condition != none && condition != edit_.operand(*select, 0)) return std::nullopt;
      condition = edit_.operand(*select, 0);
    }
    if (condition == none) return std::nullopt;
    const auto side = [&](uint32_t arm) {
      return result_of(made, [&](uint32_t i) {
        const Instruction* select = choice(made, i);
        return select != nullptr ? edit_.operand(*select, arm) : edit_.operand(made, i);
      });
    };
    const auto then = side(1), other = side(2);
    if (!then || !other) return std::nullopt;
    const ValueId a = constant(made, *then);
    return select(condition, a, constant(made, *other));
  }

  ValueId select(ValueId condition, ValueId a, ValueId b) {
    const ValueId value = edit_.make(Opcode::select, {condition, a, b});
    const Instruction made = *edit_.definition(value);
    return identity(edit_, made).value_or(value);
  }

  // The vector that this construct rebuilds from all of its components, in order.
  std::optional<ValueId> whole_vector(const Instruction& made) {
    std::optional<ValueId> vector;
    for (uint32_t c = 0; c < made.operand_count; ++c) {
      const Instruction* from = edit_.definition(edit_.operand(made, c), Opcode::extract);
      if (from == nullptr || from->imm != c) return std::nullopt;
      const ValueId source = edit_.operand(*from, 0);
      if (f_.type(source).width != made.operand_count || (vector && *vector != source)) return std::nullopt;
      vector = source;
    }
    return vector;
  }

  std::optional<ValueId> component(const Instruction& made) {
    const Instruction* vector = edit_.definition(edit_.operand(made, 0), Opcode::construct);
    return vector != nullptr ? std::optional(edit_.operand(*vector, made.imm)) : std::nullopt;
  }

  void call(InstructionId id, const Instruction& made) {
    std::vector<uint32_t> arguments;
    for (uint32_t i = 0; i < made.operand_count; ++i) {
      const ValueId operand = edit_.operand(made, i);
      for (uint32_t c = 0; c < f_.type(operand).width; ++c) {
        const auto bits = edit_.known(operand, c);
        if (!bits) return edit_.keep(id);
        arguments.push_back(*bits);
      }
    }
    size_t size = 0;
    for (uint32_t k = 0; k < made.result_count; ++k) size += f_.type(made.first_result + k).width;
    std::vector<uint32_t> results(size);
    if (!calls_.evaluate(made.imm, arguments, results)) return edit_.keep(id);
    std::span<const uint32_t> rest(results);
    for (uint32_t k = 0; k < made.result_count; ++k) {
      const Type type = f_.type(made.first_result + k);
      edit_.replace(made.first_result + k, edit_.constant(type, rest.first(type.width)));
      rest = rest.subspan(type.width);
    }
  }

  void branch(InstructionId id, const Instruction& made) {
    const ValueId condition = edit_.operand(made, 0);
    if (const auto truth = known_truth(condition)) return inline_block(made, made.blocks[*truth ? 0 : 1]);
    edit_.keep(id);
    for (const bool taken : {true, false}) {
      assumed_.emplace_back(condition, taken);
      edit_.descend_into(made.blocks[taken ? 0 : 1]);
      assumed_.pop_back();
    }
    for (uint32_t k = 0; k < made.result_count; ++k) {
      const ValueId then = f_.blocks[made.blocks[0]].yields[k], other = f_.blocks[made.blocks[1]].yields[k];
      if (then == other) {
        edit_.replace(made.first_result + k, then);
      } else if (known_vector(then) && known_vector(other)) {
        const ValueId a = copy(then);
        edit_.replace(made.first_result + k, select(edit_.operand(made, 0), a, copy(other)));
      }
    }
  }

  /// What a condition is, if it is constant or that of a branch around.
  std::optional<bool> known_truth(ValueId condition) const {
    if (const auto bits = edit_.known(condition, 0)) return *bits != 0;
    for (const auto& [assumed, truth] : assumed_)
      if (assumed == condition) return truth;
    return std::nullopt;
  }

  // A copy, in this block, of a known value of an inner block.
  ValueId copy(ValueId value) {
    std::array<uint32_t, 4> words{};
    const Type type = f_.type(value);
    for (uint32_t c = 0; c < type.width; ++c) words[c] = *edit_.known(value, c);
    return edit_.constant(type, std::span(words).first(type.width));
  }

  void loop(InstructionId id, const Instruction& made) {
    const auto count = edit_.known(edit_.operand(made, 0), 0);
    const bool never = count && static_cast<int32_t>(*count) <= 0;
    const bool once = count && *count == 1;
    if (never) {
      for (uint32_t k = 0; k < made.result_count; ++k)
        edit_.replace(made.first_result + k, edit_.operand(made, k + 1));
    } else if (once) {
      const std::vector<ValueId> parameters = f_.blocks[made.blocks[0]].parameters;
      edit_.replace(parameters[0], edit_.constant(int_type, 0));
      for (uint32_t k = 0; k < made.result_count; ++k)
        edit_.replace(parameters[k + 1], edit_.operand(made, k + 1));
      inline_block(made, made.blocks[0]);
    } else {
      edit_.keep(id);
      edit_.descend(id);
    }
  }

  void inline_block(const Instruction& made, BlockId block) {
    edit_.inline_block(block);
    for (uint32_t k = 0; k < made.result_count; ++k)
      edit_.replace(made.first_result + k, f_.blocks[block].yields[k]);
  }

  Function& f_;
  Editor edit_;
  CallEvaluator& calls_;
  std::vector<std::pair<ValueId, bool>> assumed_;  ///< conditions of the branches around, and the side
};

bool has_calls(const Function& function) {
  return std::ranges::any_of(function.instructions, [](const Instruction& made) { return made.op == Opcode::call; });
}

}  // namespace

void fold(ir::Module& module, std::optional<functions::Tier> tier, size_t first) {
  const lanes::FpGuard guard;
  const auto& functions = module.functions;
  if (std::none_of(functions.begin(), functions.end(), [](const Function& f) { return f.is_declaration(); }))
    tier.reset();
  CallEvaluator calls(module, tier);
  for (size_t i = first; i < module.functions.size(); ++i) {
    Function& function = module.functions[i];
    if (function.is_declaration()) continue;
    if (!tier || !has_calls(function)) {
      Folder(function, calls).run();
      continue;
    }
    Function folded = function;  // the evaluator may copy the module meanwhile, and needs it whole
    Folder(folded, calls).run();
    function = std::move(folded);
  }
}

}  // namespace isoshade::passes
