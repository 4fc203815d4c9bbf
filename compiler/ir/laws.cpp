// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/laws.h"

#include <array>

#include "compiler/ir/float_bits.h"
#include "compiler/support/assert.h"

namespace isoshade::ir {

namespace {

// What the rows of laws.def are written in.
namespace terms {

constexpr Term constant(uint32_t bits) { return {Term::Kind::constant, {}, bits}; }
constexpr Term x{Term::Kind::any, {}, 0};
constexpr Term zero = constant(0), one = constant(one_bits);
constexpr Term minus_zero = constant(sign_bit), minus_one = constant(one_bits | sign_bit);
constexpr Term int_zero = constant(0), int_one = constant(1), all_bits = constant(~0u);
constexpr Term no = constant(0), yes = constant(1);
#define OP(name, ...) \
  [[maybe_unused]] constexpr Term name(const Term&) { return {Term::Kind::of_any, Opcode::name, 0}; }
#include "compiler/ir/ops.def"

constexpr Law laws[] = {
#define BINARY(op, left, right, is) {Opcode::op, left, right, is},
#define UNARY(op, operand, is) {Opcode::op, operand, {}, is},
#include "compiler/ir/laws.def"
};

}  // namespace terms

constexpr std::array<bool, primitive_count> commuting = [] {
  std::array<bool, primitive_count> ops{};
#define COMMUTES(op) ops[static_cast<size_t>(Opcode::op)] = true;
#include "compiler/ir/laws.def"
  return ops;
}();

struct Section {
  size_t first = 0, count = 0;
};
/// By op: its laws, which stand together.
constexpr std::array<Section, primitive_count> sections = [] {
  std::array<Section, primitive_count> of{};
  for (size_t i = 0; i < std::size(terms::laws); ++i) {
    Section& section = of[static_cast<size_t>(terms::laws[i].op)];
    if (section.count++ == 0) section.first = i;
  }
  return of;
}();
constexpr bool every_section_is_whole = [] {
  for (const Section& section : sections)
    for (size_t i = 1; i < section.count; ++i)
      if (terms::laws[section.first + i].op != terms::laws[section.first].op) return false;
  return true;
}();
static_assert(every_section_is_whole, "the laws of one op stand together in laws.def");

Opcode comparison_of(Rule rule, RangeRule orders) {
  for (int i = 0; i < primitive_count; ++i) {
    const auto op = static_cast<Opcode>(i);
    if (info(op).rule == rule && info(op).range == orders) return op;
  }
  support::bug("no such comparison");
}

}  // namespace

std::span<const Law> laws_of(Opcode op) {
  if (!is_primitive(op)) return {};
  const Section& section = sections[static_cast<size_t>(op)];
  return std::span(terms::laws).subspan(section.first, section.count);
}

bool commutes(Opcode op) { return is_primitive(op) && commuting[static_cast<size_t>(op)]; }

bool is_exact(Opcode op) {
  if (!is_primitive(op)) return false;
  switch (info(op).range) {
    using enum RangeRule;
    case choice:
    case floor:
    case negative:
    case magnitude: return true;
    case less:
    case equal:
    case less_or_equal:
    case greater:
    case not_equal:
    case greater_or_equal:
    case sum:
    case difference:
    case product:
    case quotient:
    case root:
    case truncated:
    case rounded:
    case integer_sum:
    case integer_difference:
    case both:
    case either:
    case different:
    case inverse:
    case any: return false;
  }
  return false;
}

Opcode swapped(Opcode comparison) {
  const OpInfo& row = info(comparison);
  const auto order = [&](RangeRule is, RangeRule becomes) {
    return accepts(row.range, is) ? static_cast<int>(becomes) : 0;
  };
  using enum RangeRule;
  return comparison_of(row.rule,
                       RangeRule(order(less, greater) | order(equal, equal) | order(greater, less)));
}

Opcode opposite(Opcode comparison) {
  const OpInfo& row = info(comparison);
  constexpr int all = static_cast<int>(RangeRule::less_or_equal) | static_cast<int>(RangeRule::greater);
  return comparison_of(row.rule, RangeRule(all & ~static_cast<int>(row.range)));
}

}  // namespace isoshade::ir
