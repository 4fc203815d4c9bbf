// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/tangents.h"

#include <array>
#include <utility>

#include "compiler/support/assert.h"

namespace isoshade::passes {

using namespace ir;

Tangents::Tangents(Builder& builder, const Function& from, std::vector<Way>& ways, Waits waits, Call call,
                   CallChange call_change)
    : b_(builder),
      from_(from),
      ways_(ways),
      waits_(std::move(waits)),
      call_(std::move(call)),
      call_change_(std::move(call_change)),
      values_(from.values.size(), none) {
  b_.function().origins = from.origins;
  for (Way& way : ways_) way.change.assign(from.values.size(), none);
  for (size_t i = 0; i < from.parameters.size(); ++i) values_[from.blocks[0].parameters[i]] = b_.parameter(i);
}

ValueId Tangents::zero(Type type) {
  const ValueId scalar = b_.constant(0.0f);
  return b_.construct(std::vector<ValueId>(type.width, scalar));
}

ValueId Tangents::change(const Way& way, ValueId old) {
  return way.change[old] != none ? way.change[old] : zero(from_.type(old));
}

void Tangents::block(BlockId id) {
  for (const InstructionId instruction : from_.blocks[id].instructions)
    this->instruction(from_.instructions[instruction]);
}

void Tangents::name(ValueId made, ValueId old, const std::string& suffix, size_t first_new) {
  const uint32_t names = from_.values[old].names;
  if (names == 0 || made < first_new || b_.function().values[made].names != 0) return;
  const Origin node = from_.origins[names];
  b_.name(made, suffix.empty() ? names : b_.add_origin(node.node + suffix, node.line));
}

void Tangents::instruction(const Instruction& made) {
  b_.set_origin(made.origin);
  if (made.op == Opcode::branch) return branch(made);
  if (made.op == Opcode::loop) return loop(made);
  size_t first_new = b_.function().values.size();
  copy(made);
  for (uint32_t k = 0; k < made.result_count; ++k)
    name(values_[made.first_result + k], made.first_result + k, "", first_new);
  for (Way& way : ways_) {
    first_new = b_.function().values.size();
    if (made.op == Opcode::call) {
      Values arguments;
      for (const ValueId operand : from_.operands_of(made)) arguments.push_back(values_[operand]);
      const Values changes = call_change_(made, arguments, way);
      for (uint32_t k = 0; k < changes.size(); ++k) way.change[made.first_result + k] = changes[k];
    } else if (made.result_count == 1 && way.needed[made.first_result]) {
      way.change[made.first_result] = change_of(made, way);
    }
    for (uint32_t k = 0; k < made.result_count; ++k)
      if (const ValueId change = way.change[made.first_result + k]; change != none)
        name(change, made.first_result + k, way.suffix, first_new);
  }
}

void Tangents::copy(const Instruction& made) {
  Values operands;
  for (const ValueId operand : from_.operands_of(made)) operands.push_back(values_[operand]);
  ValueId& result = values_[made.first_result];
  switch (made.op) {
    case Opcode::constant: result = b_.constant_bits(from_.type(made.first_result), made.imm); return;
    case Opcode::construct: result = b_.construct(operands); return;
    case Opcode::extract: result = b_.extract(operands[0], made.imm); return;
    case Opcode::load: result = b_.load(made.imm, operands[0]); return;
    case Opcode::call: return take_results(made, call_(made, operands));
    case Opcode::hidden_zero:
    case Opcode::branch:
    case Opcode::loop: support::bug("differentiated after hide_foldables, or not as a block");
    case Opcode::ddx:
    case Opcode::ddy:
      if (waits_(made)) {
        result = b_.op(made.op, operands);
        return;
      }
      for (const Way& way : ways_)
        if (way.op == made.op) result = change(way, from_.operands_of(made)[0]);
      support::assert_that(result != none, "a derivative in what is differentiated");
      return;
#define OP(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
      result = b_.op(made.op, operands);
  }
}

void Tangents::take_results(const Instruction& made, const Values& results) {
  for (uint32_t k = 0; k < made.result_count; ++k) values_[made.first_result + k] = results[k];
}

void Tangents::branch(const Instruction& made) {
  const auto side = [&](int which) {
    return [this, &made, which] {
      const BlockId id = made.blocks[static_cast<size_t>(which)];
      block(id);
      b_.set_origin(made.origin);
      Values yields;
      for (const ValueId old : from_.blocks[id].yields) yields.push_back(values_[old]);
      for (const Way& way : ways_)
        for (uint32_t k = 0; k < made.result_count; ++k)
          if (way.needed[made.first_result + k]) yields.push_back(change(way, from_.blocks[id].yields[k]));
      return yields;
    };
  };
  const size_t first_new = b_.function().values.size();
  const Values results = b_.branch(values_[from_.operands_of(made)[0]], side(0), side(1));
  take_results(made, results);
  for (uint32_t k = 0; k < made.result_count; ++k) name(results[k], made.first_result + k, "", first_new);
  size_t next = made.result_count;
  for (Way& way : ways_) {
    for (uint32_t k = 0; k < made.result_count; ++k) {
      if (!way.needed[made.first_result + k]) continue;
      name(way.change[made.first_result + k] = results[next++], made.first_result + k, way.suffix, first_new);
    }
  }
}

// A derivative is carried if that of the carried value is needed in the body or after the loop.
void Tangents::loop(const Instruction& made) {
  const auto operands = from_.operands_of(made);
  const Block& body = from_.blocks[made.blocks[0]];
  const auto for_changes = [&](const auto& visit) {
    for (Way& way : ways_)
      for (uint32_t k = 0; k < made.result_count; ++k)
        if (way.needed[body.parameters[k + 1]]) visit(way, k);
  };
  Values initial;
  for (uint32_t k = 0; k < made.result_count; ++k) initial.push_back(values_[operands[k + 1]]);
  for_changes([&](Way& way, uint32_t k) { initial.push_back(change(way, operands[k + 1])); });
  const size_t first_new = b_.function().values.size();
  const auto step = [&](ValueId index, std::span<const ValueId> carried) {
    values_[body.parameters[0]] = index;
    name(index, body.parameters[0], "", first_new);
    for (uint32_t k = 0; k < made.result_count; ++k) {
      values_[body.parameters[k + 1]] = carried[k];
      name(carried[k], body.parameters[k + 1], "", first_new);
    }
    size_t next = made.result_count;
    for_changes([&](Way& way, uint32_t k) {
      const ValueId old = body.parameters[k + 1];
      name(way.change[old] = carried[next++], old, way.suffix, first_new);
    });
    block(made.blocks[0]);
    b_.set_origin(made.origin);
    Values yields;
    for (const ValueId old : body.yields) yields.push_back(values_[old]);
    for_changes([&](Way& way, uint32_t k) { yields.push_back(change(way, body.yields[k])); });
    return yields;
  };
  const Values results = b_.loop(values_[operands[0]], initial, step);
  take_results(made, results);
  for (uint32_t k = 0; k < made.result_count; ++k) name(results[k], made.first_result + k, "", first_new);
  size_t next = made.result_count;
  for_changes([&](Way& way, uint32_t k) {
    name(way.change[made.first_result + k] = results[next++], made.first_result + k, way.suffix, first_new);
  });
}

ValueId Tangents::sum(ValueId a, ValueId b) {
  if (a == none || b == none) return a == none ? b : a;
  return b_.op(Opcode::fadd, {a, b});
}

ValueId Tangents::componentwise(Type type, const std::function<ValueId(uint32_t)>& component) {
  Values components;
  for (uint32_t i = 0; i < type.width; ++i) components.push_back(component(i));
  return b_.construct(components);
}

ValueId Tangents::change_of(const Instruction& made, const Way& way) {
  const auto operands = from_.operands_of(made);
  const auto value = [&](size_t i) { return values_[operands[i]]; };
  const auto change = [&](size_t i) { return way.change[operands[i]]; };
  const auto times = [&](ValueId a, ValueId b) { return a == none ? none : b_.op(Opcode::fmul, {a, b}); };
  const ValueId result = values_[made.first_result];
  const Type type = from_.type(made.first_result);
  if (made.op == Opcode::extract) return b_.extract(change(0), made.imm);
  if (made.op == Opcode::construct)
    return componentwise(type, [&](uint32_t i) { return this->change(way, operands[i]); });
  support::assert_that(is_primitive(made.op), "no derivative of " + std::string(ir::name(made.op)));
  switch (info(made.op).change) {
    case ChangeRule::flat: break;
    case ChangeRule::sum: return sum(change(0), change(1));
    case ChangeRule::difference:
      if (change(1) == none) return change(0);
      if (change(0) == none) return b_.op(Opcode::fneg, {change(1)});
      return b_.op(Opcode::fsub, {change(0), change(1)});
    case ChangeRule::product: return sum(times(change(0), value(1)), times(change(1), value(0)));
    case ChangeRule::quotient: {  // (x / y)' = (x' - (x / y) y') / y
      const ValueId part = times(change(1), result);
      if (part == none) return b_.op(Opcode::fdiv, {change(0), value(1)});
      const ValueId above =
          change(0) == none ? b_.op(Opcode::fneg, {part}) : b_.op(Opcode::fsub, {change(0), part});
      return b_.op(Opcode::fdiv, {above, value(1)});
    }
    case ChangeRule::root:
      return componentwise(type, [&](uint32_t i) {
        const ValueId root = b_.extract(result, i);
        const ValueId half = b_.op(Opcode::fmul, {b_.extract(change(0), i), b_.constant(0.5f)});
        const ValueId positive = b_.op(Opcode::fgt, {root, b_.constant(0.0f)});
        return b_.op(Opcode::select, {positive, b_.op(Opcode::fdiv, {half, root}), b_.constant(0.0f)});
      });
    case ChangeRule::negative: return b_.op(Opcode::fneg, {change(0)});
    case ChangeRule::magnitude:
      return componentwise(type, [&](uint32_t i) {
        const ValueId x = b_.extract(value(0), i), d = b_.extract(change(0), i);
        const ValueId negative = b_.op(Opcode::flt, {x, b_.constant(0.0f)});
        const ValueId positive = b_.op(Opcode::fgt, {x, b_.constant(0.0f)});
        const ValueId otherwise =
            b_.op(Opcode::select, {negative, b_.op(Opcode::fneg, {d}), b_.constant(0.0f)});
        return b_.op(Opcode::select, {positive, d, otherwise});
      });
    case ChangeRule::choice:
      return b_.op(Opcode::select,
                   {value(0), this->change(way, operands[1]), this->change(way, operands[2])});
  }
  support::bug("what changes nowhere has no derivative: " + std::string(ir::name(made.op)));
}

}  // namespace isoshade::passes
