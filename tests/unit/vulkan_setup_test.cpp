// SPDX-License-Identifier: Apache-2.0
// The setup stage against the clipper of the host: one triangle at a time, in the interpreter.
#include <array>
#include <bit>
#include <gtest/gtest.h>

#include "backends/vulkan/geometry.h"
#include "compiler/driver/driver.h"
#include "compiler/ir/interpreter.h"
#include "compiler/lower/setup.h"
#include "runtime/raster/reference.h"
#include "tests/unit/raster_surfaces.h"

namespace isoshade::vulkan {
namespace {

namespace state = lower::setup_state;

struct Counts {
  int kept = 0, dropped = 0, cut = 0;
};

void expect_as_the_host(const raster::RandomSurfaces& scene, int width, int height, Counts& counts) {
  const driver::Program& program = driver::setup_program();
  ir::Interpreter interpreter(program.module);
  std::vector<float> vertices = scene.vertices;
  for (const raster::Surface& surface : scene.surfaces) {
    std::vector<int32_t> inputs;
    append_surface(surface, raster::Viewport(width, height), inputs);
    std::vector<uint32_t> words;
    for (const int32_t word : inputs) words.push_back(static_cast<uint32_t>(word));
    interpreter.bind(static_cast<uint32_t>(lower::FrameBuffer::inputs), words);
    for (size_t i = 0; i + 2 < surface.indices.size(); i += 3) {
      std::vector<uint32_t> arguments, results(1 + lower::triangle_word::stride);
      for (size_t k = 0; k < 3; ++k)
        for (size_t c = 0; c < 4; ++c)
          arguments.push_back(std::bit_cast<uint32_t>(surface.clip[4 * surface.indices[i + k] + c]));
      for (size_t k = 0; k < 3; ++k) arguments.push_back(surface.first_vertex + surface.indices[i + k]);
      arguments.push_back(0);  // the surface
      ASSERT_TRUE(interpreter.run(program.entry, arguments, results));

      raster::Surface one = surface;
      one.indices = surface.indices.subspan(i, 3);
      std::vector<int32_t> expected;
      raster::clip_reference(one, width, height, vertices, expected);
      const std::vector<int32_t> record(results.begin() + 1, results.end());
      switch (results[0]) {
        case state::kept:
          ++counts.kept;
          EXPECT_EQ(record, expected);
          break;
        case state::dropped:
          ++counts.dropped;
          EXPECT_TRUE(expected.empty());
          break;
        case state::cut: ++counts.cut; break;  // the host may still drop it
        default: ADD_FAILURE() << "no such state";
      }
      if (results[0] == state::kept) continue;
      for (int w = 0; w < 6; ++w)
        EXPECT_EQ(record[static_cast<size_t>(lower::triangle_word::position + w)], 0);
    }
  }
}

TEST(Setup, MakesTheRecordsOfTheHost) {
  Counts counts;
  for (const auto& [width, height] :
       {std::pair{64, 64}, std::pair{1, 1}, std::pair{1000, 700}, std::pair{8192, 8192}})
    expect_as_the_host(raster::RandomSurfaces(static_cast<unsigned>(width)), width, height, counts);
  EXPECT_GT(counts.kept, 1000);
  EXPECT_GT(counts.dropped, 1000);
  EXPECT_GT(counts.cut, 100);
}

/// What is left of a cut triangle is what the clipper of all triangles leaves of it.
TEST(Setup, CutsTrianglesAsTheHost) {
  const raster::RandomSurfaces scene(7);
  const raster::Viewport viewport(300, 200);
  const lanes::FpGuard guard;
  int left = 0;
  for (const raster::Surface& surface : scene.surfaces) {
    for (size_t i = 0; i + 2 < surface.indices.size(); i += 3) {
      raster::CutTriangle triangle{surface.indices.subspan(i, 3), {}};
      for (size_t k = 0; k < 3; ++k) {
        const float* p = surface.clip.data() + size_t{4} * triangle.indices[k];
        triangle.points[k] = {p[0], p[1], p[2], p[3]};
      }
      std::vector<float> expected_made = scene.vertices, made;
      std::vector<int32_t> expected, triangles;
      raster::Surface one = surface;
      one.indices = triangle.indices;
      raster::clip_reference(one, 300, 200, expected_made, expected);
      raster::cut_triangle(viewport, surface, triangle, scene.vertices,
                           static_cast<int32_t>(scene.vertices.size() / lower::vertex_word::stride), made,
                           triangles);
      EXPECT_EQ(triangles, expected);
      ASSERT_EQ(made.size(), expected_made.size() - scene.vertices.size());
      for (size_t f = 0; f < made.size(); ++f)
        EXPECT_EQ(std::bit_cast<uint32_t>(made[f]),
                  std::bit_cast<uint32_t>(expected_made[scene.vertices.size() + f]));
      left += !made.empty();
    }
    if (left > 50) return;
  }
  ADD_FAILURE() << "few triangles are cut";
}

}  // namespace
}  // namespace isoshade::vulkan
