// SPDX-License-Identifier: Apache-2.0
// Every node computes the same bits on every backend, against the interpreter, on 10,000 inputs.
#include <gtest/gtest.h>
#include <memory>
#include <string>

#include "backends/cpu/backend.h"
#include "backends/cpu/lane_count.h"
#include "backends/interpreter/backend.h"
#include "tests/conformance/node_cases.h"
#ifdef ISOSHADE_VULKAN
#include "backends/vulkan/backend.h"
#endif

namespace isoshade::conformance {
namespace {

constexpr size_t rows = 10'000;

struct Expected {
  NodeCase made;
  std::vector<int32_t> inputs;
  std::vector<int32_t> results;
};

/// The interpreter's results, computed once.
const std::vector<Expected>& expected() {
  static const std::vector<Expected> all = [] {
    std::vector<Expected> out;
    support::Diagnostics diagnostics;
    const auto interpreter = interpreter::create();
    for (NodeCase& made : node_cases()) {
      Expected e{std::move(made), {}, {}};
      e.inputs = node_inputs(e.made.program, rows);
      EXPECT_TRUE(interpreter->evaluate(e.made.program, e.inputs, rows, e.results, diagnostics))
          << diagnostics.text();
      out.push_back(std::move(e));
    }
    return out;
  }();
  return all;
}

void expect_same_bits(backends::Backend& backend) {
  for (const Expected& e : expected()) {
    SCOPED_TRACE(backend.description());
    support::Diagnostics diagnostics;
    std::vector<int32_t> results;
    ASSERT_TRUE(backend.evaluate(e.made.program, e.inputs, rows, results, diagnostics)) << diagnostics.text();
    ASSERT_EQ(results.size(), rows * e.made.words.size());
    ASSERT_EQ(results.size(), e.results.size());
    const size_t words = e.made.words.size();
    std::vector<size_t> differing(words);
    for (size_t i = 0; i < results.size(); ++i) differing[i % words] += results[i] != e.results[i] ? 1 : 0;
    for (size_t w = 0; w < words; ++w)
      EXPECT_EQ(differing[w], 0u) << e.made.words[w] << " differs on so many of " << rows << " inputs";
  }
}

class NodesOnCpu : public testing::TestWithParam<const char*> {};

TEST_P(NodesOnCpu, MatchTheInterpreterBitForBit) {
  if (!cpu::lane_count(GetParam())->available())
    GTEST_SKIP() << "this machine has no registers of so many lanes";
  support::Diagnostics diagnostics;
  cpu::CpuOptions options;
  options.lanes = GetParam();
  const auto backend = cpu::create(options, diagnostics);
  ASSERT_NE(backend, nullptr) << diagnostics.text();
  expect_same_bits(*backend);
}

// The lane types themselves are held to the interpreter by conformance_test.
INSTANTIATE_TEST_SUITE_P(Nodes, NodesOnCpu, testing::Values("1", "8"),
                         [](const auto& info) { return std::string(info.param); });

#ifdef ISOSHADE_VULKAN
TEST(NodesOnVulkan, MatchTheInterpreterBitForBit) {
  support::Diagnostics diagnostics;
  const auto backend = vulkan::create({}, diagnostics);
  ASSERT_NE(backend, nullptr) << diagnostics.text();
  expect_same_bits(*backend);
}
#endif

}  // namespace
}  // namespace isoshade::conformance
