// SPDX-License-Identifier: Apache-2.0
// The operations on bounds against the operations on floats: for random boxes, and random values and errors in them.
#include <bit>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>

#include "compiler/prove/bound.h"
#include "compiler/ir/evaluate.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::prove {
namespace {

using ir::Opcode;

constexpr int points = 10'000, points_in_a_box = 20;

class Random {
 public:
  double unit() { return static_cast<double>(engine_() >> 8) * 0x1p-24; }
  bool one_in(int count) { return engine_() % static_cast<unsigned>(count) == 0; }

  /// A float of any magnitude that a graph may meet, ends and special values among them.
  float number() {
    constexpr float special[] = {0.0f,   -0.0f, 1.0f,       -1.0f,  0.5f,           2.0f, 0x1p-126f,
                                 1e-30f, 1e30f, 3.4028e38f, -3e38f, 0x1.fffffep-1f, 3.0f, -0x1p-126f};
    if (one_in(4)) return special[engine_() % std::size(special)];
    const double magnitude = std::exp2((one_in(3) ? 120 : 6) * (2 * unit() - 1));
    return static_cast<float>(one_in(2) ? magnitude : -magnitude);
  }

  Bound box() {
    float a = number(), b = one_in(3) ? a * static_cast<float>(1 + unit()) : number();
    if (!std::isfinite(b)) b = a;
    if (one_in(8)) b = a;
    Bound box = between(std::min(a, b), std::max(a, b));
    if (one_in(2)) {
      box.relative = std::exp2(-24 * unit()) / 4;
      box.slack = one_in(2) ? 0 : std::exp2(-60 * unit());
      box.absolute = one_in(2) ? HUGE_VAL : box.magnitude() * std::exp2(-20 * unit());
      box = settled(box).bound;
    }
    return box;
  }

  /// A float of the box: its ends, zero, any.
  float in(const Bound& box) {
    if (one_in(6)) return static_cast<float>(box.lo);
    if (one_in(6)) return static_cast<float>(box.hi);
    if (one_in(10) && box.lo <= 0 && box.hi >= 0) return 0;
    const double value = one_in(2) && box.lo > 0 ? box.lo * std::pow(box.hi / box.lo, unit())
                                                 : box.lo + (box.hi - box.lo) * unit();
    const auto rounded = static_cast<float>(std::clamp(value, box.lo, box.hi));
    return std::abs(rounded) < 0x1p-126f ? 0 : rounded;
  }

  /// An exact value for which `computed` is within the bound.
  long double exact(const Bound& box, float computed) {
    const long double y = static_cast<long double>(computed);
    const long double sign = one_in(2) ? 1 : -1;
    long double reach = box.absolute;
    if (box.relative < 1)
      reach = std::min(
          reach, (box.relative * std::abs(y) + box.slack) / (1 + static_cast<long double>(box.relative)));
    return y + sign * reach * (one_in(2) ? 0.9999L : static_cast<long double>(unit()));
  }

 private:
  std::mt19937 engine_{7};
};

struct Case {
  const char* name;
  Opcode op;
  int arity;
  std::function<Outcome(const Bound&, const Bound&)> bound;
  std::function<long double(long double, long double)> exact;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class OperationBound : public testing::TestWithParam<Case> {};

TEST_P(OperationBound, ContainsEveryResultAndItsError) {
  const Case& c = GetParam();
  const lanes::FpGuard guard;
  Random random;
  int looked_at = 0;
  for (int i = 0; i < points; i += points_in_a_box) {
    const Bound a = random.box(), b = random.box();
    const Outcome outcome = c.bound(a, b);
    const Bound& r = outcome.bound;
    ASSERT_LE(r.lo, r.hi);
    for (int k = 0; k < points_in_a_box; ++k) {
      const float x = random.in(a), y = random.in(b);
      const auto word = ir::evaluate(c.op, std::bit_cast<uint32_t>(x), std::bit_cast<uint32_t>(y), 0);
      const auto result = std::bit_cast<float>(word);
      if (!std::isfinite(result) || (c.op == Opcode::fdiv && y == 0)) {
        EXPECT_NE(outcome.breach, Breach::none) << c.name << " of " << x << " and " << y;
        continue;
      }
      ++looked_at;
      const double z = static_cast<double>(result);
      EXPECT_TRUE(z >= r.lo && z <= r.hi) << c.name << " of " << x << " and " << y << " gives " << z
                                          << ", not in [" << r.lo << ", " << r.hi << "]";
      const long double exact_x = random.exact(a, x), exact_y = random.exact(b, y);
      const long double exact = c.exact(exact_x, exact_y);
      if (!std::isfinite(exact)) continue;
      const long double error = std::abs(static_cast<long double>(z) - exact);
      EXPECT_LE(error, r.absolute) << c.name << " of " << x << " and " << y << " for " << double(exact_x)
                                   << " and " << double(exact_y);
      if (!std::isfinite(r.relative) || !std::isfinite(r.slack)) continue;
      EXPECT_LE(error, r.relative * std::abs(exact) * (1 + 0x1p-50L) + r.slack)
          << c.name << " of " << x << " and " << y << " for " << double(exact_x) << " and "
          << double(exact_y);
    }
  }
  EXPECT_GT(looked_at, points / 4);
}

Outcome one(const Bound& bound) { return {bound}; }

INSTANTIATE_TEST_SUITE_P(
    Operations, OperationBound,
    testing::Values(
        Case{"add", Opcode::fadd, 2, add, [](long double x, long double y) { return x + y; }},
        Case{"subtract", Opcode::fsub, 2, subtract, [](long double x, long double y) { return x - y; }},
        Case{"multiply", Opcode::fmul, 2, multiply, [](long double x, long double y) { return x * y; }},
        Case{"divide", Opcode::fdiv, 2, divide, [](long double x, long double y) { return x / y; }},
        Case{"square_root", Opcode::fsqrt, 1, [](const Bound& a, const Bound&) { return square_root(a); },
             [](long double x, long double) { return std::sqrt(x); }},
        Case{"negate", Opcode::fneg, 1, [](const Bound& a, const Bound&) { return one(negate(a)); },
             [](long double x, long double) { return -x; }},
        Case{"magnitude", Opcode::fabs, 1, [](const Bound& a, const Bound&) { return one(magnitude(a)); },
             [](long double x, long double) { return std::abs(x); }},
        Case{"floor", Opcode::floor, 1, [](const Bound& a, const Bound&) { return one(floor_of(a)); },
             [](long double x, long double) { return std::floor(x); }}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(OperationBound, SquareContainsEverySquare) {
  const lanes::FpGuard guard;
  Random random;
  for (int i = 0; i < points; ++i) {
    const Bound a = random.box();
    const Outcome outcome = square(a);
    const float x = random.in(a), result = x * x;
    if (!std::isfinite(result)) {
      EXPECT_EQ(outcome.breach, Breach::overflow);
      continue;
    }
    EXPECT_GE(outcome.bound.lo, 0);
    EXPECT_TRUE(double(result) >= outcome.bound.lo && double(result) <= outcome.bound.hi) << x;
    const long double exact = random.exact(a, x);
    EXPECT_LE(std::abs(result - exact * exact), outcome.bound.absolute) << x;
  }
}

TEST(OperationBound, MinAndMaxContainBothOperands) {
  const lanes::FpGuard guard;
  Random random;
  for (int i = 0; i < points; ++i) {
    const Bound a = random.box(), b = random.box();
    const float x = random.in(a), y = random.in(b);
    const long double exact_x = random.exact(a, x), exact_y = random.exact(b, y);
    const Bound least = lesser(a, b), most = greater(a, b);
    EXPECT_TRUE(double(std::min(x, y)) >= least.lo && double(std::min(x, y)) <= least.hi) << x << " " << y;
    EXPECT_TRUE(double(std::max(x, y)) >= most.lo && double(std::max(x, y)) <= most.hi) << x << " " << y;
    EXPECT_LE(std::abs(std::min(x, y) - std::min(exact_x, exact_y)), least.absolute) << x << " " << y;
    EXPECT_LE(std::abs(std::max(x, y) - std::max(exact_x, exact_y)), most.absolute) << x << " " << y;
  }
}

TEST(OperationBound, ComparisonIsDecidedOnlyIfConstant) {
  const lanes::FpGuard guard;
  Random random;
  int decided = 0;
  for (int i = 0; i < points; ++i) {
    const Bound a = random.box(), b = random.box();
    const float x = random.in(a), y = random.in(b);
    for (const Opcode op : {Opcode::flt, Opcode::fle, Opcode::fgt, Opcode::fge, Opcode::feq, Opcode::fne}) {
      const Bound truth = bound_of(op, a, b).bound;
      const uint32_t holds = ir::evaluate(op, std::bit_cast<uint32_t>(x), std::bit_cast<uint32_t>(y), 0);
      EXPECT_TRUE(holds >= truth.lo && holds <= truth.hi) << ir::name(op) << " of " << x << " and " << y;
      decided += truth.is_point() ? 1 : 0;
    }
  }
  EXPECT_GT(decided, points);
}

TEST(OperationBound, SelectContainsTheTakenSide) {
  const lanes::FpGuard guard;
  const Bound low = between(0, 1), high = between(5, 6);
  EXPECT_EQ(select(exactly(1), low, high).hi, 1);
  EXPECT_EQ(select(exactly(0), low, high).lo, 5);
  const Bound either = select(between(0, 1), low, high);
  EXPECT_EQ(either.lo, 0);
  EXPECT_EQ(either.hi, 6);
  EXPECT_EQ(either.absolute, 0);
  // Where rounding may have decided otherwise, the error is as much as the sides differ.
  EXPECT_GE(select({1, 1, 1}, low, high).absolute, 6);
}

TEST(OperationBound, DivisionReportsZeroDivisors) {
  const lanes::FpGuard guard;
  EXPECT_EQ(divide(exactly(1), between(0, 1)).breach, Breach::division_by_zero);
  EXPECT_EQ(divide(exactly(1), between(-1, 1)).breach, Breach::division_by_zero);
  EXPECT_EQ(divide(exactly(1), between(0x1p-126, 1)).breach, Breach::none);
  EXPECT_EQ(divide(exactly(8), between(0x1p-126, 1)).breach, Breach::overflow);
  EXPECT_EQ(square_root(between(-1e-30, 1)).breach, Breach::root_of_negative);
}

TEST(OperationBound, SumContainsRepeatedAddition) {
  const lanes::FpGuard guard;
  Random random;
  const Outcome outcome = sum_of(between(-0.25, 3), 256);
  for (int i = 0; i < 200; ++i) {
    float sum = 0;
    long double exact = 0;
    for (int k = 0; k < 256; ++k) {
      const float x = random.in(between(-0.25, 3));
      sum += x;
      exact += static_cast<long double>(x);
    }
    EXPECT_TRUE(double(sum) >= outcome.bound.lo && double(sum) <= outcome.bound.hi);
    EXPECT_LE(std::abs(sum - exact), outcome.bound.absolute);
  }
}

}  // namespace
}  // namespace isoshade::prove
