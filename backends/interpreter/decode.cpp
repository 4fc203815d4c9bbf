// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <span>
#include <unordered_map>
#include <utility>

#include "backends/interpreter/draft.h"
#include "compiler/ir/float_bits.h"
#include "compiler/ir/uniformity.h"
#include "compiler/support/assert.h"

namespace isoshade::interpreter {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Opcode;
using ir::Scalar;
using ir::ValueId;
using support::assert_that;

using Components = std::array<Place, 4>;

Pool pool_of(Scalar type) { return type == Scalar::boolean ? Pool::masks : Pool::words; }

class Decoder {
 public:
  explicit Decoder(const ir::Module& module) : module_(module) {}

  Draft decode(uint32_t function, size_t results) {
    const Function& f = module_.functions[function];
    std::vector<Components> arguments;
    for (const ir::Parameter& parameter : f.parameters) {
      Components components{};
      for (size_t i = 0; i < parameter.type.width; ++i) {
        components[i] = parameter.uniform ? scalar() : lanes(parameter.type.scalar);
        draft_.parameters.push_back(components[i]);
      }
      arguments.push_back(components);
    }
    const std::vector<Components> values = inline_call(function, arguments);
    for (size_t k = 0; k < values.size(); ++k)
      for (size_t i = 0; i < f.results[k].type.width && draft_.results.size() < results; ++i)
        draft_.results.push_back(stored(values[k][i], f.results[k].type.scalar));
    return std::move(draft_);
  }

 private:
  /// A function that is being inlined.
  struct Frame {
    const Function& function;
    std::vector<bool> uniform_parameters;
    std::vector<Components> values;
    std::vector<bool> uniform = {};  ///< by value; computed for the first loop
  };

  uint32_t here() const { return static_cast<uint32_t>(draft_.steps.size()); }

  Place scalar(uint32_t word = 0) {
    draft_.scalars.push_back(word);
    return {Pool::scalars, static_cast<uint32_t>(draft_.scalars.size() - 1)};
  }
  Place lanes(Scalar type) {
    const Pool pool = pool_of(type);
    return {pool, pool == Pool::masks ? draft_.masks++ : draft_.words++};
  }
  Place constant(uint32_t word) {
    const auto [found, is_new] = constants_.try_emplace(word);
    if (is_new) found->second = scalar(word);
    return found->second;
  }

  DraftStep& add(Kind kind) {
    DraftStep& step = draft_.steps.emplace_back();
    step.shape.kind = kind;
    step.block = block_;
    step.loop = loop_;
    return step;
  }
  static bool is_scalar(Place place) { return place.pool == Pool::scalars; }
  static unsigned uniform_bits(Place a, Place b = {}, Place c = {}) {
    return (is_scalar(a) ? 1u : 0u) | (is_scalar(b) ? 2u : 0u) | (is_scalar(c) ? 4u : 0u);
  }

  /// Adds a step that writes `to`.
  void operate(Opcode op, Scalar type, Place to, Place a, Place b = {}, Place c = {}) {
    DraftStep& step = add(Kind::primitive);
    step.shape.op = op;
    step.shape.type = type;
    step.shape.uniform = uniform_bits(a, b, c);
    step.to = to;
    step.a = a;
    step.b = b;
    step.c = c;
  }
  Place operation(Opcode op, Scalar type, Place a, Place b = {}, Place c = {}) {
    // In lanes these change nothing.
    if (a.pool == Pool::words && (op == Opcode::fbits_nonnan || op == Opcode::bitsf_normal)) return a;
    const auto varies = [](Place place) { return place.pool == Pool::words || place.pool == Pool::masks; };
    const Place to = varies(a) || varies(b) || varies(c) ? lanes(type) : scalar();
    operate(op, type, to, a, b, c);
    return to;
  }
  void copy(Place to, Place from, Scalar type) {
    if (to == from) return;
    DraftStep& step = add(Kind::copy);
    step.shape.type = type;
    step.shape.uniform = uniform_bits(from);
    step.to = to;
    step.a = from;
  }

  /// The word that is stored for a result.
  Place stored(Place value, Scalar type) {
    switch (type) {
      case Scalar::floating: return operation(Opcode::fbits, Scalar::integer, value);
      case Scalar::integer: return value;
      case Scalar::boolean: break;
    }
    return operation(Opcode::select, Scalar::integer, value, constant(1), constant(0));
  }

  std::vector<Components> inline_call(uint32_t number, const std::vector<Components>& arguments) {
    const Function& function = module_.functions[number];
    assert_that(!function.is_declaration(), "the interpreter met a function without body: " + function.name);
    Frame frame{function, {}, std::vector<Components>(function.values.size())};
    for (size_t i = 0; i < arguments.size(); ++i) {
      const ValueId parameter = function.blocks[0].parameters[i];
      frame.values[parameter] = arguments[i];
      const auto components = std::span(arguments[i]).first(function.type(parameter).width);
      frame.uniform_parameters.push_back(std::ranges::all_of(components, is_scalar));
    }
    instructions(frame, 0);
    std::vector<Components> results;
    for (const ValueId yield : function.blocks[0].yields) results.push_back(frame.values[yield]);
    return results;
  }

  void instructions(Frame& frame, ir::BlockId block) {
    for (const ir::InstructionId id : frame.function.blocks[block].instructions)
      instruction(frame, frame.function.instructions[id]);
  }

  /// The instructions of a block that is not run as often, or not for the same groups, as what is around it; then what
  /// `finish` adds to it.
  template <class Finish>
  void nested(Frame& frame, ir::BlockId block, const Finish& finish) {
    const uint32_t around = std::exchange(block_, ++blocks_);
    instructions(frame, block);
    finish();
    block_ = around;
  }

  void instruction(Frame& frame, const Instruction& made) {
    const auto operands = frame.function.operands_of(made);
    Components& result = frame.values[made.first_result];
    switch (made.op) {
      case Opcode::constant:
      case Opcode::hidden_zero: result[0] = constant(made.imm); return;
      case Opcode::extract: result[0] = frame.values[operands[0]][made.imm]; return;
      case Opcode::construct:
        for (size_t i = 0; i < operands.size(); ++i) result[i] = frame.values[operands[i]][0];
        return;
      case Opcode::load: {
        const Place index = frame.values[operands[0]][0];
        const Scalar type = frame.function.type(made.first_result).scalar;
        DraftStep& step = add(Kind::load);
        step.shape.type = type;
        step.buffer = made.imm;
        step.a = index;
        const uint32_t at = here() - 1;
        const Place to = is_scalar(index) ? scalar() : lanes(type);
        draft_.steps[at].to = result[0] = to;
        return;
      }
      case Opcode::call: {
        std::vector<Components> arguments;
        for (const ValueId operand : operands) arguments.push_back(frame.values[operand]);
        const std::vector<Components> results = inline_call(made.imm, arguments);
        std::ranges::copy(results, frame.values.begin() + made.first_result);
        return;
      }
      case Opcode::branch: branch(frame, made); return;
      case Opcode::loop: loop(frame, made); return;
      case Opcode::ddx:
      case Opcode::ddy: support::bug("the interpreter met an op that a pass had to replace");
#define OP(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
        primitive(frame, made);
    }
  }

  void primitive(Frame& frame, const Instruction& made) {
    const auto operands = frame.function.operands_of(made);
    const ir::Type type = frame.function.type(made.first_result);
    const bool chooses = ir::info(made.op).rule == ir::Rule::choose;
    for (size_t i = 0; i < type.width; ++i) {
      std::array<Place, 3> from{};
      for (size_t k = 0; k < operands.size(); ++k)
        from[k] = frame.values[operands[k]][chooses && k == 0 ? 0 : i];
      frame.values[made.first_result][i] = operation(made.op, type.scalar, from[0], from[1], from[2]);
    }
  }

  void branch(Frame& frame, const Instruction& made) {
    const Function& f = frame.function;
    const Place condition = frame.values[f.operands_of(made)[0]][0];
    if (is_scalar(condition)) return uniform_branch(frame, made, condition);
    const uint32_t split = here();
    add(Kind::split).a = condition;
    const auto nothing = [] {};
    nested(frame, made.blocks[0], nothing);
    draft_.steps[split].target = here();
    nested(frame, made.blocks[1], nothing);
    draft_.steps[split].end = here();
    for_each_result(frame, made, [&](Place& result, Place then, Place other, Scalar type) {
      result = then == other ? then : operation(Opcode::select, type, condition, then, other);
    });
  }

  void uniform_branch(Frame& frame, const Instruction& made, Place condition) {
    const uint32_t to_other = here();
    add(Kind::jump_if_not).a = condition;
    uint32_t first_copy = 0, to_end = 0;
    nested(frame, made.blocks[0], [&] {
      // Where these copy to is known when the other side is.
      first_copy = here();
      for_each_yield(frame, made.blocks[0], [&](Place then, Scalar type) {
        add(Kind::copy).a = then;
        draft_.steps.back().shape.type = type;
        draft_.steps.back().shape.uniform = uniform_bits(then);
      });
      to_end = here();
      add(Kind::jump);
    });
    draft_.steps[to_other].target = here();
    nested(frame, made.blocks[1], [&] {
      for_each_result(frame, made, [&](Place& result, Place then, Place other, Scalar type) {
        DraftStep& of_then = draft_.steps[first_copy++];
        of_then.dead = then == other;
        result = then == other ? then : is_scalar(then) && is_scalar(other) ? scalar() : lanes(type);
        of_then.to = result;
        if (then != other) copy(result, other, type);
      });
    });
    draft_.steps[to_end].target = here();
  }

  template <class Use>
  void for_each_yield(const Frame& frame, ir::BlockId block, const Use& use) {
    for (const ValueId yield : frame.function.blocks[block].yields) {
      const ir::Type type = frame.function.type(yield);
      const Components from = frame.values[yield];
      for (size_t i = 0; i < type.width; ++i) use(from[i], type.scalar);
    }
  }
  /// Calls use(result, then, other, type) for each component that a branch yields.
  template <class Use>
  void for_each_result(Frame& frame, const Instruction& made, const Use& use) {
    const Function& f = frame.function;
    for (uint32_t k = 0; k < made.result_count; ++k) {
      const ir::Type type = f.type(made.first_result + k);
      const Components then = frame.values[f.blocks[made.blocks[0]].yields[k]];
      const Components other = frame.values[f.blocks[made.blocks[1]].yields[k]];
      for (size_t i = 0; i < type.width; ++i)
        use(frame.values[made.first_result + k][i], then[i], other[i], type.scalar);
    }
  }

  /// A component that a loop carries on.
  struct Carried {
    Place initial;
    Scalar type;
    bool is_scalar;
    Place place = {};
  };

  void loop(Frame& frame, const Instruction& made) {
    const Function& f = frame.function;
    const auto operands = f.operands_of(made);
    const Place count = frame.values[operands[0]][0];
    assert_that(is_scalar(count), "a loop's count is uniform");
    if (frame.uniform.empty()) frame.uniform = ir::uniform_values(f, frame.uniform_parameters);
    std::vector<Carried> carried;
    for (uint32_t k = 0; k < made.result_count; ++k) {
      const ir::Type type = f.type(made.first_result + k);
      const Components initial = frame.values[operands[k + 1]];
      const bool uniform = frame.uniform[made.first_result + k];
      for (size_t i = 0; i < type.width; ++i)
        carried.push_back({initial[i], type.scalar, uniform && is_scalar(initial[i])});
    }
    const ir::Block& body = f.blocks[made.blocks[0]];
    const Place index = scalar();
    copy(index, constant(0), Scalar::integer);
    for (Carried& c : carried) {
      c.place = c.is_scalar ? scalar() : lanes(c.type);
      copy(c.place, c.initial, c.type);
    }
    frame.values[body.parameters[0]][0] = index;
    size_t next = 0;
    for (uint32_t k = 0; k < made.result_count; ++k)
      for (size_t i = 0; i < f.type(made.first_result + k).width; ++i)
        frame.values[made.first_result + k][i] = frame.values[body.parameters[k + 1]][i] = carried[next++].place;

    const uint32_t start = here();
    const auto number = static_cast<uint32_t>(draft_.loops.size());
    draft_.loops.push_back({start, start, loop_});
    const uint32_t around = std::exchange(loop_, number);
    add(Kind::jump_unless_less).a = index;
    draft_.steps.back().c = count;
    nested(frame, made.blocks[0], [&] {
      carry_on(frame, made.blocks[0], carried);
      operate(Opcode::iadd, Scalar::integer, index, index, constant(1));
      add(Kind::jump).target = start;
    });
    loop_ = around;
    draft_.steps[start].target = draft_.loops[number].end = here();
  }

  /// Gives the carried values of the next turn.
  void carry_on(const Frame& frame, ir::BlockId body, const std::vector<Carried>& carried) {
    std::vector<Place> next;
    for_each_yield(frame, body, [&](Place yield, Scalar) {
      assert_that(is_scalar(yield) || !carried[next.size()].is_scalar, "what a loop carries varies unexpectedly");
      next.push_back(yield);
    });
    // What another one's place holds is kept before that changes.
    for (size_t k = 0; k < next.size(); ++k)
      for (size_t other = 0; other < next.size(); ++other)
        if (other != k && next[k] == carried[other].place) {
          const Place kept = is_scalar(next[k]) ? scalar() : lanes(carried[k].type);
          copy(kept, next[k], carried[k].type);
          next[k] = kept;
          break;
        }
    for (size_t k = 0; k < next.size(); ++k) copy(carried[k].place, next[k], carried[k].type);
  }

  const ir::Module& module_;
  Draft draft_;
  std::unordered_map<uint32_t, Place> constants_;
  uint32_t block_ = 0, blocks_ = 0;
  uint32_t loop_ = ir::none;
};

}  // namespace

Draft decode(const ir::Module& module, uint32_t function, size_t results) {
  return Decoder(module).decode(function, results);
}

}  // namespace isoshade::interpreter
