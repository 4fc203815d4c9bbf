// SPDX-License-Identifier: Apache-2.0
// Every function of functions.def as a tape: what it computes for random arguments is what was bounded for boxes
// that hold them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "compiler/prove/sample.h"
#include "compiler/functions/library.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::prove {
namespace {

struct Domain {
  double lo, hi;
};
struct Row {
  std::string_view name;
  std::vector<Domain> domain;  ///< of each argument
  functions::Tier tier = functions::Tier::standard;
};

/// The domains that functions.def states.
const std::vector<Row>& rows() {
#define D(...) \
  { __VA_ARGS__ }
  static const std::vector<Row> all{
#define FUNCTION(name, signature, ulp, domain, reference, unit) {#name, domain},
#include "compiler/functions/functions.def"
#define TIER(tier, name, ulp, domain, unit) {#name, domain, functions::Tier::tier},
#define FOLLOWS(tier, name, ulp, domain, unit) {#name, domain, functions::Tier::tier},
#include "compiler/functions/functions.def"
  };
#undef D
  return all;
}

std::vector<Given> outside(uint32_t) { return {}; }

/// A function that calls the variant; `box` has a domain for each word.
Tape tape_of(const functions::Variant& variant, const std::vector<Domain>& domain, functions::Tier tier) {
  ir::Module module;
  ir::Function function;
  function.name = "calls";
  for (size_t i = 0; i < variant.parameters.size(); ++i)
    function.parameters.push_back({"p" + std::to_string(i), variant.parameters[i], "", false});
  for (size_t i = 0; i < variant.results.size(); ++i)
    function.results.push_back({"r" + std::to_string(i), variant.results[i]});
  module.functions.push_back(function);
  ir::Builder builder(module, 0);
  std::vector<ir::ValueId> arguments;
  for (size_t i = 0; i < variant.parameters.size(); ++i) arguments.push_back(builder.parameter(i));
  builder.finish(functions::call_library(builder, variant.row, arguments));
  std::vector<Given> given;
  for (size_t i = 0; i < variant.parameters.size(); ++i) {
    // A matrix is several parameters, and has one domain.
    const size_t columns = variant.parameters.size() - domain.size() + 1;
    const size_t of = i < columns ? 0 : i - columns + 1;
    const Domain& d = domain[std::min(of, domain.size() - 1)];
    given.push_back({"p" + std::to_string(i), d.lo, d.hi});
  }
  auto tape = make_tape(module, 0, given, outside, tier);
  EXPECT_TRUE(tape.has_value());
  return *tape;
}

class Random {
 public:
  double unit() { return static_cast<double>(engine_() >> 8) * 0x1p-24; }
  bool one_in(int count) { return engine_() % static_cast<unsigned>(count) == 0; }
  float in(const Side& side) {
    if (one_in(5)) return static_cast<float>(one_in(2) ? side.lo : side.hi);
    double value = side.lo + (side.hi - side.lo) * unit();
    if (one_in(3)) value = std::clamp((one_in(2) ? 1 : -1) * std::exp2(60 * unit() - 40), side.lo, side.hi);
    const auto rounded = static_cast<float>(value);
    return std::abs(rounded) < 0x1p-126f ? static_cast<float>(std::max(side.lo, 0.0)) : rounded;
  }
  Side within(const Side& side) {
    const auto a = static_cast<double>(in(side));
    double b = static_cast<double>(in(side));
    if (one_in(3)) b = a + (side.hi - a) * std::exp2(-30 * unit());
    b = static_cast<double>(static_cast<float>(std::min(b, side.hi)));
    return {std::min(a, b), std::max(a, b)};
  }

 private:
  std::mt19937 engine_{3};
};

class FunctionRule : public testing::TestWithParam<functions::Tier> {};
std::string tier_of(const testing::TestParamInfo<functions::Tier>& info) {
  return std::string(functions::tier_name(info.param));
}
INSTANTIATE_TEST_SUITE_P(Tiers, FunctionRule, testing::ValuesIn(functions::tiers), tier_of);

TEST_P(FunctionRule, BoundContainsEveryComputedValue) {
  constexpr int boxes = 150, points = 40;
  const lanes::FpGuard guard;
  Random random;
  for (const functions::Variant& variant : functions::variants()) {
    const auto in_tier = [&](functions::Tier tier) {
      return std::ranges::find_if(rows(),
                                  [&](const Row& r) { return r.name == variant.row && r.tier == tier; });
    };
    auto row = in_tier(GetParam());
    if (row == rows().end()) row = in_tier(functions::Tier::standard);
    ASSERT_NE(row, rows().end());
    const Tape tape = tape_of(variant, row->domain, GetParam());
    Evaluator evaluator(tape);
    TapeRunner runner(tape);
    const Box whole = evaluator.whole();
    int finite = 0;
    for (int i = 0; i < boxes; ++i) {
      Box box = whole;
      if (i > 0)
        for (size_t s = 0; s < tape.inputs.size(); ++s) box[s] = random.within(whole[s]);
      ASSERT_TRUE(evaluator.walk(box)) << variant.name;
      const bool proved = evaluator.findings().empty();
      for (int k = 0; k < points; ++k) {
        std::vector<uint32_t> words;
        for (size_t s = 0; s < tape.inputs.size(); ++s)
          words.push_back(std::bit_cast<uint32_t>(random.in(box[s])));
        const std::vector<TapeRunner::Broken>& broken = runner.run(words);
        EXPECT_FALSE(!broken.empty() && proved)
            << variant.name << " breaks: " << prove::words(broken[0].breach);
        if (!broken.empty()) continue;
        ++finite;
        for (const Tape::Output& output : tape.outputs) {
          const auto value = static_cast<double>(std::bit_cast<float>(runner.word(output.operation)));
          const Bound& bound = evaluator.bound(output.operation);
          EXPECT_TRUE(value >= bound.lo && value <= bound.hi)
              << variant.name << " gives " << value << ", not in [" << bound.lo << ", " << bound.hi
              << "], for " << std::bit_cast<float>(words[0]) << " in [" << box[0].lo << ", " << box[0].hi
              << "]";
        }
      }
    }
    EXPECT_GT(finite, 0) << variant.name;
  }
}

TEST(FunctionRule, TangentOfEveryFloatIsInRange) {
  // Of all floats this is the nearest to a pole, which angles_test finds by visiting every one.
  const long double hardest = 16367173 * 0x1p72L;
  EXPECT_LT(std::abs(std::tan(hardest)), 0.9e9L);
  EXPECT_GT(std::abs(std::tan(hardest)), 0.5e9L);
}

TEST(FunctionRule, SineBoundContainsTheSineOfLargeAngles) {
  const auto variant = [](std::string_view row) {
    for (const functions::Variant& v : functions::variants())
      if (v.name == row) return v;
    return functions::Variant{};
  };
  const lanes::FpGuard guard;
  for (const float x : {1e6f, -3e9f, 1e20f, 3e38f, 16367173 * 0x1p72f}) {
    for (const auto& [row, exact] : {std::pair{"sin", std::sin(static_cast<double>(x))},
                                     {"cos", std::cos(static_cast<double>(x))}}) {
      const auto at = static_cast<double>(x);
      const Tape tape = tape_of(variant(row), {{at, at}}, functions::Tier::standard);
      Evaluator evaluator(tape);
      ASSERT_TRUE(evaluator.walk(evaluator.whole()));
      EXPECT_TRUE(evaluator.findings().empty());
      const Bound& bound = evaluator.bound(tape.outputs[0].operation);
      EXPECT_NEAR(bound.lo, exact, 3e-7) << row << x;
      EXPECT_NEAR(bound.hi, exact, 3e-7) << row << x;
      EXPECT_LT(bound.absolute, 3e-7) << row << x;
    }
  }
}

}  // namespace
}  // namespace isoshade::prove
