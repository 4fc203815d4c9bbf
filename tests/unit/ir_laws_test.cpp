// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "compiler/ir/evaluate.h"
#include "compiler/ir/laws.h"
#include "runtime/lanes/float_rules.h"

namespace isoshade::ir {
namespace {

bool takes_floats(Opcode op) {
  switch (info(op).rule) {
    case Rule::same:
    case Rule::compare:
    case Rule::to_int: return true;
    case Rule::icompare:
    case Rule::integer:
    case Rule::logic:
    case Rule::choose:
    case Rule::to_float: return false;
  }
  return false;
}
bool gives_floats(Opcode op) { return info(op).rule == Rule::same || info(op).rule == Rule::to_float; }

/// Values of one type: special ones, and random bits.
std::vector<uint32_t> values(bool floats, bool truths) {
  if (truths) return {0, 1};
  std::vector<uint32_t> words{0,          1,          2,          31,         0x80000000, 0x7fffffff,
                              ~0u,        0x3f800000, 0xbf800000, 0x00800000, 0x80800000, 0x7f7fffff,
                              0x7f800000, 0xff800000, 0x7fc00000, 0x4b000000, 0xcb000001};
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) words.push_back(random());
  if (floats)
    for (uint32_t& word : words) word = canonical_float(word);
  return words;
}

/// What stands for x in a law is of the type of the op's operands, or of those of the op that it is inside of.
std::vector<uint32_t> values_of_x(const Law& law) {
  Opcode op = law.op;
  for (const Term* term : {&law.left, &law.right})
    if (term->kind == Term::Kind::of_any) op = term->op;
  return values(takes_floats(op), info(op).rule == Rule::logic);
}

uint32_t value_of(const Term& term, uint32_t x) {
  switch (term.kind) {
    case Term::Kind::absent: return 0;
    case Term::Kind::any: return x;
    case Term::Kind::constant: return term.bits;
    case Term::Kind::of_any: return evaluate(term.op, x, 0, 0);
  }
  return 0;
}

uint32_t result(Opcode op, uint32_t a, uint32_t b) {
  const uint32_t word = evaluate(op, a, b, 0);
  return gives_floats(op) ? canonical_float(word) : word;
}

TEST(Laws, HoldForEveryValue) {
  const lanes::FpGuard guard;
  size_t laws = 0;
  for (int i = 0; i < primitive_count; ++i) {
    const auto op = static_cast<Opcode>(i);
    for (const Law& law : laws_of(op)) {
      ++laws;
      EXPECT_EQ(law.op, op);
      EXPECT_EQ(law.right.kind == Term::Kind::absent, info(op).arity == 1) << name(op);
      for (const uint32_t x : values_of_x(law)) {
        const uint32_t a = value_of(law.left, x), b = value_of(law.right, x);
        if (!holds(info(op).precondition, a, b)) continue;
        uint32_t is = value_of(law.is, x);
        if (gives_floats(op)) is = canonical_float(is);
        EXPECT_EQ(result(op, a, b), is) << name(op) << std::hex << " of " << a << " and " << b;
        const uint32_t other = commutes(op) ? result(op, b, a) : is;
        EXPECT_EQ(other, is) << name(op) << std::hex << " of " << b << " and " << a;
      }
    }
  }
  EXPECT_GT(laws, 50u);
}

TEST(Laws, MarkExactlyTheCommutativeOps) {
  const lanes::FpGuard guard;
  for (int i = 0; i < primitive_count; ++i) {
    const auto op = static_cast<Opcode>(i);
    if (info(op).arity != 2) continue;
    bool measured = true;
    const auto all = values(takes_floats(op), info(op).rule == Rule::logic);
    for (const uint32_t a : all)
      for (const uint32_t b : all) measured = measured && result(op, a, b) == result(op, b, a);
    EXPECT_EQ(commutes(op), measured) << name(op);
  }
}

TEST(Laws, SwappedAndOppositeComparisonsAgree) {
  const lanes::FpGuard guard;
  for (int i = 0; i < primitive_count; ++i) {
    const auto op = static_cast<Opcode>(i);
    if (info(op).range > RangeRule::greater_or_equal) continue;
    for (const uint32_t a : values(takes_floats(op), false))
      for (const uint32_t b : values(takes_floats(op), false)) {
        EXPECT_EQ(evaluate(op, a, b, 0), evaluate(swapped(op), b, a, 0)) << name(op);
        if (takes_floats(op) && (is_nan(a) || is_nan(b))) continue;
        EXPECT_NE(evaluate(op, a, b, 0), evaluate(opposite(op), a, b, 0)) << name(op);
      }
  }
}

}  // namespace
}  // namespace isoshade::ir
