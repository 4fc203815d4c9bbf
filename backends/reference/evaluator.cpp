// SPDX-License-Identifier: Apache-2.0
#include "backends/reference/evaluator.h"

#include <algorithm>
#include <array>
#include <bit>

#include "backends/reference/functions.h"
#include "compiler/ir/evaluate.h"
#include "compiler/support/assert.h"

namespace isoshade::reference {

using ir::Opcode;
using support::assert_that;

namespace {

float float_of(uint32_t bits) { return std::bit_cast<float>(ir::flush_denormal(bits)); }

// The functions that the column `cpp` of ops.def names, of numbers. + - * / sqrt floor abs are Real's own.
Real negate(const Real& x) { return -x; }
uint32_t to_int(const Real& x) {
  const auto cut = std::clamp<int64_t>(static_cast<int64_t>(x), INT32_MIN, INT32_MAX);
  return static_cast<uint32_t>(static_cast<int32_t>(cut));
}
Real to_float(uint32_t x) { return static_cast<int32_t>(x); }
uint32_t bits(const Real& x) { return std::bit_cast<uint32_t>(stored(x)); }
uint32_t bits_nonnan(const Real& x) { return bits(x); }
Real from_bits(uint32_t x) { return float_of(x); }
Real from_bits_normal(uint32_t x) { return float_of(x); }

}  // namespace

void compute(Opcode op, const Cell& a, const Cell& b, const Cell& c, Cell& to) {
  const Real &x = a.number, &y = b.number;
#define TEXT_1_call(function) function(x)
#define TEXT_2_infix(sign) x sign y
#define COMPUTE_same(text) to.number = text;
#define COMPUTE_compare(text) to.word = text;
#define COMPUTE_to_int(text) to.word = text;
#define COMPUTE_to_float(text) { const uint32_t x = a.word; to.number = text; }
#define COMPUTE_choose(text) to = a.word != 0 ? b : c;
#define COMPUTE_integer(text) to.word = ir::evaluate(op, a.word, b.word, c.word);
#define COMPUTE_icompare(text) COMPUTE_integer(text)
#define COMPUTE_logic(text) COMPUTE_integer(text)
  switch (op) {
#define OP(name, arity, rule, cpp, ...) \
  case Opcode::name: COMPUTE_##rule(TEXT_##arity##_##cpp) return;
#define FORM(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
      break;
  }
  support::bug("the reference computes an op that is none of numbers");
}

Evaluator::Evaluator(const ir::Module& module)
    : module_(module), buffers_(module.buffers.size()), frames_(module.functions.size()) {}

void Evaluator::run(uint32_t function, std::span<const Cell> arguments, std::span<Cell> results) {
  CallFrame& frame = frame_of(function);
  const ir::Block& body = frame.function->blocks[0];
  size_t next = 0;
  for (const ir::ValueId parameter : body.parameters)
    for (uint32_t i = 0; i < frame.function->type(parameter).width; ++i)
      frame.cells[frame.first[parameter] + i] = arguments[next++];
  block(frame, 0);
  next = 0;
  for (const ir::ValueId result : body.yields)
    for (uint32_t i = 0; i < frame.function->type(result).width; ++i)
      results[next++] = frame.cells[frame.first[result] + i];
}

Evaluator::CallFrame& Evaluator::frame_of(uint32_t function) {
  CallFrame& frame = frames_[function];
  if (frame.function != nullptr) return frame;
  frame.function = &module_.functions[function];
  if (frame.function->is_declaration()) frame.variant = &functions::variant_of(*frame.function);
  uint32_t count = 0;
  for (const ir::Value& value : frame.function->values) {
    frame.first.push_back(count);
    count += value.type.width;
  }
  frame.cells.resize(count);
  return frame;
}

void Evaluator::block(CallFrame& frame, ir::BlockId id) {
  for (const ir::InstructionId made : frame.function->blocks[id].instructions)
    instruction(frame, frame.function->instructions[made]);
}

namespace {

/// Copies the cells of some values to the cells of others, in order.
template <class CallFrame>
void copy(CallFrame& frame, std::span<const ir::ValueId> from, ir::ValueId to) {
  for (const ir::ValueId value : from) {
    const uint32_t width = frame.function->type(value).width;
    std::copy_n(&frame.cells[frame.first[value]], width, &frame.cells[frame.first[to]]);
    ++to;
  }
}

}  // namespace

void Evaluator::instruction(CallFrame& frame, const ir::Instruction& made) {
  const auto operands = frame.function->operands_of(made);
  Cell* const result = made.result_count == 0 ? nullptr : &frame.cells[frame.first[made.first_result]];
  switch (made.op) {
    case Opcode::constant:
      result->word = made.imm;
      if (frame.function->type(made.first_result).is_float()) result->number = std::bit_cast<float>(made.imm);
      return;
    case Opcode::hidden_zero: result->number = 0; return;
    case Opcode::extract: *result = frame.cells[frame.first[operands[0]] + made.imm]; return;
    case Opcode::construct:
      for (size_t i = 0; i < operands.size(); ++i) result[i] = frame.cells[frame.first[operands[i]]];
      return;
    case Opcode::load: load(frame, made); return;
    case Opcode::call: call(frame, made); return;
    case Opcode::branch: {
      const bool taken = frame.cells[frame.first[operands[0]]].word != 0;
      const ir::BlockId side = made.blocks[taken ? 0 : 1];
      block(frame, side);
      copy(frame, frame.function->blocks[side].yields, made.first_result);
      return;
    }
    case Opcode::loop: loop(frame, made); return;
    case Opcode::ddx:
    case Opcode::ddy: support::bug("the reference met an op that a pass had to replace");
#define OP(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
      primitive(frame, made);
  }
}

void Evaluator::primitive(CallFrame& frame, const ir::Instruction& made) {
  const auto operands = frame.function->operands_of(made);
  const bool chooses = ir::info(made.op).rule == ir::Rule::choose;
  const uint32_t to = frame.first[made.first_result];
  static const Cell absent;
  for (uint32_t i = 0; i < frame.function->type(made.first_result).width; ++i) {
    std::array<const Cell*, 3> from{&absent, &absent, &absent};
    for (size_t k = 0; k < operands.size(); ++k)
      from[k] = &frame.cells[frame.first[operands[k]] + (chooses && k == 0 ? 0 : i)];
    compute(made.op, *from[0], *from[1], *from[2], frame.cells[to + i]);
  }
}

void Evaluator::load(CallFrame& frame, const ir::Instruction& made) {
  const std::span<const uint32_t> words = buffers_[made.imm];
  assert_that(!words.empty(), "the reference loads from a buffer that is empty");
  const uint32_t index = frame.cells[frame.first[frame.function->operands_of(made)[0]]].word;
  const uint32_t word = words[std::min<size_t>(index, words.size() - 1)];
  Cell& to = frame.cells[frame.first[made.first_result]];
  to.word = word;
  if (frame.function->type(made.first_result).is_float()) to.number = float_of(word);
}

void Evaluator::call(CallFrame& frame, const ir::Instruction& made) {
  CallFrame& callee = frame_of(made.imm);
  if (callee.variant != nullptr) return call_library(frame, *callee.variant, made);
  const ir::Block& body = callee.function->blocks[0];
  const auto operands = frame.function->operands_of(made);
  for (size_t i = 0; i < operands.size(); ++i)
    std::copy_n(&frame.cells[frame.first[operands[i]]], frame.function->type(operands[i]).width,
                &callee.cells[callee.first[body.parameters[i]]]);
  block(callee, 0);
  for (size_t i = 0; i < body.yields.size(); ++i)
    std::copy_n(&callee.cells[callee.first[body.yields[i]]], callee.function->type(body.yields[i]).width,
                &frame.cells[frame.first[made.first_result + i]]);
}

void Evaluator::call_library(CallFrame& frame, const functions::Variant& variant, const ir::Instruction& made) {
  std::vector<Real> arguments, results;
  for (const ir::ValueId operand : frame.function->operands_of(made))
    for (uint32_t i = 0; i < frame.function->type(operand).width; ++i)
      arguments.push_back(frame.cells[frame.first[operand] + i].number);
  for (const ir::Type type : variant.results) results.resize(results.size() + type.width);
  evaluate(variant, arguments, results);
  for (size_t i = 0; i < results.size(); ++i)
    frame.cells[frame.first[made.first_result] + i].number = results[i];
}

void Evaluator::loop(CallFrame& frame, const ir::Instruction& made) {
  const auto operands = frame.function->operands_of(made);
  const ir::Block& body = frame.function->blocks[made.blocks[0]];
  const uint32_t count = frame.cells[frame.first[operands[0]]].word;
  // Each iteration passes its results to the next.
  copy(frame, operands.subspan(1), made.first_result);
  for (uint32_t index = 0; static_cast<int32_t>(index) < static_cast<int32_t>(count); ++index) {
    frame.cells[frame.first[body.parameters[0]]].word = index;
    for (uint32_t i = 0; i < made.result_count; ++i)
      copy(frame, std::array{made.first_result + i}, body.parameters[i + 1]);
    block(frame, made.blocks[0]);
    copy(frame, body.yields, made.first_result);
  }
}

}  // namespace isoshade::reference
