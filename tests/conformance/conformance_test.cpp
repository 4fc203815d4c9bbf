// SPDX-License-Identifier: Apache-2.0
// Every executor computes the same bits: each program of cases.h, on the same inputs, against the interpreter.
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <tuple>

#include "backends/cpu/backend.h"
#include "backends/cpu/lane_count.h"
#include "backends/interpreter/backend.h"
#include "tests/conformance/cases.h"
#include "tests/unit/scalar_interpreter.h"
#ifdef ISOSHADE_VULKAN
#include "backends/vulkan/backend.h"
#include "compiler/passes/pipeline.h"
#endif

namespace isoshade::conformance {
namespace {

constexpr size_t rows = 100'000;

struct Expected {
  Case made;
  std::vector<int32_t> results;
};

const std::vector<int32_t>& table() {
  static const std::vector<int32_t> words = inputs(rows);
  return words;
}

/// The results of the scalar interpreter, which enforces the preconditions of ops, computed once.
const std::vector<Expected>& expected() {
  static const std::vector<Expected> all = [] {
    std::vector<Expected> out;
    support::Diagnostics diagnostics;
    const auto interpreter = interpreter::create_scalar();
    for (auto* cases : {&op_cases, &function_cases, &tier_cases, &idiom_cases})
      for (Case& made : cases()) {
        Expected e{std::move(made), {}};
        EXPECT_TRUE(interpreter->evaluate(e.made.program, table(), rows, e.results, diagnostics))
            << diagnostics.text();
        out.push_back(std::move(e));
      }
    return out;
  }();
  return all;
}

bool any_program(const driver::Program&) { return true; }

void expect_same_bits(backends::Backend& backend, bool (*is_run)(const driver::Program&) = any_program) {
  for (const Expected& e : expected()) {
    if (!is_run(e.made.program)) continue;
    SCOPED_TRACE(e.made.name + " on " + backend.description());
    support::Diagnostics diagnostics;
    std::vector<int32_t> results;
    ASSERT_TRUE(backend.evaluate(e.made.program, table(), rows, results, diagnostics)) << diagnostics.text();
    ASSERT_EQ(results.size(), e.results.size());
    const size_t words = e.made.words.size();
    std::vector<size_t> differing(words), first(words);
    for (size_t i = 0; i < results.size(); ++i) {
      if (results[i] == e.results[i]) continue;
      if (differing[i % words]++ == 0) first[i % words] = i / words;
    }
    for (size_t w = 0; w < words; ++w) {
      const int32_t* in = table().data() + first[w] * input_words;
      EXPECT_EQ(differing[w], 0u) << e.made.words[w] << " first for " << std::hex << in[0] << " " << in[1]
                                  << " " << in[2] << " " << in[3] << " " << in[4] << ": "
                                  << results[first[w] * words + w] << ", expected "
                                  << e.results[first[w] * words + w];
    }
  }
}

class CpuLanes : public testing::TestWithParam<const char*> {};

TEST_P(CpuLanes, MatchTheInterpreterBitForBit) {
  if (!cpu::lane_count(GetParam())->available())
    GTEST_SKIP() << "this machine has no registers of so many lanes";
  support::Diagnostics diagnostics;
  cpu::CpuOptions options;
  options.lanes = GetParam();
  const auto backend = cpu::create(options, diagnostics);
  ASSERT_NE(backend, nullptr) << diagnostics.text();
  expect_same_bits(*backend);
}

class InterpreterLanes : public testing::TestWithParam<int> {};

TEST_P(InterpreterLanes, MatchTheScalarInterpreterBitForBit) {
  if (GetParam() > interpreter::Code::widest_lanes()) GTEST_SKIP() << "this machine has no registers of so many lanes";
  expect_same_bits(*interpreter::create(0, GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Conformance, InterpreterLanes, testing::Values(4, 8, 16),
                         [](const auto& info) { return std::to_string(info.param); });

INSTANTIATE_TEST_SUITE_P(Conformance, CpuLanes, testing::Values("1", "4", "8", "16", "8x2", "16x2"),
                         [](const auto& info) { return std::string(info.param); });

#ifdef ISOSHADE_VULKAN
bool has_wide_products(const driver::Program& program) {
  for (const ir::Function& function : program.module.functions)
    for (const ir::Instruction& made : function.instructions)
      if (made.op == ir::Opcode::imulhi || made.op == ir::Opcode::umulhi) return true;
  return false;
}

// What GLSL ES is given: products of 64 bits made of halves. Here in GLSL, because this device takes nothing else.
TEST(VulkanByHalves, MatchesTheInterpreterBitForBit) {
  support::Diagnostics diagnostics;
  vulkan::VulkanOptions options;
  size_t texts = 0;
  options.glsl = [&](const driver::Program& program, driver::Division) {
    driver::Program lowered = program;
    passes::Entries entries{program.entry};
    passes::run(passes::multiplication_lowering(), lowered.module, entries, program.tier);
    lowered.entry = entries[0];
    const std::string text = driver::glsl(lowered, driver::Division::native);
    EXPECT_EQ(text.find("mulExtended"), std::string::npos) << text;
    texts += text.find("mul_hi_by_halves") != std::string::npos;
    return text;
  };
  const auto backend = vulkan::create(options, diagnostics);
  ASSERT_NE(backend, nullptr) << diagnostics.text();
  expect_same_bits(*backend, has_wide_products);
  EXPECT_GT(texts, 1u);
}

using VulkanCase = std::tuple<driver::Division, vulkan::EvalStage>;
class Vulkan : public testing::TestWithParam<VulkanCase> {};

TEST_P(Vulkan, MatchesTheInterpreterBitForBit) {
  support::Diagnostics diagnostics;
  vulkan::VulkanOptions options;
  std::tie(options.division, options.eval_stage) = GetParam();
  const auto backend = vulkan::create(options, diagnostics);
  ASSERT_NE(backend, nullptr) << diagnostics.text();
  expect_same_bits(*backend);
}

INSTANTIATE_TEST_SUITE_P(Conformance, Vulkan,
                         testing::Combine(testing::Values(driver::Division::native, driver::Division::exact),
                                          testing::Values(vulkan::EvalStage::fragment,
                                                          vulkan::EvalStage::vertex)),
                         [](const auto& info) {
                           const driver::Division division = std::get<0>(info.param);
                           const vulkan::EvalStage stage = std::get<1>(info.param);
                           return std::string(driver::name(division)) +
                                  (stage == vulkan::EvalStage::fragment ? "_fragment" : "_vertex");
                         });
#endif

}  // namespace
}  // namespace isoshade::conformance
