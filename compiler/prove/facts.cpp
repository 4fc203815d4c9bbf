// SPDX-License-Identifier: Apache-2.0
// Facts about operations beyond the bounds of their operands: about scalar products, and proportions.
#include <algorithm>
#include <cmath>

#include "compiler/prove/evaluate.h"
#include "compiler/interface/binding.h"

namespace isoshade::prove {
namespace {

using ir::Opcode;

// Wide margins for a few roundings (2^-24 each) and the lengths of unit vectors.
constexpr double rounded_up = 1 + 0x1p-19, rounded_down = 1 - 0x1p-18;
/// More than the error by flushing of a sum of products.
constexpr double flushed = 0x1p-120;

}  // namespace

/// False if the facts contradict the operands: then no input leads here.
bool Evaluator::apply_facts(const Operation& operation, uint32_t index) {
  if (facts_of_[index] == nullptr) return true;
  bool possible = true;
  const auto usable = [&](uint32_t fact) { return fact != none && states_[fact] != State::dead; };
  const auto in = tape_.operands_of(operation);
  for (const Fact& fact : *facts_of_[index]) {
    switch (fact.kind) {
      case Fact::Kind::dot: {
        const Lengths a = lengths_of(fact.left), b = lengths_of(fact.right);
        const double most = a.vector * b.vector * rounded_up + flushed;
        possible &= restrict(index, -most, most);
        limit_error(index, in.size() / 2, a, b);
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
        // Rounding moves u x w by about 2^-22 |w|: if that matters, w is parallel to u and (u . w)^2 is |w|^2.
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

Evaluator::Lengths Evaluator::lengths_of(uint32_t index) const {
  const VectorShape& shape = tape_.vectors[index];
  double squares = 0, errors = 0;
  for (const uint32_t c : shape.components) {
    squares += bounds_[c].magnitude() * bounds_[c].magnitude();
    errors += bounds_[c].absolute * bounds_[c].absolute;
  }
  squares = std::min(squares, shape.length * shape.length);
  if (shape.square != none && states_[shape.square] != State::dead)
    squares = std::min(squares, bounds_[shape.square].hi * rounded_up + flushed);
  Lengths lengths{std::sqrt(squares) * rounded_up, std::sqrt(errors) * rounded_up};
  if (shape.kind == VectorShape::Kind::given) return lengths;
  const Lengths a = lengths_of(shape.left), b = lengths_of(shape.right);
  if (shape.kind == VectorShape::Kind::sum) {
    lengths.error = std::min(lengths.error, a.error + b.error + half_ulp * lengths.vector + flushed);
    return lengths;
  }
  // Each component rounds two products and their difference: an error of at most 2 sqrt(2) |a| |b| / 2^24.
  const double carried = a.vector * b.error + a.error * b.vector + a.error * b.error;
  const double error = carried + 3 * half_ulp * a.vector * b.vector + flushed;
  if (std::isnan(error)) return lengths;
  lengths.vector =
      std::min(lengths.vector, a.vector * b.vector + 3 * half_ulp * a.vector * b.vector + flushed);
  lengths.error = std::min(lengths.error, error * rounded_up);
  return lengths;
}

/// The error of a scalar product by those of its vectors, by the inequality of Cauchy and Schwarz.
void Evaluator::limit_error(uint32_t index, size_t terms, const Lengths& a, const Lengths& b) {
  if (!std::isfinite(a.error) || !std::isfinite(b.error)) return;
  const double carried = a.vector * b.error + a.error * b.vector + a.error * b.error;
  const double roundings = static_cast<double>(terms) * half_ulp * a.vector * b.vector;
  const double error = (carried + roundings) * rounded_up + flushed;
  Bound& bound = bounds_[index];
  if (error >= bound.absolute) return;
  bound.absolute = error;
  bound = settled(bound).bound;
}

/// The bound of a host's answer, where rounding may have moved the question.
Outcome Evaluator::answer_of(Answer answer, std::span<const uint32_t> in) const {
  Bound r = bounds_[in[0]];
  // The box may contain only some of the answers, but the exact one may be any of them.
  const Input& all = tape_.inputs[tape_.operations[in[0]].index];
  const double range = std::max(r.hi - all.lo, all.hi - r.lo);
  double error = 0;
  for (const uint32_t question : in.subspan(1)) error = std::max(error, bounds_[question].absolute);
  switch (answer) {
    case Answer::same: r.absolute = error == 0 ? 0 : range; break;
    case Answer::other: r.absolute = range; break;
    case Answer::filtered: {
      // A coordinate is wrapped into [0, 1], multiplied by the size, and half a texel is subtracted: a few roundings of
      // numbers up to the size. Between texels the slope is at most their range.
      const double texels =
          interface::max_size * (bounds_[in[2]].absolute + bounds_[in[3]].absolute + 4 * 4 * half_ulp);
      r.absolute = std::min(range, (all.hi - all.lo) * texels) + 8 * half_ulp * r.magnitude() + 4 * smallest;
      break;
    }
    case Answer::quotient: r.absolute = error == 0 ? 4 * half_ulp * r.magnitude() : range; break;
    case Answer::unknown: r.absolute = HUGE_VAL; break;
  }
  r.relative = r.slack = HUGE_VAL;
  return settled(r);
}

void Evaluator::propose(uint32_t index, const Proportion& proportion) {
  if (proportion.base == none || proportion.factor <= 0 || bounds_[proportion.base].lo < 0) return;
  for (Proportion& place : proportions_[index]) {
    if (place.base != none && place.base != proportion.base) continue;
    if (place.base == none || place.factor < proportion.factor) place = proportion;
    return;
  }
}

/// (k * x) * x has the sign of k.
void Evaluator::limit_square(uint32_t index) {
  const auto in = tape_.operands_of(tape_.operations[index]);
  for (const int i : {0, 1}) {
    const Operation& scaled = tape_.operations[in[i]];
    if (scaled.kind != Kind::op || scaled.op != Opcode::fmul) continue;
    const auto factors = tape_.operands_of(scaled);
    for (const int f : {0, 1}) {
      if (factors[f] != in[1 - i]) continue;
      const Bound& k = bounds_[factors[1 - f]];
      Bound& b = bounds_[index];
      if (k.lo >= 0) b.lo = std::max(b.lo, 0.0);
      if (k.hi <= 0) b.hi = std::min(b.hi, 0.0);
      if (k.exact_lo() >= 0) b.exact_least = std::max(b.exact_least, 0.0);
      if (k.exact_hi() <= 0) b.exact_most = std::min(b.exact_most, 0.0);
      b = settled(b).bound;
    }
  }
}

/// x - x * y, where x >= 0 and y is in [0, 1], lies in [0, x], both computed and exactly.
void Evaluator::limit_remainder(uint32_t index) {
  const auto in = tape_.operands_of(tape_.operations[index]);
  const Operation& product = tape_.operations[in[1]];
  const Bound& x = bounds_[in[0]];
  if (product.kind != Kind::op || product.op != Opcode::fmul || x.lo < 0 || x.exact_lo() < 0) return;
  const auto factors = tape_.operands_of(product);
  for (const int i : {0, 1}) {
    const Bound& y = bounds_[factors[1 - i]];
    if (factors[i] != in[0] || y.lo < 0 || y.hi > 1 || y.exact_lo() < 0 || y.exact_hi() > 1) continue;
    Bound& b = bounds_[index];
    b.lo = std::max(b.lo, 0.0);
    b.hi = std::min(b.hi, x.hi);
    b.exact_least = std::max(b.exact_least, 0.0);
    b.exact_most = std::min(b.exact_most, x.exact_hi());
    b = settled(b).bound;
    return;
  }
}

/// (k - x) - c, where x = k - c: the rounding error of x; exactly 0.
void Evaluator::limit_residual(uint32_t index) {
  const auto in = tape_.operands_of(tape_.operations[index]);
  const auto difference = [&](uint32_t operation) {
    const Operation& o = tape_.operations[operation];
    const bool is = o.kind == Kind::op && o.op == Opcode::fsub;
    return is ? tape_.operands_of(o) : std::span<const uint32_t>();
  };
  const auto back = difference(in[0]);
  const auto x = back.empty() ? back : difference(back[1]);
  if (x.empty() || x[0] != back[0] || x[1] != in[1]) return;
  // If x is exact, k - x is c, a float, and so exact, too.
  const double rounding = half_ulp * (bounds_[back[1]].magnitude() + bounds_[in[0]].magnitude());
  const double most = bounds_[back[1]].absolute == 0 ? 0 : rounding * rounded_up + flushed;
  restrict(index, -most, most);
  Bound& b = bounds_[index];
  b.exact_least = b.exact_most = 0;
  b = settled(b).bound;
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
  if (operation.op == Opcode::fsub) {
    limit_remainder(index);
    limit_residual(index);
  }
  if (operation.op == Opcode::fdiv)
    for (const Proportion& p : proportions_[in[1]]) limit_quotient(index, p);
  if (operation.op != Opcode::fmul) return;
  limit_square(index);
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
  // A quotient of at most 1 is rounded to at most 1.
  const bool exact = multiple == 1 && p.factor == 1 && p.slack == 0;
  // base / b is largest where factor * base - slack is the lower bound of b.
  const double most =
      exact ? 1 : multiple * (least + p.slack) / (p.factor * least) * rounded_up + flushed / least;
  restrict(index, -most, most);
}

}  // namespace isoshade::prove
