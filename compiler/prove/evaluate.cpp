// SPDX-License-Identifier: Apache-2.0
#include "compiler/prove/evaluate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "compiler/support/assert.h"

namespace isoshade::prove {
namespace {

using ir::Opcode;

Outcome constant_outcome(const Operation& operation) {
  if (operation.scalar != ir::Scalar::floating)
    return {exactly(static_cast<double>(static_cast<int32_t>(operation.bits)))};
  const auto value = static_cast<double>(std::bit_cast<float>(operation.bits));
  if (std::isnan(value)) return {anything(), Breach::unknown};
  // Library functions compare with infinity; a number beyond the floats stands for it.
  return {exactly(std::clamp(value, -4 * largest, 4 * largest))};
}

/// Whether it is min(constant, max(constant, x)), in any order of operands, or smoothstep, which clamps.
bool is_clamp(const Tape& tape, const Operation& operation) {
  if (operation.kind == Kind::row) return tape.rows[operation.index].rule->row == "smoothstep";
  if (operation.kind != Kind::least) return false;
  const auto in = tape.operands_of(operation);
  const auto is = [&](uint32_t o, Kind kind) { return tape.operations[o].kind == kind; };
  for (const int i : {0, 1}) {
    if (!is(in[i], Kind::constant) || !is(in[1 - i], Kind::greatest)) continue;
    for (const uint32_t o : tape.operands_of(tape.operations[in[1 - i]]))
      if (is(o, Kind::constant)) return true;
  }
  return false;
}

}  // namespace

Evaluator::Evaluator(const Tape& tape)
    : tape_(tape),
      cut_of_(tape.operations.size(), none),
      accepted_(tape.operations.size()),
      facts_of_(tape.operations.size()),
      bounds_(tape.operations.size()),
      states_(tape.operations.size()),
      proportions_(tape.operations.size()),
      guard_dead_(tape.guards.size()) {
  for (uint32_t i = 0; i < tape.operations.size(); ++i) {
    const Operation& operation = tape.operations[i];
    if (operation.kind != Kind::dot && !is_clamp(tape, operation)) continue;
    cut_of_[i] = static_cast<uint32_t>(cuts_.size());
    cuts_.push_back(i);
  }
  for (const auto& [operation, facts] : tape.facts) facts_of_[operation] = &facts;
}

Box Evaluator::whole() const {
  Box box;
  for (const Input& input : tape_.inputs) box.push_back({input.lo, input.hi});
  box.resize(side_count(), {-largest, largest});
  return box;
}

Side Evaluator::reached(const Box& box, size_t side) const {
  if (side < tape_.inputs.size()) return box[side];
  const uint32_t cut = cuts_[side - tape_.inputs.size()];
  if (states_[cut] == State::dead) return box[side];
  const Bound& b = bounds_[cut];
  return {b.lo, b.hi};
}

std::string Evaluator::side_name(size_t side) const {
  if (side < tape_.inputs.size()) return tape_.inputs[side].name;
  return tape_.places[tape_.operations[cuts_[side - tape_.inputs.size()]].place].node;
}

std::vector<Evaluator::Dependence> Evaluator::dependence(uint32_t operation) const {
  std::vector<Dependence> of(operation + 1), sides(side_count());
  of[operation] = Dependence::direct;
  for (uint32_t i = operation + 1; i-- > 0;) {
    if (of[i] == Dependence::none) continue;
    const Operation& o = tape_.operations[i];
    if (o.kind == Kind::input) sides[o.index] = std::max(sides[o.index], of[i]);
    Dependence of_operands = of[i];
    if (cut_of_[i] != none) {
      sides[tape_.inputs.size() + cut_of_[i]] = of[i];
      if (i != operation) of_operands = Dependence::indirect;
    }
    const auto need = [&](uint32_t other) {
      if (other < i) of[other] = std::max(of[other], of_operands);
    };
    for (const uint32_t operand : tape_.operands_of(o)) need(operand);
    for (uint32_t guard = o.guard; guard != 0; guard = tape_.guards[guard].parent)
      need(tape_.guards[guard].condition);
    if (facts_of_[i] != nullptr)
      for (const Fact& fact : *facts_of_[i])
        for (const uint32_t other : {fact.first, fact.second}) need(other);
  }
  return sides;
}

/// Whether the box contains vectors of length 1, for the inputs that are components of unit vectors.
bool Evaluator::units_possible(const Box& box) const {
  for (size_t i = 0; i < tape_.inputs.size();) {
    const uint32_t vector = tape_.inputs[i].vector;
    double least = 0, most = 0;
    size_t next = i;
    for (; next < tape_.inputs.size() && tape_.inputs[next].vector == vector; ++next) {
      const Bound side = between(box[next].lo, box[next].hi);
      least += side.least_magnitude() * side.least_magnitude();
      most += side.magnitude() * side.magnitude();
      if (vector == none) break;
    }
    if (vector != none && (least > 1 + 4 * unit_tolerance || most < 1 - 4 * unit_tolerance)) return false;
    i = std::max(next, i + 1);
  }
  return true;
}

bool Evaluator::walk(const Box& box, uint32_t last) {
  findings_.clear();
  undecided_.clear();
  guard_dead_.assign(tape_.guards.size(), false);
  if (!units_possible(box)) return false;
  steps_ += std::max<size_t>(last + 1, box.size());  // boxes of thousands of inputs cost time and memory too
  for (uint32_t i = 0; i <= last; ++i) {
    const Operation& operation = tape_.operations[i];
    proportions_[i] = {};
    if (operation.kind == Kind::enter) {
      enter(operation);
      continue;
    }
    if (guard_dead_[operation.guard]) {
      states_[i] = State::dead;
      continue;
    }
    states_[i] = State::good;
    const auto operands = tape_.operands_of(operation);
    for (const uint32_t operand : operands)
      if (states_[operand] == State::doubtful) states_[i] = State::doubtful;
    if (operation.kind == Kind::narrow) {
      if (!narrow(operation, i)) guard_dead_[operation.guard] = true;
      continue;
    }
    if (operation.kind == Kind::input) {
      bounds_[i] = between(box[operation.index].lo, box[operation.index].hi);
      continue;
    }
    const Outcome outcome = outcome_of(operation, i);
    bounds_[i] = outcome.bound;
    if (states_[i] == State::dead) {
      if (operation.guard == 0) return false;
      guard_dead_[operation.guard] = true;
      continue;
    }
    if (outcome.breach != Breach::none) {
      const bool first = states_[i] == State::good;
      if (first) findings_.push_back({i, outcome.breach, severity_of(operation, outcome.breach)});
      if (!accepted_[i]) states_[i] = State::doubtful;
    }
    if (!apply_facts(operation, i)) {
      if (operation.guard == 0) return false;
      guard_dead_[operation.guard] = true;
      states_[i] = State::dead;
      continue;
    }
    carry_proportion(operation, i);
    if (cut_of_[i] == none) continue;
    const Side& side = box[tape_.inputs.size() + cut_of_[i]];
    if (restrict(i, side.lo, side.hi)) continue;
    if (operation.guard == 0) return false;
    guard_dead_[operation.guard] = true;
    states_[i] = State::dead;
  }
  return true;
}

/// Intersects a bound with a range; false if that is empty.
bool Evaluator::restrict(uint32_t index, double lo, double hi) {
  Bound& b = bounds_[index];
  if (lo > b.hi || hi < b.lo) return false;
  if (lo <= b.lo && hi >= b.hi) return true;
  b.lo = std::max(b.lo, lo);
  b.hi = std::min(b.hi, hi);
  b = settled(b).bound;  // a relative error is a smaller absolute error of smaller values
  return true;
}

void Evaluator::enter(const Operation& operation) {
  const Guard& guard = tape_.guards[operation.index];
  if (guard_dead_[guard.parent] || states_[guard.condition] == State::dead) {
    guard_dead_[operation.index] = true;
    return;
  }
  const Bound& condition = bounds_[guard.condition];
  guard_dead_[operation.index] = condition.is_point() && (condition.lo != 0) != guard.truth;
}

/// Intersects the operand with what the comparison implies; false if it cannot hold.
bool Evaluator::narrow(const Operation& operation, uint32_t index) {
  const auto in = tape_.operands_of(operation);
  bounds_[index] = bounds_[in[0]];
  proportions_[index] = proportions_[in[0]];
  const Bound& by = bounds_[in[1]];
  // The next float below; zero is next to the smallest normal floats.
  const auto below = [](double x) {
    if (x > -smallest && x <= smallest) return x > 0 ? 0.0 : -smallest;
    return static_cast<double>(std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::max()));
  };
  const auto above = [&](double x) { return -below(-x); };
  using enum ir::RangeRule;
  const ir::RangeRule orders = ir::info(operation.op).range;
  if (orders != not_equal) {
    const bool or_equal = ir::accepts(orders, equal);
    const double least = or_equal ? by.lo : above(by.lo), most = or_equal ? by.hi : below(by.hi);
    return restrict(index, ir::accepts(orders, less) ? -largest : least,
                    ir::accepts(orders, greater) ? largest : most);
  }
  const Bound& all = bounds_[index];
  if (!by.is_point()) return true;
  if (all.lo == by.lo) return restrict(index, above(by.lo), largest);
  if (all.hi == by.lo) return restrict(index, -largest, below(by.lo));
  return true;
}

Outcome Evaluator::outcome_of(const Operation& operation, uint32_t index) {
  const auto in = tape_.operands_of(operation);
  switch (operation.kind) {
    case Kind::constant: return constant_outcome(operation);
    case Kind::least: return least_of(in);
    case Kind::greatest: return {greater(bounds_[in[0]], bounds_[in[1]])};
    case Kind::dot: return dot_of(in);
    case Kind::sum: return sum_of(bounds_[in[0]], operation.index);
    case Kind::asked: return answer_of(static_cast<Answer>(operation.index), in);
    case Kind::unknown: return {anything(), Breach::unknown};
    case Kind::op: break;
    case Kind::row: {
      arguments_.clear();
      for (const uint32_t operand : in) arguments_.push_back(bounds_[operand]);
      return bound_of(*tape_.rows[operation.index].rule, arguments_, operation.component, tape_.tier);
    }
    case Kind::input:
    case Kind::narrow:
    case Kind::enter: return {bounds_[index]};
  }
  if (operation.op != Opcode::select)
    return bound_of(operation.op, bounds_[in[0]], bounds_[in[in.size() > 1 ? 1 : 0]],
                    in.size() > 1 && in[0] == in[1]);
  Outcome chosen = select_of(in, index);
  const bool no_then = states_[in[1]] == State::dead, no_other = states_[in[2]] == State::dead;
  if (no_then && no_other) states_[index] = State::dead;
  return chosen;
}

Outcome Evaluator::select_of(std::span<const uint32_t> in, uint32_t index) {
  Bound condition = bounds_[in[0]];
  if (condition.absolute != 0) undecided_.push_back(index);
  if (follows_branches_) condition.absolute = 0;
  const Bound &then = bounds_[in[1]], &other = bounds_[in[2]];
  const bool no_then = states_[in[1]] == State::dead, no_other = states_[in[2]] == State::dead;
  if (!no_then && !no_other) return {select(condition, then, other)};
  Bound taken = no_then ? other : then;
  // The bound of the side that exact arithmetic may take instead was not computed.
  if (condition.absolute != 0) {
    const Bound unknown = anything();
    taken = {taken.lo, taken.hi, unknown.absolute, unknown.relative, unknown.slack};
  }
  return {taken};
}

Outcome Evaluator::least_of(std::span<const uint32_t> in) const {
  Bound least = lesser(bounds_[in[0]], bounds_[in[1]]);
  const auto end = [&](uint32_t operand) {
    const Operation& o = tape_.operations[operand];
    return o.kind == Kind::constant ? std::optional(bounds_[operand].lo) : std::nullopt;
  };
  // Both the computed and the exact result lie between the two constants of a clamp.
  for (const int i : {0, 1}) {
    const Operation& inner = tape_.operations[in[i]];
    const auto high = end(in[1 - i]);
    if (!high || inner.kind != Kind::greatest) continue;
    for (const uint32_t operand : tape_.operands_of(inner))
      if (const auto low = end(operand); low && *low <= *high)
        least.absolute = std::min(least.absolute, *high - *low);
  }
  return settled(least);
}

Outcome Evaluator::dot_of(std::span<const uint32_t> in) const {
  const size_t half = in.size() / 2;
  Outcome sum;
  Breach breach = Breach::none;
  for (size_t i = 0; i < half; ++i) {
    const uint32_t a = in[i], b = in[half + i];
    const Outcome product = a == b ? square(bounds_[a]) : multiply(bounds_[a], bounds_[b]);
    if (product.breach != Breach::none) breach = product.breach;
    sum = i == 0 ? product : add(sum.bound, product.bound);
    if (sum.breach != Breach::none) breach = sum.breach;
  }
  return {sum.bound, breach};
}

double Evaluator::severity_of(const Operation& operation, Breach breach) const {
  const auto in = tape_.operands_of(operation);
  const auto exponent = [&](uint32_t operand, bool least) {
    const Bound& b = bounds_[operand];
    return std::log2(std::max(least ? b.least_magnitude() : b.magnitude(), smallest));
  };
  double sum = 1;
  switch (breach) {
    case Breach::overflow:
      for (const uint32_t operand : in) sum += std::max(0.0, exponent(operand, false));
      if (operation.kind == Kind::op && operation.op == Opcode::fdiv)
        sum += 256 - exponent(in[1], true) - std::max(0.0, exponent(in[1], false));
      return sum;
    case Breach::division_by_zero: return 1 + bounds_[in.back()].hi - bounds_[in.back()].lo;
    case Breach::none:
    case Breach::root_of_negative:
    case Breach::logarithm:
    case Breach::power:
    case Breach::arc:
    case Breach::conversion:
    case Breach::domain:
    case Breach::unknown: break;
  }
  const Bound& first = bounds_[in.empty() ? 0 : in[0]];
  return 1 - first.lo + first.hi;
}

}  // namespace isoshade::prove
