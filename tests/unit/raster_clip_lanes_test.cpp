// SPDX-License-Identifier: Apache-2.0
// The clipper at each number of lanes and threads against its plain form.
#include <algorithm>
#include <bit>
#include <gtest/gtest.h>
#include <ostream>
#include <string>
#include <vector>

#include "runtime/raster/clip.h"
#include "runtime/raster/reference.h"
#include "runtime/raster/tile.h"
#include "tests/unit/raster_surfaces.h"

namespace isoshade::raster {
namespace {

using Scene = RandomSurfaces;
constexpr size_t stride = lower::vertex_word::stride;

struct LanesAndThreads {
  int lanes, threads;
  friend void PrintTo(const LanesAndThreads& v, std::ostream* out) { *out << v.lanes << " lanes " << v.threads << " threads"; }
};

class ClipperAt : public testing::TestWithParam<LanesAndThreads> {
 protected:
  void SetUp() override {
    if (GetParam().lanes > rasterizer_lanes()) GTEST_SKIP() << "this machine has no registers of so many lanes";
  }
};

TEST_P(ClipperAt, MatchesTheReference) {
  threads::Workers workers(GetParam().threads);
  Clipper clipper(GetParam().lanes);
  support::Array<float> vertices;
  support::Array<int32_t> triangles;
  int cut = 0;
  for (const auto& [width, height] : {std::pair{64, 64}, std::pair{1, 1}, std::pair{1000, 700}, std::pair{8192, 8192}})
    for (const unsigned seed : {1u, 2u}) {
      const Scene scene(seed * 100 + static_cast<unsigned>(width));
      std::vector<float> expected_vertices = scene.vertices;
      std::vector<int32_t> expected;
      for (const Surface& surface : scene.surfaces) clip_reference(surface, width, height, expected_vertices, expected);
      vertices.assign(scene.vertices.begin(), scene.vertices.end());
      clipper.run(scene.surfaces, width, height, workers, vertices, triangles);
      EXPECT_TRUE(std::ranges::equal(triangles, expected)) << width << " x " << height;
      const auto same = [](float a, float b) { return std::bit_cast<uint32_t>(a) == std::bit_cast<uint32_t>(b); };
      EXPECT_TRUE(std::ranges::equal(vertices, expected_vertices, same)) << width << " x " << height;
      cut += expected_vertices.size() > scene.vertices.size() && !expected.empty();
    }
  EXPECT_GE(cut, 6);
}

TEST_P(ClipperAt, ProjectsVerticesInAnyOrder) {
  const Scene scene(5);
  threads::Workers workers(GetParam().threads);
  Clipper whole(GetParam().lanes), steps(GetParam().lanes);
  support::Array<float> expected_vertices(scene.vertices.begin(), scene.vertices.end()), vertices = expected_vertices;
  support::Array<int32_t> expected, triangles;
  whole.run(scene.surfaces, 300, 200, workers, expected_vertices, expected);
  steps.begin(scene.surfaces, 300, 200);
  for (size_t s = scene.surfaces.size(); s-- > 0;) {
    const size_t count = scene.surfaces[s].clip.size() / 4, half = count / 2;
    steps.project(s, half, count - half);
    steps.project(s, 0, half);
  }
  steps.finish(workers, vertices, triangles);
  EXPECT_EQ(triangles, expected);
  EXPECT_EQ(vertices.size(), expected_vertices.size());
}

INSTANTIATE_TEST_SUITE_P(Raster, ClipperAt,
                         testing::Values(LanesAndThreads{4, 1}, LanesAndThreads{4, 3}, LanesAndThreads{8, 1},
                                         LanesAndThreads{8, 2}, LanesAndThreads{8, 7}, LanesAndThreads{16, 1},
                                         LanesAndThreads{16, 4}),
                         [](const auto& info) {
                           return std::to_string(info.param.lanes) + "x" + std::to_string(info.param.threads);
                         });

TEST(Clipper, MakesNothingOfNothing) {
  threads::Workers workers(2);
  support::Array<float> vertices(3 * stride);
  support::Array<int32_t> triangles(16);
  Clipper().run({}, 10, 10, workers, vertices, triangles);
  EXPECT_TRUE(triangles.empty());
  EXPECT_EQ(vertices.size(), 3 * stride);
}

}  // namespace
}  // namespace isoshade::raster
