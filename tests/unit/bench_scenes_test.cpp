// SPDX-License-Identifier: Apache-2.0
// The ordinary renderer of scenes as a peer in the bench, and the table that compares it.
#include <gtest/gtest.h>

#include "runtime/bench/backends.h"

namespace isoshade::bench {
namespace {

TEST(BenchScenes, AnOrdinaryRendererIsTimedAndCompared) {
  BenchOptions options;
  options.graphs = ISOSHADE_GRAPHS;
  options.library = options.graphs + "/library";
  options.filter = "fog_balls";
  options.repetitions = 1;
  std::deque<render::Plan> plans;
  Report report;
  support::Diagnostics diagnostics;
  ASSERT_TRUE(measure_scenes(options, {}, plans, report, diagnostics)) << diagnostics.text();
  ASSERT_EQ(report.points.size(), 1u) << "no backend was given";
  const Point& point = report.points[0];
  EXPECT_EQ(point.effect, "fog_balls");
  EXPECT_EQ(point.form, "scene");
  EXPECT_EQ(point.precision, "built-ins");
  EXPECT_EQ(point.backend, forward_backend);
  EXPECT_GT(time_of(point), 0);
  EXPECT_GT(point.mean_ulp, 0) << "it has the bits of the exact result";
  EXPECT_LT(point.mean_ulp, 1e5) << "it drew something else";
  EXPECT_FALSE(point.identical);
  EXPECT_TRUE(all_identical(report)) << "its bits may differ";

  options.vulkan = false;
  Report without;
  ASSERT_TRUE(measure_scenes(options, {}, plans, without, diagnostics)) << diagnostics.text();
  EXPECT_TRUE(without.points.empty());
}

TEST(BenchScenes, TheTableComparesTheOrdinaryRendererWithOurs) {
  Report report;
  const auto add = [&](const char* scene, const char* precision, const char* backend, const char* lanes, double nanoseconds) {
    report.points.push_back({scene, "scene", precision, backend, lanes});
    report.points.back().nanoseconds = nanoseconds;
    report.points.back().mean_ulp = nanoseconds / 100;
  };
  add("balls", "fast", "vulkan", "", 1);
  add("balls", "default", "cpu", "16", 80);
  add("balls", "default", "vulkan", "", 300);
  EXPECT_EQ(ratios_text(report).find("forward"), std::string::npos) << "there is nothing to compare";
  add("balls", "built-ins", forward_backend, "", 200);
  EXPECT_NE(ratios_text(report).find("\n| balls | 80 | 300 | 200 | 0.67 | 2 / 3 |\n"), std::string::npos)
      << ratios_text(report);
}

}  // namespace
}  // namespace isoshade::bench
