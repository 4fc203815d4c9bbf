// SPDX-License-Identifier: Apache-2.0
#include "compiler/prove/flatten.h"

#include <algorithm>

#include "compiler/functions/library.h"
#include "compiler/support/assert.h"

namespace isoshade::prove {
namespace {

using ir::Opcode;
using ir::Scalar;

/// The largest derivative that is assumed.
constexpr double steepest = 1e6;

/// The name of a component, as the tables of `isoshade eval` have it.
std::string component_name(const Given& given, ir::Type type, uint32_t component) {
  if (given.element >= 0)
    return given.name + "." + std::to_string(given.element + static_cast<int>(component));
  constexpr std::string_view letters = "xyzw";
  return type.width == 1 ? given.name : given.name + "." + letters[component];
}

class Flattener {
 public:
  Flattener(Pool& pool, const std::function<std::vector<Given>(uint32_t)>& outside)
      : pool_(pool), module_(pool.tape().module), outside_(outside) {}

  Words input(const Given& given, ir::Type type);
  std::vector<Words> call(uint32_t function, const std::vector<Words>& arguments, uint32_t caller);

 private:
  struct CallFrame {
    const ir::Function& function;
    std::vector<Words> values;
    uint32_t caller;               ///< the place of the call
    std::vector<uint32_t> places;  ///< of the function's origins
  };

  std::vector<Words> body(uint32_t function, const std::vector<Words>& arguments, uint32_t caller);
  std::vector<Words> library(uint32_t function, const std::vector<Words>& arguments, uint32_t place);
  std::vector<Words> row(const Rule& rule, uint32_t function, const std::vector<Words>& arguments,
                         uint32_t place);
  void block(CallFrame& frame, ir::BlockId id);
  void instruction(CallFrame& frame, const ir::Instruction& i);
  Words primitive(const ir::Instruction& i, ir::Type type, const std::vector<Words>& in, uint32_t place);
  void keep_units(ir::Opcode op, const std::vector<Words>& in, const Words& out);
  void branch(CallFrame& frame, const ir::Instruction& i, uint32_t condition, uint32_t place);
  void loop(CallFrame& frame, const ir::Instruction& i, const std::vector<Words>& in, uint32_t place);
  uint32_t summed(uint32_t initial, uint32_t carried, uint32_t next, const Side& turns, uint32_t place);
  std::optional<Side> turns_of(uint32_t count) const;
  Words ask(const Given& given, ir::Type type, const Words& question, uint32_t place);
  Words derivative(ir::Opcode op, ir::Type type, const Words& of, uint32_t place);
  double quotient_by(uint32_t divisor) const;
  uint32_t place_of(CallFrame& frame, uint32_t origin);
  uint32_t unknown(Scalar scalar, uint32_t place);

  Pool& pool_;
  const ir::Module& module_;
  const std::function<std::vector<Given>(uint32_t)>& outside_;
  uint32_t unknowns_ = 0;
};

Words Flattener::input(const Given& given, ir::Type type) {
  std::vector<Input>& inputs = pool_.tape().inputs;
  const bool unit = given.unit && type.width > 1;
  const auto end = [&](double x) { return type.is_float() ? rounded(x) : x; };
  const uint32_t vector = unit ? static_cast<uint32_t>(inputs.size()) : none;
  Words words;
  for (uint32_t c = 0; c < type.width; ++c) {
    const uint32_t index = static_cast<uint32_t>(inputs.size());
    inputs.push_back(
        {component_name(given, type, c), type.scalar, end(given.lo), end(given.hi), vector, given.quotient});
    words.push_back(pool_.make({.kind = Kind::input, .scalar = type.scalar, .index = index}, {}));
  }
  if (unit) pool_.add_unit(words);
  return words;
}

uint32_t Flattener::unknown(Scalar scalar, uint32_t place) {
  return pool_.make({.kind = Kind::unknown, .scalar = scalar, .index = unknowns_++, .place = place}, {});
}

uint32_t Flattener::place_of(CallFrame& frame, uint32_t origin) {
  if (origin == 0) return frame.caller;
  uint32_t& place = frame.places[origin];
  if (place == none) {
    std::vector<IrPlace>& places = pool_.tape().places;
    place = static_cast<uint32_t>(places.size());
    const uint32_t caller = frame.caller == 0 ? none : frame.caller;
    const auto function = static_cast<uint32_t>(&frame.function - module_.functions.data());
    places.push_back(
        {frame.function.document, frame.function.origins[origin].node, caller, function, origin});
  }
  return place;
}

std::vector<Words> Flattener::call(uint32_t function, const std::vector<Words>& arguments, uint32_t caller) {
  const ir::Function& callee = module_.functions[function];
  if (!callee.library.empty()) return library(function, arguments, caller);
  const std::vector<Given> given = outside_(function);
  if (!callee.is_declaration() && given.empty()) return body(function, arguments, caller);
  Words question;
  for (const Words& argument : arguments) question.insert(question.end(), argument.begin(), argument.end());
  std::vector<Words> results;
  for (size_t i = 0; i < callee.results.size(); ++i) {
    const ir::Type type = callee.results[i].type;
    if (i < given.size()) {
      results.push_back(ask(given[i], type, question, caller));
      continue;
    }
    Words& words = results.emplace_back();
    for (uint32_t c = 0; c < type.width; ++c) words.push_back(unknown(type.scalar, caller));
  }
  return results;
}

/// A host's answer: an input whose error depends on the error of the question.
Words Flattener::ask(const Given& given, ir::Type type, const Words& question, uint32_t place) {
  const Words there = input(given, type);
  const bool exact = std::ranges::all_of(
      question, [&](uint32_t o) { return pool_[o].kind == Kind::input || pool_[o].kind == Kind::constant; });
  if (given.answer == Answer::same && exact) return there;
  Words words;
  for (const uint32_t number : there) {
    Words operands{number};
    operands.insert(operands.end(), question.begin(), question.end());
    words.push_back(pool_.make({.kind = Kind::asked,
                                .scalar = type.scalar,
                                .index = static_cast<uint32_t>(given.answer),
                                .place = place},
                               operands));
  }
  if (given.unit && type.width > 1) pool_.add_unit(words);
  return words;
}

/// Derivatives of inputs are inputs, too; those of other values have an unknown error.
Words Flattener::derivative(ir::Opcode op, ir::Type type, const Words& of, uint32_t place) {
  const bool exact = std::ranges::all_of(of, [&](uint32_t o) { return pool_[o].kind == Kind::input; });
  Given given{std::string(ir::name(op)) + " at " + pool_.tape().places[place].node, -steepest, steepest};
  given.answer = exact ? Answer::same : Answer::unknown;
  return ask(given, type, of, place);
}

std::vector<Words> Flattener::body(uint32_t function, const std::vector<Words>& arguments, uint32_t caller) {
  const ir::Function& callee = module_.functions[function];
  CallFrame frame{callee, std::vector<Words>(callee.values.size()), caller,
              std::vector<uint32_t>(callee.origins.size(), none)};
  for (size_t i = 0; i < arguments.size(); ++i) frame.values[callee.blocks[0].parameters[i]] = arguments[i];
  block(frame, 0);
  std::vector<Words> results;
  for (const ir::ValueId result : callee.blocks[0].yields) results.push_back(frame.values[result]);
  return results;
}

std::vector<Words> Flattener::library(uint32_t function, const std::vector<Words>& in, uint32_t place) {
  const std::string_view row_name = functions::variant_of(module_.functions[function]).row;
  const auto each = [&](auto operation) {
    Words words;
    for (uint32_t c = 0; c < in[0].size(); ++c) words.push_back(operation(c));
    return std::vector<Words>{words};
  };
  const auto choose = [&](Kind kind, uint32_t a, uint32_t b) {
    return pool_.make({.kind = kind, .place = place}, std::array{a, b});
  };
  if (row_name == "min") return each([&](uint32_t c) { return choose(Kind::least, in[0][c], in[1][c]); });
  if (row_name == "max") return each([&](uint32_t c) { return choose(Kind::greatest, in[0][c], in[1][c]); });
  if (row_name == "clamp")
    return each([&](uint32_t c) {
      return choose(Kind::least, choose(Kind::greatest, in[0][c], in[1][c]), in[2][c]);
    });
  if (row_name == "saturate") {
    const uint32_t zero = pool_.constant(Scalar::floating, 0);
    const uint32_t one = pool_.constant(Scalar::floating, 0x3f800000);
    return each([&](uint32_t c) { return choose(Kind::least, choose(Kind::greatest, in[0][c], zero), one); });
  }
  const auto same_as = [&](Opcode op, auto... a) {
    return pool_.make_op(op, {a...}, Scalar::floating, place);
  };
  if (row_name == "div_exact")
    return each([&](uint32_t c) { return same_as(Opcode::fdiv, in[0][c], in[1][c]); });
  if (row_name == "sqrt_exact") return each([&](uint32_t c) { return same_as(Opcode::fsqrt, in[0][c]); });
  if (row_name == "dot") {
    Words both = in[0];
    both.insert(both.end(), in[1].begin(), in[1].end());
    return {{pool_.make({.kind = Kind::dot, .place = place}, both)}};
  }
  if (const Rule* rule = find_rule(row_name)) return row(*rule, function, in, place);
  std::vector<Words> results = body(function, in, place);
  if (row_name == "cross") pool_.crosses.emplace(results[0], Pool::Product{in[0], in[1]});
  return results;
}

std::vector<Words> Flattener::row(const Rule& rule, uint32_t function, const std::vector<Words>& in,
                                  uint32_t place) {
  std::vector<Row>& rows = pool_.tape().rows;
  const ir::Function& callee = module_.functions[function];
  const uint32_t words = callee.results[0].type.width;
  auto found = std::ranges::find(rows, function, &Row::function);
  if (found == rows.end()) found = rows.insert(rows.end(), {&rule, function, words});
  const auto index = static_cast<uint32_t>(found - rows.begin());
  const bool componentwise = is_componentwise(rule.row);
  std::vector<Words> results;
  for (const ir::Result& result : callee.results) {
    Words out;
    for (uint32_t c = 0; c < result.type.width; ++c) {
      Words operands;
      for (const Words& argument : in) {
        if (componentwise)
          operands.push_back(argument[std::min<size_t>(c, argument.size() - 1)]);
        else
          operands.insert(operands.end(), argument.begin(), argument.end());
      }
      const auto component = static_cast<uint8_t>(componentwise ? 0 : c);
      out.push_back(
          pool_.make({.kind = Kind::row, .component = component, .index = index, .place = place}, operands));
    }
    results.push_back(out);
  }
  if (rule.row == "normalize") pool_.at_most_units.insert(results[0]);
  return results;
}

void Flattener::block(CallFrame& frame, ir::BlockId id) {
  for (const ir::InstructionId i : frame.function.blocks[id].instructions) {
    if (pool_.too_long()) return;
    instruction(frame, frame.function.instructions[i]);
  }
}

void Flattener::instruction(CallFrame& frame, const ir::Instruction& i) {
  const uint32_t place = place_of(frame, i.origin);
  const ir::Type type = frame.function.type(i.first_result);
  std::vector<Words> in;
  for (const ir::ValueId operand : frame.function.operands_of(i)) in.push_back(frame.values[operand]);
  Words& out = frame.values[i.first_result];
  switch (i.op) {
    case Opcode::constant: out = {pool_.constant(type.scalar, i.imm)}; return;
    case Opcode::hidden_zero: out = {pool_.constant(type.scalar, 0)}; return;
    case Opcode::construct:
      for (const Words& component : in) out.push_back(component[0]);
      return;
    case Opcode::extract: out = {in[0][i.imm]}; return;
    case Opcode::call: {
      const std::vector<Words> results = call(i.imm, in, place);
      if (pool_.too_long()) return;
      for (uint32_t r = 0; r < results.size(); ++r) frame.values[i.first_result + r] = results[r];
      return;
    }
    case Opcode::branch: return branch(frame, i, in[0][0], place);
    case Opcode::loop: return loop(frame, i, in, place);
    case Opcode::load: out = {unknown(type.scalar, place)}; return;
    case Opcode::ddx:
    case Opcode::ddy: out = derivative(i.op, type, in[0], place); return;
#define OP(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
      out = primitive(i, type, in, place);
      return;
  }
}

/// The upper bound of a quotient by this divisor, where that is an assumption; otherwise 0.
double Flattener::quotient_by(uint32_t divisor) const {
  const Operation& sum = pool_[divisor];
  if (sum.kind != Kind::op || sum.op != Opcode::fadd) return 0;
  const Operation& first = pool_[pool_.operands(divisor)[0]];
  return first.kind == Kind::input ? pool_.tape().inputs[first.index].quotient : 0;
}

Words Flattener::primitive(const ir::Instruction& i, ir::Type type, const std::vector<Words>& in,
                           uint32_t place) {
  Words out;
  for (uint32_t c = 0; c < type.width; ++c) {
    Words operands;
    for (const Words& operand : in) operands.push_back(operand[std::min<size_t>(c, operand.size() - 1)]);
    const double limit = i.op == Opcode::fdiv ? quotient_by(operands[1]) : 0;
    if (limit > 0) {
      Given distance{"distance at " + pool_.tape().places[place].node, 0, limit};
      distance.answer = Answer::quotient;
      // The divisor is d0 + depth * d1.
      const Operation& product = pool_[pool_.operands(operands[1])[1]];
      const bool known = product.kind == Kind::op && product.op == Opcode::fmul;
      if (!known) distance.answer = Answer::unknown;
      const Words depth{known ? pool_.operands(pool_.operands(operands[1])[1])[0] : operands[1]};
      out.push_back(ask(distance, ir::float_type, depth, place)[0]);
      continue;
    }
    out.push_back(
        pool_.make({.kind = Kind::op, .op = i.op, .scalar = type.scalar, .place = place}, operands));
  }
  keep_units(i.op, in, out);
  return out;
}

/// A unit vector that is turned round is one, and so is one of two (the normal of the side that is seen).
void Flattener::keep_units(Opcode op, const std::vector<Words>& in, const Words& out) {
  const auto has = [&](const std::set<Words>& units) {
    if (op == Opcode::fneg) return units.contains(in[0]);
    return op == Opcode::select && units.contains(in[1]) && units.contains(in[2]);
  };
  for (std::set<Words>* units : {&pool_.units, &pool_.at_most_units})
    if (has(*units)) units->insert(out);
}

void Flattener::branch(CallFrame& frame, const ir::Instruction& i, uint32_t condition, uint32_t place) {
  for (const ir::BlockId side : i.blocks) block(frame, side);
  if (pool_.too_long()) return;
  const auto& then = frame.function.blocks[i.blocks[0]].yields;
  const auto& other = frame.function.blocks[i.blocks[1]].yields;
  for (uint32_t r = 0; r < i.result_count; ++r) {
    const ir::ValueId result = i.first_result + r;
    const ir::Type type = frame.function.type(result);
    for (uint32_t c = 0; c < type.width; ++c) {
      const uint32_t a = frame.values[then[r]][c], b = frame.values[other[r]][c];
      frame.values[result].push_back(pool_.make_op(Opcode::select, {condition, a, b}, type.scalar, place));
    }
  }
}

void Flattener::loop(CallFrame& frame, const ir::Instruction& i, const std::vector<Words>& in, uint32_t place) {
  const ir::Block& body = frame.function.blocks[i.blocks[0]];
  const Side turns = turns_of(in[0][0]).value_or(Side{0, 0x1p31});
  frame.values[body.parameters[0]] = input({"turn", 0, std::max(0.0, turns.hi - 1)}, ir::int_type);
  for (uint32_t r = 0; r < i.result_count; ++r) {
    const ir::ValueId carried = body.parameters[r + 1];
    const ir::Type type = frame.function.type(carried);
    frame.values[carried].clear();
    for (uint32_t c = 0; c < type.width; ++c) frame.values[carried].push_back(unknown(type.scalar, place));
  }
  block(frame, i.blocks[0]);
  if (pool_.too_long()) return;
  for (uint32_t r = 0; r < i.result_count; ++r) {
    const Words& carried = frame.values[body.parameters[r + 1]];
    const Words& next = frame.values[body.yields[r]];
    Words& out = frame.values[i.first_result + r];
    for (size_t c = 0; c < carried.size(); ++c)
      out.push_back(summed(in[r + 1][c], carried[c], next[c], turns, place));
  }
}

/// The number of turns of a loop, if it is known.
std::optional<Side> Flattener::turns_of(uint32_t count) const {
  const Operation& o = pool_[count];
  const auto turns = static_cast<double>(static_cast<int32_t>(o.bits));
  if (o.kind == Kind::constant) return Side{turns, turns};
  if (o.kind != Kind::input) return std::nullopt;
  return Side{pool_.tape().inputs[o.index].lo, pool_.tape().inputs[o.index].hi};
}

/// The result of a loop for a carried value: the sum, if each turn adds to it.
uint32_t Flattener::summed(uint32_t initial, uint32_t carried, uint32_t next, const Side& turns,
                           uint32_t place) {
  const auto is = [&](uint32_t operation, Opcode op) { return pool_[operation].kind == Kind::op && pool_[operation].op == op; };
  // A turn may add nothing: condition ? carried + term : carried.
  uint32_t condition = none, sum = next;
  if (is(next, Opcode::select) && pool_.operands(next)[2] == carried) {
    condition = pool_.operands(next)[0];
    sum = pool_.operands(next)[1];
  }
  const bool adds = is(sum, Opcode::fadd) && pool_.operands(sum)[0] == carried;
  constexpr double most = 1 << 20;
  if (!adds || initial != pool_.constant(Scalar::floating, 0) || turns.hi > most)
    return unknown(pool_[carried].scalar, place);
  if (turns.hi <= 0) return initial;
  // If the term reads values of earlier turns, it contains the unknown of `carried`.
  uint32_t term = pool_.operands(sum)[1];
  if (condition != none) term = pool_.make_op(Opcode::select, {condition, term, initial}, Scalar::floating, place);
  const bool fixed = turns.lo == turns.hi;
  return pool_.make(
      {.kind = Kind::sum, .index = static_cast<uint32_t>(turns.hi), .bits = fixed ? 1u : 0u, .place = place},
      std::array{term});
}

}  // namespace

bool flatten(Pool& pool, uint32_t function, const std::vector<Given>& given,
             const std::function<std::vector<Given>(uint32_t)>& outside) {
  Tape& tape = pool.tape();
  Flattener flattener(pool, outside);
  const ir::Function& entry = tape.module.functions[function];
  support::assert_that(given.size() == entry.parameters.size(), "not every parameter is given");
  std::vector<Words> arguments;
  for (size_t i = 0; i < given.size(); ++i)
    arguments.push_back(flattener.input(given[i], entry.parameters[i].type));
  const std::vector<Words> results = flattener.call(function, arguments, 0);
  if (pool.too_long()) return false;
  for (size_t i = 0; i < results.size(); ++i) {
    const ir::Result& result = entry.results[i];
    for (uint32_t c = 0; c < results[i].size(); ++c)
      tape.outputs.push_back({component_name({result.name}, result.type, c), results[i][c]});
  }
  return true;
}

}  // namespace isoshade::prove
