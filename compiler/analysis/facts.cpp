// SPDX-License-Identifier: Apache-2.0
// What is known of operations beside what their operands say: of scalar products, of what grows with something.
#include <algorithm>
#include <cmath>

#include "compiler/analysis/evaluate.h"

namespace isoshade::analysis {
namespace {

using ir::Opcode;

// Wide margins around a few roundings (2^-24 each) and what unit vectors are off.
constexpr double rounded_up = 1 + 0x1p-19, rounded_down = 1 - 0x1p-18;
/// More than what flushing takes from a sum of products.
constexpr double flushed = 0x1p-120;

}  // namespace

/// False if the facts contradict what the operands say: then no input leads here.
bool Evaluator::apply_facts(const Operation& operation, uint32_t index) {
  const auto found = tape_.facts.find(index);
  if (found == tape_.facts.end()) return true;
  bool possible = true;
  const auto usable = [&](uint32_t fact) { return fact != none && states_[fact] != State::dead; };
  const auto in = tape_.operands_of(operation);
  for (const Fact& fact : found->second) {
    switch (fact.kind) {
      case Fact::Kind::dot: {
        const size_t half = in.size() / 2;
        const auto square_of = [&](double length, uint32_t known, std::span<const uint32_t> vector) {
          double most = 0;
          for (const uint32_t c : vector) most += bounds_[c].magnitude() * bounds_[c].magnitude();
          most = std::min(most, length * length);
          if (usable(known)) most = std::min(most, bounds_[known].hi * rounded_up + flushed);
          return most;
        };
        const double squares = square_of(fact.first_length, fact.first, in.first(half)) *
                               square_of(fact.second_length, fact.second, in.subspan(half));
        const double most = std::sqrt(squares) * rounded_up + flushed;
        possible &= restrict(index, -most, most);
        break;
      }
      case Fact::Kind::projection: {
        // Each of the two products is off by 3 roundings of at most 1, and their sum by one more.
        if (!usable(fact.first)) break;
        const double most =
            std::sqrt(bounds_[fact.first].hi * rounded_up + flushed) * rounded_up + 8 * half_ulp;
        possible &= restrict(index, -most, most);
        break;
      }
      case Fact::Kind::rotation: {
        // Rounding moves u x w by some 2^-22 |w|: where that matters, w is along u, and (u . w)^2 is |w|^2.
        if (!usable(fact.first)) break;
        if (fact.third != none && bounds_[fact.third].least_magnitude() == 0) break;
        const double r = std::min(1.0, bounds_[fact.second].least_magnitude());
        propose(index, {fact.first, r * r * rounded_down, flushed});
        possible &= restrict(index, r * r * rounded_down * bounds_[fact.first].lo - flushed, largest);
        break;
      }
      case Fact::Kind::half:
        if (usable(fact.first)) propose(index, {fact.first, 0.5 * rounded_down, 0});
        break;
    }
  }
  return possible;
}

void Evaluator::propose(uint32_t index, const Proportion& proportion) {
  if (proportion.base == none || proportion.factor <= 0 || bounds_[proportion.base].lo < 0) return;
  for (Proportion& place : proportions_[index]) {
    if (place.base != none && place.base != proportion.base) continue;
    if (place.base == none || place.factor < proportion.factor) place = proportion;
    return;
  }
}

void Evaluator::carry_proportion(const Operation& operation, uint32_t index) {
  const auto in = tape_.operands_of(operation);
  if (operation.kind == Kind::greatest) {
    for (const uint32_t operand : in) {
      const bool fixed = tape_.operations[operand].kind == Kind::constant;
      if (!fixed) propose(index, {operand, 1, 0});
      for (const Proportion& p : proportions_[operand]) propose(index, p);
    }
  }
  if (operation.kind != Kind::op) return;
  if (operation.op == Opcode::fdiv)
    for (const Proportion& p : proportions_[in[1]]) limit_quotient(index, p);
  if (operation.op != Opcode::fmul) return;
  for (const int i : {0, 1}) {
    const Bound& other = bounds_[in[1 - i]];
    if (other.lo <= 0) continue;
    for (const Proportion& p : proportions_[in[i]])
      propose(index, {p.base, p.factor * other.lo * rounded_down, p.slack * other.hi * rounded_up + flushed});
  }
}

/// a / b where b >= factor * base - slack, and a is the base or a multiple of it.
void Evaluator::limit_quotient(uint32_t index, const Proportion& p) {
  const auto in = tape_.operands_of(tape_.operations[index]);
  const double least = bounds_[in[1]].lo;
  if (p.base == none || least <= 0) return;
  const Operation& dividend = tape_.operations[in[0]];
  double multiple = 0;
  if (in[0] == p.base) multiple = 1;
  if (dividend.kind == Kind::op && dividend.op == Opcode::fmul) {
    const auto factors = tape_.operands_of(dividend);
    for (const int i : {0, 1})
      if (factors[i] == p.base) multiple = bounds_[factors[1 - i]].magnitude();
  }
  if (multiple == 0) return;
  // The float that is nearest to a quotient of at most 1 is at most 1.
  const bool exact = multiple == 1 && p.factor == 1 && p.slack == 0;
  // base / b is largest where factor * base - slack is the least that b is anyway.
  const double most =
      exact ? 1 : multiple * (least + p.slack) / (p.factor * least) * rounded_up + flushed / least;
  restrict(index, -most, most);
}

}  // namespace isoshade::analysis
