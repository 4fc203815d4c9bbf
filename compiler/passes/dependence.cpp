// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/dependence.h"

#include <algorithm>
#include <utility>

namespace isoshade::passes {

using namespace ir;

namespace {

/// Whether an op's result changes with its operands.
bool passes_changes_on(Opcode op) {
  if (is_primitive(op)) return info(op).change != ChangeRule::flat;
  return op == Opcode::construct || op == Opcode::extract || is_derivative(op);
}

/// Marks values until nothing new is found: loops carry marks back to their beginning.
class Marking {
 public:
  Marking(const Function& function, Marks marks) : f_(function), marks_(std::move(marks)) {}

 protected:
  void mark(ValueId value, bool condition) {
    if (!condition || marks_[value] || !f_.type(value).is_float()) return;
    marks_[value] = true;
    changed_ = true;
  }

  const Function& f_;
  Marks marks_;
  bool changed_ = false;
};

class Forward : Marking {
 public:
  /// `marks`: values that are marked by themselves.
  Forward(const Function& function, Marks marks, const Marks& parameters, const CallChanges& calls)
      : Marking(function, std::move(marks)), calls_(calls) {
    for (size_t i = 0; i < parameters.size(); ++i) mark(f_.blocks[0].parameters[i], parameters[i]);
  }

  Marks run() {
    do {
      changed_ = false;
      visit(0);
    } while (changed_);
    return std::move(marks_);
  }

 private:
  void visit(BlockId block) {
    for (const InstructionId id : f_.blocks[block].instructions) visit(f_.instructions[id]);
  }

  void visit(const Instruction& made) {
    const auto operands = f_.operands_of(made);
    const auto result = [&](uint32_t k) { return made.first_result + k; };
    if (made.op == Opcode::branch) {
      for (const BlockId side : made.blocks) {
        visit(side);
        for (uint32_t k = 0; k < made.result_count; ++k) mark(result(k), marks_[f_.blocks[side].yields[k]]);
      }
    } else if (made.op == Opcode::loop) {
      const Block& body = f_.blocks[made.blocks[0]];
      for (uint32_t k = 0; k < made.result_count; ++k) mark(body.parameters[k + 1], marks_[operands[k + 1]]);
      visit(made.blocks[0]);
      for (uint32_t k = 0; k < made.result_count; ++k) {
        mark(body.parameters[k + 1], marks_[body.yields[k]]);
        mark(result(k), marks_[body.parameters[k + 1]]);
      }
    } else if (made.op == Opcode::call) {
      Marks arguments;
      for (const ValueId operand : operands) arguments.push_back(marks_[operand]);
      const Marks results = calls_(made, arguments);
      for (uint32_t k = 0; k < made.result_count; ++k) mark(result(k), results[k]);
    } else if (passes_changes_on(made.op)) {
      for (const ValueId operand : operands) mark(result(0), marks_[operand]);
    }
  }

  const CallChanges& calls_;
};

class Backward : Marking {
 public:
  Backward(const Function& function, const Marks& changing, const Marks& wanted)
      : Marking(function, Marks(function.values.size())), changing_(changing) {
    for (ValueId value = 0; value < wanted.size(); ++value) need(value, wanted[value]);
  }

  Marks run() {
    do {
      changed_ = false;
      visit(0);
    } while (changed_);
    return std::move(marks_);
  }

 private:
  void need(ValueId value, bool condition) { mark(value, condition && changing_[value]); }

  void visit(BlockId block) {
    const std::vector<InstructionId>& instructions = f_.blocks[block].instructions;
    for (auto id = instructions.rbegin(); id != instructions.rend(); ++id) visit(f_.instructions[*id]);
  }

  void visit(const Instruction& made) {
    const auto operands = f_.operands_of(made);
    const auto result = [&](uint32_t k) -> bool { return marks_[made.first_result + k]; };
    if (made.op == Opcode::branch) {
      for (const BlockId side : made.blocks) {
        for (uint32_t k = 0; k < made.result_count; ++k) need(f_.blocks[side].yields[k], result(k));
        visit(side);
      }
    } else if (made.op == Opcode::loop) {
      const Block& body = f_.blocks[made.blocks[0]];
      for (uint32_t k = 0; k < made.result_count; ++k) {
        const ValueId carried = body.parameters[k + 1];
        need(carried, result(k));
        need(body.yields[k], marks_[carried]);
        need(operands[k + 1], marks_[carried]);
      }
      visit(made.blocks[0]);
    } else if (!is_derivative(made.op)) {
      bool any = false;
      for (uint32_t k = 0; k < made.result_count; ++k) any |= result(k);
      for (const ValueId operand : operands) need(operand, any);
    }
  }

  const Marks& changing_;
};

}  // namespace

Marks changing(const Function& function, const Marks& parameters, const CallChanges& calls) {
  return Forward(function, Marks(function.values.size()), parameters, calls).run();
}

Marks depending(const Function& function, Marks marks) {
  const CallChanges calls = [](const Instruction& made, const Marks& arguments) {
    return Marks(made.result_count, std::ranges::find(arguments, true) != arguments.end());
  };
  return Forward(function, std::move(marks), {}, calls).run();
}

Marks needed(const Function& function, const Marks& changing, const Marks& wanted) {
  return Backward(function, changing, wanted).run();
}

}  // namespace isoshade::passes
