// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <bit>
#include <cstring>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include "backends/cpu/backend.h"
#include "runtime/threads/workers.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/raster/reference.h"
#include "runtime/raster/triangle.h"
#include "tests/unit/backend_frame.h"
#include "tests/unit/cpu_folders.h"
#include "tests/unit/cpu_programs.h"

namespace isoshade::cpu {
namespace {

using backends::Backend;
using backends::Image;
using backends::object_stride;
using backends::render;
using backends::same_bits;
using threads::Workers;
using driver::Program;
using driver::Stage;
using support::Diagnostics;
using support::Id;

/// One cache for all tests of this file, so that each text is compiled once for each lane count.
const std::string& cache() {
  static const TestFolder folder;
  return folder.path();
}

std::unique_ptr<Backend> backend(const std::string& lanes, int threads) {
  Diagnostics diagnostics;
  CpuOptions options;
  options.lanes = lanes;
  options.threads = threads;
  options.cache = cache();
  options.cpp = text_of;
  std::unique_ptr<Backend> made = create(options, diagnostics);
  EXPECT_TRUE(made) << diagnostics.text();
  return made;
}

/// A scene of hand-written programs.
struct Scene : backends::TestFrame {
  Program vertex = program_of(Stage::vertex), pixel = program_of(Stage::pixel);

  Scene(int width, int height, int objects) : TestFrame(width, height, objects) {
    frame.programs = {&vertex, &pixel};
  }
};

class CpuLanes : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!lane_count(GetParam())->available()) GTEST_SKIP() << "this machine has no such registers";
  }
};

TEST_P(CpuLanes, TransformsEveryVertex) {
  const Scene test(64, 64, 5);
  Diagnostics diagnostics;
  support::Array<float> clip;
  ASSERT_TRUE(backend(GetParam(), 2)->transform(test.pass(), clip, diagnostics)) << diagnostics.text();
  ASSERT_EQ(clip.size(), 5u * 4u * 30);
  for (size_t d = 0; d < 5; ++d) {
    const float* const of_draw = &clip[d * 4 * 30];
    for (size_t v = 0; v < 30; ++v) {
      const float* position = test.frame.vertices.data() + (30 * d + v) * lower::vertex_word::stride;
      const float scale = test.frame.objects[d * object_stride];
      EXPECT_EQ(of_draw[4 * v], position[0] * scale);
      EXPECT_EQ(of_draw[4 * v + 1], position[1] * scale);
      EXPECT_EQ(of_draw[4 * v + 2], position[2]);
      EXPECT_EQ(of_draw[4 * v + 3], 1.0f);
    }
  }
}

TEST(CpuBackend, EmptyTilesOfADepthImageAreRightWhateverWasThereBefore) {
  const auto cpu = backend("4", 2);
  const auto expect_right = [&](const Scene& test, const char* what) {
    EXPECT_TRUE(same_bits(render(*cpu, test).depth, render(*backend("4", 2), test).depth)) << what;
  };
  Scene few(640, 448, 2), many(640, 448, 12), colored(256, 224, 12);
  few.view().target.has_color = many.view().target.has_color = false;
  expect_right(few, "at first");
  expect_right(few, "again");
  expect_right(many, "more");
  expect_right(few, "less");
  cpu->write(0, std::vector<float>(size_t{640} * 448, 0.5f));
  expect_right(few, "after a write");
  // Its depth and its color take as many floats.
  expect_right(colored, "with color");
  expect_right(few, "after one with color");
}

TEST_P(CpuLanes, ReportsProgramBuildTime) {
  const Scene test(64, 64, 5);
  const auto cpu = backend(GetParam(), 2);
  EXPECT_EQ(cpu->build_seconds(), 0);
  Diagnostics diagnostics;
  support::Array<float> clip;
  ASSERT_TRUE(cpu->transform(test.pass(), clip, diagnostics)) << diagnostics.text();
  EXPECT_GT(cpu->build_seconds(), 0);
}

TEST_P(CpuLanes, ShadesEachVisiblePixelWithItsTriangleAndObject) {
  const auto cpu = backend(GetParam(), 2);
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{200, 150}, std::pair{65, 129}}) {
    const Scene test(width, height, 60);
    Diagnostics diagnostics;
    support::Array<float> clip;
    support::Array<float> vertices;
    support::Array<int32_t> triangles;
    Image image;
    ASSERT_TRUE(cpu->transform(test.pass(), clip, diagnostics)) << diagnostics.text();
    test.assemble(clip, *cpu, vertices, triangles);
    ASSERT_TRUE(draw(*cpu, test.pass(), vertices, triangles, image, diagnostics)) << diagnostics.text();

    std::vector<int32_t> ids(static_cast<size_t>(width) * height);
    std::vector<float> depth(ids.size());
    raster::rasterize_reference(triangles, raster::box_at(0, 0, width, height), ids, depth);
    EXPECT_TRUE(same_bits(image.depth, depth));
    int visible = 0;
    for (size_t i = 0; i < ids.size(); ++i) {
      const float* color = image.rgba.data() + 4 * i;
      if (ids[i] < 0) {
        ASSERT_EQ(std::memcmp(color, test.view().background, 16), 0) << "pixel " << i;
        continue;
      }
      ++visible;
      const int object = raster::triangle_at(triangles.data(), ids[i]).object();
      ASSERT_EQ(color[0], static_cast<float>(i % static_cast<size_t>(width)));
      if (i == 0)
        ASSERT_EQ(std::bit_cast<uint32_t>(color[1]), 0x7fc00000u);
      else
        ASSERT_EQ(color[1], static_cast<float>(i / static_cast<size_t>(width)));
      ASSERT_EQ(color[2], static_cast<float>(ids[i]));
      ASSERT_EQ(color[3], test.frame.objects[static_cast<size_t>(object)] * 3);
    }
    if (width > 1) { EXPECT_GT(visible, width * height / 4); }
  }
}

TEST_P(CpuLanes, EvaluatesEveryRowFlushingDenormalsOnEveryThread) {
  // TBB hands its threads the float mode of its first use: make that the wrong one.
  tbb::parallel_for(0, 1000, [](int) {});
  const auto cpu = backend(GetParam(), 4);
  const Program program = program_of(Stage::eval);
  for (const size_t rows : {size_t{0}, size_t{1}, size_t{33}, size_t{100000}}) {
    std::vector<int32_t> inputs, outputs;
    for (size_t i = 0; i < rows; ++i) {
      inputs.push_back(std::bit_cast<int32_t>(1e-20f));
      inputs.push_back(std::bit_cast<int32_t>(i % 2 ? 1e-19f : 1.0f));
    }
    Diagnostics diagnostics;
    ASSERT_TRUE(cpu->evaluate(program, inputs, rows, outputs, diagnostics)) << diagnostics.text();
    ASSERT_EQ(outputs.size(), 2 * rows);
    for (size_t i = 0; i < rows; ++i) {
      ASSERT_EQ(outputs[2 * i], i % 2 ? 0 : std::bit_cast<int32_t>(1e-20f)) << i;
      ASSERT_EQ(outputs[2 * i + 1], static_cast<int32_t>(i));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cpu, CpuLanes, testing::Values("1", "4", "8", "16", "8x2", "16x2"),
                         [](const auto& info) { return std::string(info.param); });

TEST(CpuBackend, DrawsTheSameImageWithAnyNumberOfThreads) {
  const Scene test(333, 222, 400);
  const Image one = render(*backend("4", 1), test);
  for (const int threads : {2, 3, 8}) {
    const Image many = render(*backend("4", threads), test);
    EXPECT_TRUE(same_bits(one.rgba, many.rgba)) << threads;
    EXPECT_TRUE(same_bits(one.depth, many.depth)) << threads;
  }
}

TEST(CpuBackend, DrawsTheBackgroundWithoutTriangles) {
  Scene test(130, 70, 0);
  const Image image = render(*backend("4", 0), test);
  ASSERT_EQ(image.depth.size(), 130u * 70);
  for (size_t i = 0; i < image.depth.size(); ++i) {
    ASSERT_EQ(image.depth[i], 0.0f);
    ASSERT_EQ(std::memcmp(image.rgba.data() + 4 * i, test.view().background, 16), 0);
  }
}

TEST(CpuBackend, PreservesTheCallersFloatMode) {
  const unsigned before = __builtin_ia32_stmxcsr();
  render(*backend("4", 1), Scene(64, 64, 20));
  EXPECT_EQ((__builtin_ia32_stmxcsr() ^ before) & 0xffc0u, 0u);
}

TEST(CpuBackend, ReportsUnsupportedLaneCounts) {
  for (const char* lanes : {"3", "32", "lots", "16x2"}) {
    if (lane_count(lanes) && lane_count(lanes)->available()) continue;
    Diagnostics diagnostics;
    CpuOptions options;
    options.lanes = lanes;
    EXPECT_FALSE(create(options, diagnostics));
    ASSERT_EQ(diagnostics.all().size(), 1u);
    EXPECT_EQ(diagnostics.all()[0].id, Id::bad_lanes);
  }
}

TEST(CpuBackend, DescriptionNamesLanesAndThreads) {
  const std::string text = backend("4", 1)->description();
  EXPECT_NE(text.find("lanes 4, 1 thread"), std::string::npos) << text;
}

TEST(Workers, RunEachTaskOnceWithDenormalsFlushed) {
  tbb::parallel_for(0, 1000, [](int) {});
  for (const int threads : {1, 2, 5}) {
    Workers workers(threads);
    EXPECT_EQ(workers.count(), threads);
    std::vector<std::atomic<int>> times(10000);
    std::atomic<int> wrong = 0;
    workers.for_each(times.size(), [&](size_t i) {
      ++times[i];
      wrong += (__builtin_ia32_stmxcsr() & 0xe040u) != 0x8040u;
    });
    for (const std::atomic<int>& n : times) ASSERT_EQ(n, 1);
    EXPECT_EQ(wrong, 0);
  }
}

}  // namespace
}  // namespace isoshade::cpu
