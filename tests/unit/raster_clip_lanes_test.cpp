// SPDX-License-Identifier: Apache-2.0
// The clipper at each number of lanes and threads against its plain form.
#include <algorithm>
#include <bit>
#include <gtest/gtest.h>
#include <limits>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "compiler/lower/frame_layout.h"
#include "runtime/raster/clip.h"
#include "runtime/raster/reference.h"
#include "runtime/raster/tile.h"

namespace isoshade::raster {
namespace {

using interface::Cull;
using interface::DepthTest;
using interface::DepthWrite;

constexpr size_t stride = lower::vertex_word::stride;

/// Surfaces whose vertices lie inside, on and beyond every plane, and some that are not finite.
class Scene {
 public:
  std::vector<std::vector<float>> clips;
  std::vector<std::vector<uint32_t>> indices;
  std::vector<Surface> surfaces;
  std::vector<float> vertices;

  explicit Scene(unsigned seed) : random_(seed) {
    for (const size_t count : {1, 2, 3, 7, 64, 0, 300, 5000, 20000, 5, 4096}) add(count);
    for (size_t i = 0; i < clips.size(); ++i) {
      surfaces[i].clip = clips[i];
      surfaces[i].indices = indices[i];
    }
  }

 private:
  float between(float low, float high) { return low + (high - low) * static_cast<float>(random_() >> 8) / 16777216.0f; }
  bool one_in(unsigned n) { return random_() % n == 0; }

  void add(size_t triangles) {
    const size_t count = std::max<size_t>(3, triangles * 2 / 3);
    std::vector<float>& clip = clips.emplace_back();
    // Neighbours in the order of vertices are near each other, so that triangles are small; a few go anywhere.
    const float spread = between(0.01f, 0.3f);
    float x = between(-1.5f, 1.5f), y = between(-1.5f, 1.5f), w = between(0.2f, 3.0f);
    for (size_t i = 0; i < count; ++i) {
      x += between(-spread, spread), y += between(-spread, spread), w += between(-spread, spread);
      if (one_in(40)) x = between(-2, 2), y = between(-2, 2), w = between(-0.5f, 4.0f);
      const bool orthographic = one_in(50);
      float point[4] = {x, y, orthographic ? between(-0.1f, 1.1f) : 0.1f, orthographic ? 1.0f : w};
      if (one_in(60)) point[random_() % 2] *= 1000.0f;  // beyond the guard band
      if (one_in(70)) point[2] = point[3];              // on the near plane
      if (one_in(90)) point[2] = one_in(2) ? 0.0f : -0.0f;
      if (one_in(200)) point[3] = one_in(2) ? 0.0f : 1.2e-38f;
      if (one_in(300)) point[random_() % 4] = one_in(2) ? std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
      clip.insert(clip.end(), point, point + 4);
    }
    std::vector<uint32_t>& corners = indices.emplace_back();
    for (size_t i = 0; i < triangles; ++i) {
      const auto first = static_cast<uint32_t>(random_() % (count - 2));
      for (uint32_t k = 0; k < 3; ++k) corners.push_back(one_in(30) ? static_cast<uint32_t>(random_() % count) : first + k);
    }
    Surface surface;
    surface.first_vertex = static_cast<uint32_t>(vertices.size() / stride);
    surface.state.cull = std::vector{Cull::none, Cull::back, Cull::front}[random_() % 3];
    surface.state.depth = one_in(4) ? DepthTest::always : DepthTest::nearer;
    surface.state.depth_write = one_in(2) ? DepthWrite::on : DepthWrite::off;
    surface.object = static_cast<int>(surfaces.size());
    surface.mirrored = one_in(2);
    surface.cutout = one_in(3);
    surface.blended = one_in(3);
    if (one_in(3)) surface.bias = {between(0, 3), between(0, 1e-3f), between(0, 1e-4f)};
    surfaces.push_back(surface);
    for (size_t i = 0; i < count * stride; ++i) vertices.push_back(between(-10, 10));
  }

  std::mt19937 random_;
};

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
