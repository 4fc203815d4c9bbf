// SPDX-License-Identifier: Apache-2.0
// What the ranges of parameters decide: each rewrite once where it holds and once where a zero, its sign or an end
// forbids it, with the bits of all special values in the range.
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>
#include <ostream>

#include "compiler/ir/float_bits.h"
#include "compiler/ir/interpreter.h"
#include "compiler/ir/printer.h"
#include "compiler/passes/passes.h"
#include "tests/unit/ir_text.h"

namespace isoshade::passes {
namespace {

struct Case {
  const char* name;
  float least, most;   ///< of %x and %y; both 0: not declared
  const char* body;    ///< makes %out of them
  const char* op;      ///< the op that is decided
  bool is_decided;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

constexpr float small = 0x1p-126f, big = 0x1.fffffep127f;

constexpr Case cases[] = {
    // x * 0 is +0 where x is not negative and no -0.
    {"ProductOfPositiveAndZero", 1, 2, "%z = constant float 0x00000000 %out = fmul %x, %z", "fmul", true},
    {"ProductOfSquareAndZero", -2, 2, "%z = constant float 0x00000000 %s = fmul %x, %x %out = fmul %s, %z", "fmul", true},
    {"ProductOfAnySignAndZero", -2, 2, "%z = constant float 0x00000000 %out = fmul %x, %z", "fmul", false},
    {"ProductOfMinusZeroAndZero", 0, 2, "%z = constant float 0x00000000 %out = fmul %x, %z", "fmul", false},
    {"ProductOfUnknownAndZero", 0, 0, "%z = constant float 0x00000000 %out = fmul %x, %z", "fmul", false},
    // x * 0 + 1 is 1 whatever the sign of x.
    {"ProductWithZeroAndOne", -2, 2,
     "%z = constant float 0x00000000 %o = constant float 0x3f800000 %p = fmul %x, %z %out = fadd %p, %o", "fadd", true},
    {"ProductOfUnknownWithZeroAndOne", 0, 0,
     "%z = constant float 0x00000000 %o = constant float 0x3f800000 %p = fmul %x, %z %out = fadd %p, %o", "fadd", false},
    // x + 0 is x where x is no -0.
    {"SumOfPositiveAndZero", small, big, "%z = constant float 0x00000000 %out = fadd %z, %x", "fadd", true},
    {"SumOfNegativeAndZero", -big, -small, "%z = constant float 0x00000000 %out = fadd %x, %z", "fadd", true},
    {"SumOfMinusZeroAndZero", -1, 1, "%z = constant float 0x00000000 %out = fadd %x, %z", "fadd", false},
    {"SumWithZeroOfUnknownSign", 1, 2,
     "%z = constant float 0x00000000 %m = fneg %y %p = fmul %m, %z %out = fadd %x, %p", "fadd", true},
    {"SumOfUnknownAndZero", 0, 0, "%z = constant float 0x00000000 %out = fadd %x, %z", "fadd", false},
    {"DifferenceOfPositiveAndZero", 1, 2, "%z = constant float 0x80000000 %out = fsub %x, %z", "fsub", true},
    {"DifferenceOfMinusZeroAndMinusZero", -1, 1, "%z = constant float 0x80000000 %out = fsub %x, %z", "fsub", false},
    {"DifferenceOfZeroAndPositive", 1, 2, "%z = constant float 0x00000000 %out = fsub %z, %x", "fsub", false},
    // 0.5 + x is 0 only as +0; x + y may have been flushed to -0.
    {"SumNeverMinusZero", -2, 2,
     "%h = constant float 0x3f000000 %z = constant float 0x00000000 %s = fadd %h, %x %d = fsub %s, %z %n = fneg %s "
     "%out = fmul %d, %n",
     "fsub", true},
    {"SumThatMayBeFlushed", -2, 2, "%z = constant float 0x00000000 %s = fadd %x, %y %out = fsub %s, %z", "fsub", false},
    // Magnitudes and points.
    {"MagnitudeOfSquare", -2, 2, "%s = fmul %x, %x %out = fabs %s", "fabs", true},
    {"MagnitudeOfMinusZero", 0, 2, "%out = fabs %x", "fabs", false},
    {"RootOfPoint", 2, 2, "%out = fsqrt %x", "fsqrt", true},
    {"FloorOfPart", 0.25f, 0.5f, "%out = floor %x", "floor", true},
    {"FloorOfMinusZero", 0, 0.5f, "%out = floor %x", "floor", false},
    {"ComparisonOfParts", 0.25f, 0.5f,
     "%o = constant float 0x3f800000 %c: bool = flt %x, %o %out = select %c, %x, %y", "flt", true},
    {"ComparisonAtTheEnd", 0.25f, 1,
     "%o = constant float 0x3f800000 %c: bool = flt %x, %o %out = select %c, %x, %y", "flt", false},
    // max(-1, x) and min(1, x) are no NaN and end on one side, with the other they end on both; max(x, -1) may be NaN.
    {"SquareOfChosen", 0, 0,
     "%m = constant float 0xbf800000 %o = constant float 0x3f800000 %z = constant float 0x00000000 %a = call @max(%m, %x) "
     "%b = call @min(%a, %o) %s = fmul %b, %b %out = fmul %s, %z", "fmul", true},
    {"SquareOfChosenTheOtherWay", 0, 0,
     "%m = constant float 0xbf800000 %o = constant float 0x3f800000 %z = constant float 0x00000000 %a = call @min(%o, %x) "
     "%b = call @max(%a, %m) %s = fmul %b, %b %out = fmul %s, %z", "fmul", true},
    {"SquareOfChosenOrNan", 0, 0,
     "%m = constant float 0xbf800000 %o = constant float 0x3f800000 %z = constant float 0x00000000 %a = call @max(%x, %m) "
     "%b = call @min(%a, %o) %s = fmul %b, %b %out = fmul %s, %z", "fmul", false},
    {"SquareOfChosenOrInfinite", 0, 0,
     "%m = constant float 0xbf800000 %z = constant float 0x00000000 %a = call @max(%m, %x) %s = fmul %a, %a "
     "%out = fmul %s, %z", "fmul", false},
};

class Decided : public testing::TestWithParam<Case> {};

std::vector<uint32_t> values_of(const Case& c) {
  const bool is_declared = c.least != 0 || c.most != 0;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  std::vector<uint32_t> values;
  for (const float value : {c.least, c.most, 0.0f, -0.0f, small, -small, 1.5f * small, -1.5f * small, 1.0f, -1.0f, 0.5f,
                            -0.5f, std::nextafter(-0.5f, 0.0f), std::nextafter(-0.5f, -1.0f), 0.3f, big, -big, infinity,
                            -infinity, std::nanf("")})
    if (!is_declared || (value >= c.least && value <= c.most))
      values.push_back(ir::canonical_float(std::bit_cast<uint32_t>(value)));
  return values;
}

size_t count(const std::string& text, const std::string& op) {
  size_t found = 0;
  for (size_t at = text.find("= " + op + " "); at != std::string::npos; at = text.find("= " + op + " ", at + 1)) ++found;
  return found;
}

std::string hexadecimal(float value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%08x", std::bit_cast<uint32_t>(value));
  return text;
}

TEST_P(Decided, OnlyWhereEveryBitStays) {
  const Case& c = GetParam();
  const bool is_declared = c.least != 0 || c.most != 0;
  const std::string range = is_declared ? " least " + hexadecimal(c.least) + " most " + hexadecimal(c.most) : "";
  // %w makes the function one that declares a range.
  const ir::Module before =
      ir::valid("func @min(%a: float, %b: float) -> (out: float) library \"min\" { %c: bool = flt %b, %a "
                "%out = select %c, %b, %a return %out } "
                "func @max(%a: float, %b: float) -> (out: float) library \"max\" { %c: bool = flt %a, %b "
                "%out = select %c, %b, %a return %out } "
                "func @main(%x: float" + range + ", %y: float" + range +
                ", %w: float least 0x00000000 most 0x3f800000) -> (out: float) from \"test.json\" { " + c.body +
                " return %out }");
  ir::Module after = before;
  decide(after, functions::Tier::standard);
  const bool is_fewer = count(ir::print(after), c.op) < count(ir::print(before), c.op);
  EXPECT_EQ(is_fewer, c.is_decided) << ir::print(after);

  const uint32_t kernel = before.find("main");
  ir::Interpreter first(before, ir::Preconditions::report), second(after, ir::Preconditions::report);
  for (const uint32_t x : values_of(c))
    for (const uint32_t y : values_of(c)) {
      const std::vector<uint32_t> words{x, y, 0};
      std::vector<uint32_t> expected(1), made(1);
      ASSERT_TRUE(first.run(kernel, words, expected) && second.run(kernel, words, made));
      ASSERT_EQ(made, expected) << std::hex << x << " " << y << "\n" << ir::print(after);
    }
}

INSTANTIATE_TEST_SUITE_P(Passes, Decided, testing::ValuesIn(cases), [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace isoshade::passes
