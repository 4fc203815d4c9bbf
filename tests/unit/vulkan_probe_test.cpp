// SPDX-License-Identifier: Apache-2.0
// Would the probe notice a device that computes otherwise? Each test gives its operands to such a device.
#include <algorithm>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <set>

#include "backends/vulkan/limits.h"
#include "backends/vulkan/probe.h"
#include "backends/vulkan/probe_parts.h"
#include "runtime/lanes/scalar.h"
#include "runtime/raster/clip.h"

namespace isoshade::vulkan {
namespace {

class ProbeArithmetic : public testing::Test {
 protected:
  struct Row {
    float a, b, c;
  };

  /// Of how many rows a device that computes `word` by `compute` gives other bits than the contract.
  template <class Compute>
  static size_t noticed(std::string_view word, Compute compute) {
    static const std::vector<Operands> rows = probe_operands();
    static const std::vector<int32_t> expected = expected_words(rows);
    const size_t words = word_topics().size();
    size_t index = 0;
    while (word_name(index) != word) ++index;
    size_t count = 0;
    for (size_t i = 0; i < rows.size(); ++i) {
      const Row row{lanes::from_bits(rows[i].a), lanes::from_bits(rows[i].b), lanes::from_bits(rows[i].c)};
      count += lanes::bits(compute(row)) != expected[i * words + index] ? 1 : 0;
    }
    return count;
  }

  /// The host without FTZ and DAZ but for a flush of results.
  static float flushed(float x) { return lanes::from_bits(lanes::bits_nonnan(x)); }
};

TEST_F(ProbeArithmetic, AcceptsConformingArithmetic) {
  const auto guarded = [](auto compute) {
    return [compute](const Row& row) {
      const lanes::FpGuard guard;
      volatile float a = row.a, b = row.b;
      volatile float result = compute(a, b);
      return static_cast<float>(result);
    };
  };
  EXPECT_EQ(noticed("sum", guarded([](float a, float b) { return a + b; })), 0u);
  EXPECT_EQ(noticed("product", guarded([](float a, float b) { return a * b; })), 0u);
  EXPECT_EQ(noticed("quotient", guarded([](float a, float b) { return a / b; })), 0u);
}

TEST_F(ProbeArithmetic, DetectsKeptDenormals) {
  EXPECT_GT(noticed("difference", [](const Row& r) { return r.a - r.b; }), 100u);
  EXPECT_GT(noticed("product", [](const Row& r) { return r.a * r.b; }), 100u);
  EXPECT_GT(noticed("quotient", [](const Row& r) { return r.a / r.b; }), 100u);
}

TEST_F(ProbeArithmetic, DetectsFlushingBeforeRounding) {
  EXPECT_GT(noticed("product",
                    [](const Row& r) {
                      const double exact = static_cast<double>(r.a) * r.b;
                      return std::abs(exact) < 0x1p-126 ? std::copysign(0.0f, static_cast<float>(exact))
                                                        : static_cast<float>(exact);
                    }),
            10u);
}

TEST_F(ProbeArithmetic, DetectsFusedMultiplyAdd) {
  EXPECT_GT(noticed("multiply_add", [](const Row& r) { return flushed(std::fma(r.a, r.b, r.c)); }), 500u);
}

TEST_F(ProbeArithmetic, DetectsReorderedSums) {
  EXPECT_GT(noticed("back_again", [](const Row& r) { return r.b; }), 500u);
  EXPECT_GT(noticed("distributed", [](const Row& r) { return flushed(r.a * flushed(r.b + r.c)); }), 500u);
}

TEST_F(ProbeArithmetic, DetectsMisroundedQuotientsAndRoots) {
  // A device that errs by 2^-20 of the last place before it rounds.
  for (const double factor : {1 - 0x1p-44, 1 + 0x1p-44}) {
    EXPECT_GT(noticed("quotient",
                      [&](const Row& r) {
                        return flushed(static_cast<float>(static_cast<double>(r.a) / r.b * factor));
                      }),
              500u);
    EXPECT_GT(noticed("root",
                      [&](const Row& r) {
                        return flushed(static_cast<float>(std::sqrt(static_cast<double>(r.a)) * factor));
                      }),
              10u);
  }
}

TEST_F(ProbeArithmetic, DetectsMinAndMaxThatDropNan) {
  EXPECT_GT(noticed("lesser", [](const Row& r) { return std::fmin(r.a, r.b); }), 10u);
  EXPECT_GT(noticed("greater", [](const Row& r) { return std::fmax(r.a, r.b); }), 10u);
}

TEST_F(ProbeArithmetic, FitsOneTable) {
  EXPECT_LE(probe_operands().size(), max_table_rows);
  EXPECT_LE(word_topics().size(), max_result_words);
  std::set<Topic> seen(word_topics().begin(), word_topics().end());
  EXPECT_EQ(seen.size(), static_cast<size_t>(topic_count));
}

TEST(ProbeReport, NamesTheDeviceAndEveryFailedCheck) {
  Probe probe;
  probe.checks = {{"floor (fragment)", true, ""},
                  {"comparisons (vertex)", false, "3 differ"},
                  {"integers", false, "all"}};
  EXPECT_FALSE(probe.passed());
  support::Diagnostics diagnostics;
  report_unproven(probe, "Strange GPU", diagnostics);
  ASSERT_EQ(diagnostics.all().size(), 1u);
  EXPECT_EQ(diagnostics.all()[0].id, support::Id::unproven_device);
  const std::string text = diagnostics.text();
  for (const char* part : {"Strange GPU", "comparisons (vertex)", "3 differ", "integers"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
  EXPECT_EQ(text.find("floor"), std::string::npos) << text;
}

class ProbeCoverage : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Axis, ProbeCoverage, testing::Bool(),
                         [](const auto& along_y) { return std::string(along_y.param ? "y" : "x"); });

TEST_P(ProbeCoverage, CoversTheWholeGuardBand) {
  const CoverageScene scene = coverage_scene(guard_band, GetParam());
  int lowest = 0, highest = 0;
  for (size_t i = 0; i < scene.triangles.size(); i += lower::triangle_word::stride) {
    for (int k = 0; k < 6; ++k) {
      const int32_t position = scene.triangles[i + static_cast<size_t>(lower::triangle_word::position + k)];
      lowest = std::min(lowest, position);
      highest = std::max(highest, position);
    }
  }
  EXPECT_EQ(lowest, -raster::max_before_image * 256);
  EXPECT_EQ(highest, raster::max_image_size * 256);
}

TEST_P(ProbeCoverage, CoversOneToSevenEighthsOfThePixels) {
  const CoverageScene scene = coverage_scene(guard_band, GetParam());
  const float background[4] = {7, 7, 7, 7};
  const backends::Image image = expected_image(scene, background);
  const auto drawn = std::count_if(image.depth.begin(), image.depth.end(), [](float z) { return z > 0; });
  EXPECT_GT(drawn, static_cast<long>(image.depth.size() / 8));
  EXPECT_LT(drawn, static_cast<long>(image.depth.size() * 7 / 8));
}

/// The ids hold 12 bits of triangle and 18 of pixel.
TEST_P(ProbeCoverage, FitsTheBitsOfItsIds) {
  const CoverageScene scene = coverage_scene(guard_band, GetParam());
  EXPECT_LT(scene.values.size() / value_stride, (1u << 12) - 1);
  EXPECT_LE(scene.width * scene.height, 1 << 18);
}

}  // namespace
}  // namespace isoshade::vulkan
