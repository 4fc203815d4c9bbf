// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/interpreter.h"

#include <algorithm>
#include <array>
#include <string>

#include "compiler/ir/call_graph.h"
#include "compiler/ir/evaluate.h"
#include "compiler/ir/printer.h"
#include "compiler/support/assert.h"
#include "runtime/lanes/float_rules.h"

namespace isoshade::ir {

using support::assert_that;

// Turns one function, whose callees are compiled, into steps.
class Interpreter::Compiler {
 public:
  Compiler(Interpreter& interpreter, uint32_t function)
      : out_(interpreter), function_(interpreter.module_.functions[function]) {
    assert_that(!function_.is_declaration(), "the interpreter met a function without body: " + function_.name);
    registers_.assign(function_.values.size(), none);
    Compiled compiled;
    compiled.entry = here();
    for (ValueId parameter : function_.blocks[0].parameters)
      compiled.parameters.push_back({allocate(parameter), function_.type(parameter)});
    block(0);
    step({Code::leave, {}, {}, 0, false, 0});
    for (ValueId result : function_.blocks[0].yields)
      compiled.results.push_back({registers_[result], function_.type(result)});
    compiled.end = here();
    out_.compiled_[function] = std::move(compiled);
  }

 private:
  uint32_t here() const { return static_cast<uint32_t>(out_.steps_.size()); }
  uint32_t step(Step step) {
    step.source = source_;
    out_.steps_.push_back(step);
    return here() - 1;
  }

  uint32_t allocate(size_t words) {
    const auto first = static_cast<uint32_t>(out_.registers_.size());
    out_.registers_.resize(first + words);
    return first;
  }
  uint32_t allocate(ValueId value) {
    return registers_[value] = allocate(static_cast<size_t>(function_.type(value).width));
  }
  uint32_t literal(uint32_t word) {
    const uint32_t where = allocate(size_t{1});
    out_.registers_[where] = word;
    return where;
  }
  void copy(uint32_t to, uint32_t from, uint8_t width) { step({Code::copy, {}, {}, width, false, to, from}); }

  void block(BlockId id) {
    for (InstructionId instruction : function_.blocks[id].instructions) {
      source_ = instruction;
      emit(function_.instructions[instruction]);
    }
  }

  void emit(const Instruction& instruction) {
    const auto operands = function_.operands_of(instruction);
    const ValueId result = instruction.first_result;
    switch (instruction.op) {
      case Opcode::constant:
      case Opcode::hidden_zero: registers_[result] = literal(instruction.imm); return;
      case Opcode::extract: registers_[result] = registers_[operands[0]] + instruction.imm; return;
      case Opcode::construct:
        allocate(result);
        for (uint32_t i = 0; i < operands.size(); ++i)
          copy(registers_[result] + i, registers_[operands[i]], 1);
        return;
      case Opcode::load: {
        const bool floats = function_.type(result).is_float();
        step({Code::load, {}, {}, floats, false, instruction.imm, registers_[operands[0]], allocate(result)});
        return;
      }
      case Opcode::call: call(instruction); return;
      case Opcode::branch: branch(instruction); return;
      case Opcode::loop: loop(instruction); return;
      case Opcode::ddx:
      case Opcode::ddy: support::bug("the interpreter met an op that a pass had to replace");
#define OP(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
        primitive(instruction);
    }
  }

  void primitive(const Instruction& instruction) {
    std::array<uint32_t, 3> from{};
    const auto operands = function_.operands_of(instruction);
    for (size_t i = 0; i < operands.size(); ++i) from[i] = registers_[operands[i]];
    const OpInfo& row = info(instruction.op);
    const uint8_t width = function_.type(instruction.first_result).width;
    step({Code::primitive, instruction.op, row.precondition, width, row.rule == Rule::choose,
          allocate(instruction.first_result), from[0], from[1], from[2]});
  }

  void call(const Instruction& instruction) {
    const Compiled& callee = out_.compiled_[instruction.imm];
    const auto operands = function_.operands_of(instruction);
    for (size_t i = 0; i < operands.size(); ++i)
      copy(callee.parameters[i].first, registers_[operands[i]], callee.parameters[i].type.width);
    step({Code::call, {}, {}, 0, false, callee.entry});
    for (uint32_t i = 0; i < instruction.result_count; ++i)
      copy(allocate(instruction.first_result + i), callee.results[i].first, callee.results[i].type.width);
  }

  void branch(const Instruction& instruction) {
    for (uint32_t i = 0; i < instruction.result_count; ++i) allocate(instruction.first_result + i);
    const uint32_t condition = registers_[function_.operands_of(instruction)[0]];
    const uint32_t to_other = step({Code::jump_if_not, {}, {}, 0, false, 0, condition});
    side(instruction, 0);
    const uint32_t to_end = step({Code::jump, {}, {}, 0, false, 0});
    out_.steps_[to_other].to = here();
    side(instruction, 1);
    out_.steps_[to_end].to = here();
  }

  void side(const Instruction& instruction, int which) {
    block(instruction.blocks[which]);
    const auto& yields = function_.blocks[instruction.blocks[which]].yields;
    for (uint32_t i = 0; i < yields.size(); ++i)
      copy(registers_[instruction.first_result + i], registers_[yields[i]], function_.type(yields[i]).width);
  }

  void loop(const Instruction& instruction) {
    const auto operands = function_.operands_of(instruction);
    const Block& body = function_.blocks[instruction.blocks[0]];
    const uint32_t index = allocate(body.parameters[0]);
    copy(index, literal(0), 1);
    // The carried values live in the block's parameters; what the loop returns is what they hold at its end.
    for (uint32_t i = 0; i < instruction.result_count; ++i) {
      const ValueId carried = body.parameters[i + 1];
      copy(allocate(carried), registers_[operands[i + 1]], function_.type(carried).width);
      registers_[instruction.first_result + i] = registers_[carried];
    }
    const uint32_t start =
        step({Code::jump_unless_less, {}, {}, 0, false, 0, index, registers_[operands[0]]});
    block(instruction.blocks[0]);
    // Two rounds of copies: a yield may be another one's parameter.
    std::vector<uint32_t> next;
    for (ValueId yield : body.yields) {
      const uint8_t width = function_.type(yield).width;
      next.push_back(allocate(size_t{width}));
      copy(next.back(), registers_[yield], width);
    }
    for (size_t i = 0; i < next.size(); ++i)
      copy(registers_[body.parameters[i + 1]], next[i], function_.type(body.parameters[i + 1]).width);
    step({Code::primitive, Opcode::iadd, Precondition::none, 1, false, index, index, literal(1)});
    step({Code::jump, {}, {}, 0, false, start});
    out_.steps_[start].to = here();
  }

  Interpreter& out_;
  const Function& function_;
  std::vector<uint32_t> registers_;  ///< by value: the first of its registers
  InstructionId source_ = none;
};

Interpreter::Interpreter(const Module& module, Preconditions preconditions)
    : module_(module),
      preconditions_(preconditions),
      buffers_(module.buffers.size()),
      compiled_(module.functions.size()) {
  returns_.reserve(module.functions.size());
}

void Interpreter::bind(uint32_t buffer, std::span<const uint32_t> words) { buffers_[buffer] = words; }

bool Interpreter::run(uint32_t function, std::span<const uint32_t> arguments, std::span<uint32_t> results) {
  if (compiled_[function].entry == none) {
    const std::array entries{function};
    const auto order = callees_first(module_, entries);
    assert_that(order.has_value(), "a function calls itself");
    for (uint32_t callee : *order)
      if (compiled_[callee].entry == none) Compiler(*this, callee);
  }
  const Compiled& compiled = compiled_[function];
  size_t word = 0;
  for (const Slot& slot : compiled.parameters)
    for (uint32_t i = 0; i < slot.type.width; ++i, ++word) {
      assert_that(word < arguments.size(), "too few argument words");
      registers_[slot.first + i] = slot.type.is_float() ? flush_denormal(arguments[word]) : arguments[word];
    }
  assert_that(word == arguments.size(), "too many argument words");
  {
    const lanes::FpGuard guard;
    if (!execute(compiled.entry)) return false;
  }
  word = 0;
  for (const Slot& slot : compiled.results)
    for (uint32_t i = 0; i < slot.type.width; ++i, ++word) {
      assert_that(word < results.size(), "too few result words");
      const uint32_t bits = registers_[slot.first + i];
      results[word] = slot.type.is_float() ? canonical_nan(bits) : bits;
    }
  assert_that(word == results.size(), "too many result words");
  return true;
}

bool Interpreter::execute(uint32_t entry) {
  uint32_t* const r = registers_.data();
  const Step* const steps = steps_.data();
  returns_.clear();
  for (uint32_t next = entry;;) {
    if (steps_left_ == 0) return false;
    --steps_left_;
    const Step& s = steps[next++];
    switch (s.code) {
      case Code::primitive:
        for (uint32_t i = 0; i < s.width; ++i) {
          const uint32_t a = r[s.scalar_first ? s.a : s.a + i];
          const uint32_t b = r[s.b + i];
          if (s.precondition != Precondition::none && !holds(s.precondition, a, b))
            breach(s, s.precondition == Precondition::shift_amount ? b : a);
          r[s.to + i] = evaluate(s.op, a, b, r[s.c + i]);
        }
        break;
      case Code::copy:
        for (uint32_t i = 0; i < s.width; ++i) r[s.to + i] = r[s.a + i];
        break;
      case Code::load: {
        const std::span<const uint32_t> words = buffers_[s.to];
        uint32_t word = 0;
        if (words.empty())
          breach(s, r[s.a]);
        else
          word = words[std::min<size_t>(r[s.a], words.size() - 1)];
        r[s.b] = s.width != 0 ? flush_denormal(word) : word;
        break;
      }
      case Code::jump: next = s.to; break;
      case Code::jump_if_not:
        if (r[s.a] == 0) next = s.to;
        break;
      case Code::jump_unless_less:
        if (static_cast<int32_t>(r[s.a]) >= static_cast<int32_t>(r[s.b])) next = s.to;
        break;
      case Code::call:
        returns_.push_back(next);
        next = s.to;
        break;
      case Code::leave:
        if (returns_.empty()) return true;
        next = returns_.back();
        returns_.pop_back();
        break;
    }
  }
}

void Interpreter::breach(const Step& step, uint32_t operand) {
  ++breaches_;
  if (preconditions_ == Preconditions::report) return;
  const auto position = static_cast<uint32_t>(&step - steps_.data());
  for (uint32_t i = 0; i < compiled_.size(); ++i) {
    if (compiled_[i].entry == none || position < compiled_[i].entry || position >= compiled_[i].end) continue;
    const Function& function = module_.functions[i];
    support::bug("operand " + std::to_string(operand) + " breaks the precondition of " +
                 print_instruction(module_, function, step.source) + "\nin\n" + print(module_, function));
  }
}

}  // namespace isoshade::ir
