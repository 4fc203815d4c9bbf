// SPDX-License-Identifier: Apache-2.0
#include "compiler/prove/sample.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "compiler/ir/evaluate.h"

namespace isoshade::prove {
namespace {

using ir::Opcode;

float as_float(uint32_t word) { return std::bit_cast<float>(word); }
uint32_t as_word(float value) { return ir::flush_denormal(std::bit_cast<uint32_t>(value)); }
bool is_finite(uint32_t word) { return (word & ir::infinity_bits) != ir::infinity_bits; }

/// Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014.
class Random {
 public:
  uint64_t next() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  uint32_t below(uint32_t count) { return static_cast<uint32_t>((next() >> 32) * count >> 32); }
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

 private:
  uint64_t state_ = 6;
};

class Points {
 public:
  Points(const Tape& tape, const Box& box) : tape_(tape), box_(box), words_(tape.inputs.size()) {}

  const std::vector<uint32_t>& next() {
    vectors_.clear();
    for (uint32_t i = 0; i < words_.size();) i = tape_.inputs[i].vector == none ? number(i) : vector(i);
    return words_;
  }

 private:
  uint32_t number(uint32_t i);
  uint32_t vector(uint32_t first);
  double pick(double lo, double hi, uint32_t i);

  const Tape& tape_;
  const Box& box_;
  Random random_;
  std::vector<uint32_t> words_;
  std::vector<std::pair<uint32_t, uint32_t>> vectors_;  ///< the first component and the width of former ones
};

double Points::pick(double lo, double hi, uint32_t i) {
  const double size = hi - lo;
  switch (random_.below(8)) {
    case 0: return lo;
    case 1: return hi;
    case 2: return lo + size * std::exp2(-40 * random_.unit());
    case 3: return hi - size * std::exp2(-40 * random_.unit());
    case 4: return std::clamp(static_cast<double>(static_cast<int>(random_.below(3)) - 1), lo, hi);
    case 5: {
      if (i == 0) break;
      const uint32_t other = random_.below(i);
      const bool is_float = tape_.inputs[other].scalar == ir::Scalar::floating;
      const auto value = is_float ? static_cast<double>(as_float(words_[other]))
                                  : static_cast<double>(static_cast<int32_t>(words_[other]));
      return std::clamp(value, lo, hi);
    }
    case 6:
      if (lo <= 0) break;
      return lo * std::pow(hi / lo, random_.unit());
    default: break;
  }
  return lo + size * random_.unit();
}

uint32_t Points::number(uint32_t i) {
  const Side& side = box_[i];
  if (tape_.inputs[i].scalar == ir::Scalar::floating) {
    const auto value = static_cast<float>(pick(side.lo, side.hi, i));
    words_[i] = as_word(std::clamp(value, static_cast<float>(side.lo), static_cast<float>(side.hi)));
  } else {
    const double range = side.hi - side.lo + 1;
    const double value = side.lo + std::floor(std::min(random_.unit() * range, range - 1));
    words_[i] = static_cast<uint32_t>(static_cast<int64_t>(value));
  }
  return i + 1;
}

uint32_t Points::vector(uint32_t first) {
  uint32_t end = first;
  while (end < words_.size() && tape_.inputs[end].vector == tape_.inputs[first].vector) ++end;
  const uint32_t width = end - first;
  std::array<double, 4> v{};
  const uint32_t way = random_.below(6);
  if (way == 0) v[random_.below(width)] = random_.below(2) == 0 ? 1 : -1;
  double length = 0;
  while (length < 1e-3) {
    if (way != 0)
      for (uint32_t c = 0; c < width; ++c) v[c] = 2 * random_.unit() - 1;
    if (way >= 3 && !vectors_.empty()) {
      // Parallel, opposite or perpendicular to an earlier vector, or nearly so.
      const auto [other, other_width] = vectors_[random_.below(static_cast<uint32_t>(vectors_.size()))];
      const double near = random_.below(2) == 0 ? 0 : std::exp2(-40 * random_.unit());
      double cosine = 0;
      for (uint32_t c = 0; c < std::min(width, other_width); ++c)
        cosine += v[c] * static_cast<double>(as_float(words_[other + c]));
      for (uint32_t c = 0; c < std::min(width, other_width); ++c) {
        const auto along = static_cast<double>(as_float(words_[other + c]));
        v[c] = way == 3 ? along + near * v[c] : way == 4 ? -along + near * v[c] : v[c] - cosine * along;
      }
    }
    length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
  }
  for (uint32_t c = 0; c < width; ++c) words_[first + c] = as_word(static_cast<float>(v[c] / length));
  vectors_.emplace_back(first, width);
  return end;
}

}  // namespace

TapeRunner::TapeRunner(const Tape& tape)
    : tape_(tape),
      interpreter_(tape.module, ir::Preconditions::report),
      words_(tape.operations.size()),
      guard_holds_(tape.guards.size(), true),
      after_breach_(tape.operations.size()),
      guard_after_breach_(tape.guards.size()) {}

uint32_t TapeRunner::dot(const Operation& operation) const {
  const auto in = tape_.operands_of(operation);
  const size_t half = in.size() / 2;
  uint32_t sum = 0;
  for (size_t i = 0; i < half; ++i) {
    const uint32_t product = ir::evaluate(Opcode::fmul, words_[in[i]], words_[in[half + i]], 0);
    sum = i == 0 ? product : ir::evaluate(Opcode::fadd, sum, product, 0);
  }
  return sum;
}

uint32_t TapeRunner::row(const Operation& operation) {
  const Row& row = tape_.rows[operation.index];
  const auto in = tape_.operands_of(operation);
  const ir::Function& function = tape_.module.functions[row.function];
  // A row that works componentwise has the operands of one component: it computes all alike.
  const bool componentwise = is_componentwise(row.rule->row);
  std::vector<uint32_t> arguments;
  size_t next = 0;
  for (const ir::Parameter& parameter : function.parameters) {
    for (uint32_t c = 0; c < parameter.type.width; ++c)
      arguments.push_back(words_[in[componentwise ? next : next++]]);
    if (componentwise) ++next;
  }
  std::vector<uint32_t> results(row.words);
  interpreter_.run(row.function, arguments, results);
  return results[operation.component];
}

Breach TapeRunner::breach_of(const Operation& operation, uint32_t index) const {
  const auto in = tape_.operands_of(operation);
  if (operation.kind == Kind::op && operation.op == Opcode::ftoi) {
    const bool fits = ir::holds(ir::Precondition::finite_in_int_range, words_[in[0]], 0);
    return fits ? Breach::none : Breach::conversion;
  }
  if (operation.kind == Kind::op && operation.op == Opcode::fdiv && (words_[in[1]] << 1) == 0)
    return Breach::division_by_zero;
  const bool given =
      operation.kind == Kind::constant || operation.kind == Kind::input || operation.kind == Kind::asked;
  if (given || operation.scalar != ir::Scalar::floating || is_finite(words_[index])) return Breach::none;
  if (operation.kind == Kind::op && operation.op == Opcode::fsqrt) return Breach::root_of_negative;
  if (operation.kind != Kind::row) return Breach::overflow;
  std::vector<Bound> arguments;
  for (const uint32_t operand : in)
    arguments.push_back(exactly(static_cast<double>(as_float(words_[operand]))));
  const Breach breach =
      bound_of(*tape_.rows[operation.index].rule, arguments, operation.component, tape_.tier).breach;
  return breach == Breach::none ? Breach::overflow : breach;
}

void TapeRunner::compute(const Operation& operation, uint32_t index, std::span<const uint32_t> inputs) {
  const auto in = tape_.operands_of(operation);
  uint32_t& word = words_[index];
  switch (operation.kind) {
    case Kind::constant: word = operation.bits; break;
    case Kind::input: word = inputs[operation.index]; break;
    case Kind::op:
      word = ir::evaluate(operation.op, words_[in[0]], in.size() > 1 ? words_[in[1]] : 0,
                          in.size() > 2 ? words_[in[2]] : 0);
      break;
    case Kind::least:
    case Kind::greatest: {
      const Opcode replaces = operation.kind == Kind::least ? Opcode::fgt : Opcode::flt;
      word = words_[in[ir::evaluate(replaces, words_[in[0]], words_[in[1]], 0)]];
      break;
    }
    case Kind::dot: word = dot(operation); break;
    case Kind::row: word = row(operation); break;
    case Kind::sum: word = ir::evaluate(Opcode::fadd, 0, words_[in[0]], 0); break;
    case Kind::unknown: word = 0; break;
    case Kind::asked:
    case Kind::narrow: word = words_[in[0]]; break;
    case Kind::enter: {
      const Guard& guard = tape_.guards[operation.index];
      guard_holds_[operation.index] =
          guard_holds_[guard.parent] && (words_[guard.condition] != 0) == guard.truth;
      guard_after_breach_[operation.index] =
          guard_after_breach_[guard.parent] || after_breach_[guard.condition];
      break;
    }
  }
}

bool TapeRunner::follows_breach(const Operation& operation) const {
  if (guard_after_breach_[operation.guard]) return true;
  const auto in = tape_.operands_of(operation);
  if (operation.kind == Kind::op && operation.op == Opcode::select)
    return after_breach_[in[0]] || after_breach_[in[words_[in[0]] != 0 ? 1 : 2]];
  return std::ranges::any_of(in, [&](uint32_t operand) { return after_breach_[operand]; });
}

const std::vector<TapeRunner::Broken>& TapeRunner::run(std::span<const uint32_t> inputs) {
  broken_.clear();
  for (uint32_t i = 0; i < tape_.operations.size(); ++i) {
    const Operation& operation = tape_.operations[i];
    compute(operation, i, inputs);
    if (operation.kind == Kind::enter) continue;
    after_breach_[i] = follows_breach(operation);
    if (after_breach_[i] || operation.kind == Kind::narrow || !guard_holds_[operation.guard]) continue;
    const Breach breach = breach_of(operation, i);
    if (breach == Breach::none) continue;
    after_breach_[i] = true;
    broken_.push_back({i, breach});
  }
  return broken_;
}

std::vector<std::vector<uint32_t>> samples(const Tape& tape, const Box& box, int count) {
  std::vector<std::vector<uint32_t>> all;
  Points points(tape, box);
  for (int i = 0; i < count; ++i) all.push_back(points.next());
  return all;
}

std::vector<Counterexample> search(TapeRunner& runner, const Tape& tape, const Box& box, int tries, size_t most,
                                   const std::function<bool(const std::vector<uint32_t>&)>& allowed) {
  // A sum of a fixed number of terms is not one of them, and the value of an unknown is not known.
  std::vector<bool> is_doubtful(tape.operations.size());
  for (uint32_t i = 0; i < tape.operations.size(); ++i) {
    const Operation& operation = tape.operations[i];
    is_doubtful[i] = operation.kind == Kind::unknown || (operation.kind == Kind::sum && operation.bits != 0);
    for (const uint32_t operand : tape.operands_of(operation))
      if (is_doubtful[operand]) is_doubtful[i] = true;
  }
  std::vector<Counterexample> found;
  std::vector<bool> is_found(tape.operations.size());
  Points points(tape, box);
  for (int i = 0; i < tries && found.size() < most; ++i) {
    const std::vector<uint32_t>& inputs = points.next();
    std::optional<bool> counts;
    for (const TapeRunner::Broken& broken : runner.run(inputs)) {
      if (is_found[broken.operation] || is_doubtful[broken.operation]) continue;
      if (!counts) counts = allowed(inputs);
      if (!*counts || found.size() == most) break;
      is_found[broken.operation] = true;
      found.push_back({inputs, broken});
    }
  }
  return found;
}

}  // namespace isoshade::prove
