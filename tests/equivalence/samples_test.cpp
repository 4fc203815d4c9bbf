// SPDX-License-Identifier: Apache-2.0
// Several samples a pixel: the image is that of all samples at once, resolved; on every backend, in whatever parts.
#include "runtime/render/samples.h"

#include <random>
#include <set>

#include "backends/cpu/lane_count.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/raster/clip.h"
#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

render::Plan plan_of(const std::string& path, int samples, int width, int height) {
  scene::Scene scene = load(path);
  scene.samples = samples;
  return plan(scene, width, height);
}

std::string text(const std::string& path, int samples, const backends::Image& image) {
  return path + " " + std::to_string(image.width) + "x" + std::to_string(image.height) + ", " +
         std::to_string(samples) + " samples";
}

void expect_parts_to_make_up_the_whole(backends::Backend& backend) {
  // Not multiples of the parts' size, and more than one part each way.
  for (const char* name :
       {"borders", "slivers", "inside_sphere", "textures", "material_balls", "derivatives"}) {
    const std::string path = scene_path(name);
    for (const int samples : {4, 16}) {
      render::Plan made = plan_of(path, samples, 530, 283);
      const backends::Image image = draw(made, backend);
      made.samples = 1;  // all samples are an image
      backends::Image whole = draw(made, backend);
      whole = resolved_to(whole, image.width);
      expect_identical(whole, image, text(path, samples, image));
    }
  }
}

TEST(Samples, DrawingInPartsMatchesDrawingAtOnceOnCpu) { expect_parts_to_make_up_the_whole(*cpu_backend()); }

TEST(Samples, FogIsThatOfEachSample) {
  // Its picture is that of a scene as large as all samples, resolved. (Nothing in it depends on the size of a pixel.)
  const auto cpu = cpu_backend();
  for (const char* name : {"fog_balls", "fog_valley"}) {
    const std::string path = scene_path(name);
    for (const int samples : {4, 16}) {
      const int side = render::samples_each_way(samples);
      const render::Plan made = plan_of(path, samples, 331, 90);
      EXPECT_EQ(made.posts.sample_steps, made.posts.steps.size());
      const backends::Image image = draw(made, *cpu);
      render::Plan large = plan_of(path, 1, side * 331, side * 90);
      backends::Image whole = draw(large, *cpu);
      whole = resolved_to(whole, image.width);
      expect_identical(whole, image, text(path, samples, image));
    }
  }
}

TEST(Samples, MatchTheRecordedHashes) {
  const auto cpu = cpu_backend();
  const auto hash = [&](int samples) {
    return compare::image_hash(draw(plan_of(scene_path("material_balls"), samples, 160, 90), *cpu));
  };
  EXPECT_EQ(hash(4), "34a570a47c1935925c1cceaef6c2cad9b5476de11f85104473379366c8e7f090");
  EXPECT_EQ(hash(16), "0207388d78c2f3dbf427644c8445b8cc3eb920cad2415b8762e3a94e3a25984d");
}

TEST(Samples, AreIdenticalForEveryLaneCount) {
  const auto first = cpu_backend("1", 1);
  for (const char* name : {"cartoon_tub", "fog_balls", "textures"})
    for (const int samples : {4, 16}) {
      const std::string path = scene_path(name);
      const render::Plan made = plan_of(path, samples, 301, 67);
      const backends::Image expected = draw(made, *first);
      for (const char* lanes : {"4", "8", "16", "8x2", "16x2"}) {
        if (!cpu::lane_count(lanes)->available()) continue;  // this machine has no registers of so many lanes
        expect_identical(expected, draw(made, *cpu_backend(lanes, 2)), text(path, samples, expected) + lanes);
      }
    }
}

TEST(Samples, AreIdenticalOnTheInterpreter) {
  const auto cpu = cpu_backend();
  const auto interpreter = interpreter::create();
  for (const std::string& path : shipped_scenes())
    for (const int samples : {4, 16}) {
      const render::Plan made = plan_of(path, samples, 27, 19);
      const backends::Image image = draw(made, *cpu);
      expect_identical(image, draw(made, *interpreter), text(path, samples, image));
    }
}

#ifdef ISOSHADE_VULKAN
TEST(Samples, DrawingInPartsMatchesDrawingAtOnceOnVulkan) {
  expect_parts_to_make_up_the_whole(*vulkan_backend());
}

TEST(Samples, AreIdenticalOnCpuAndVulkanAtEverySize) {
  struct Size {
    int width, height;
  };
  const auto cpu = cpu_backend();
  const auto vulkan = vulkan_backend(), gpu = vulkan_backend(std::nullopt, true);
  for (const std::string& path : shipped_scenes())
    for (const int samples : {4, 16})
      for (const Size size : {Size{640, 360}, Size{1, 1}, Size{3, 500}}) {
        // Depth of field reads hundreds of places for each pixel: large pictures of it take minutes.
        if (size.width == 640 && samples == 16 && load(path).posts.size() > 6) continue;
        const render::Plan made = plan_of(path, samples, size.width, size.height);
        const backends::Image image = draw(made, *cpu);
        expect_identical(image, draw(made, *vulkan), text(path, samples, image));
        if (size.width < 640)
          expect_identical(image, draw(made, *gpu), text(path, samples, image) + ", as on a GPU");
      }
}

/// Triangles that end in the window's first pixels, or go through it, and begin wherever clipping leaves corners.
class WideTriangles {
 public:
  WideTriangles(const backends::Window& window, int object)
      : window_(window), object_(object), random_(static_cast<unsigned>(window.x + 8192 * window.y)) {}

  std::vector<int32_t> make(int count) {
    std::vector<int32_t> triangles;
    while (count > 0) {
      const Position a = near(), b = far(), c = random_() % 4 == 0 ? near() : far();
      const int64_t area = int64_t{b.x - a.x} * (c.y - a.y) - int64_t{b.y - a.y} * (c.x - a.x);
      if (area == 0) continue;
      add(area > 0 ? std::array{a, b, c} : std::array{a, c, b}, triangles);
      --count;
    }
    return triangles;
  }

 private:
  struct Position {
    int x, y;
  };
  static constexpr int first = -256 * raster::max_before_image, last = 256 * raster::max_image_size;

  int between(int low, int high) {
    return low + static_cast<int>(random_() % static_cast<unsigned>(high - low + 1));
  }
  /// In or around the window's first 64 x 64 pixels, or its first.
  Position near() {
    const int end = random_() % 2 == 0 ? 0 : 256 * 64;
    const auto around = [&](int begin) { return std::min(256 * begin + between(-2560, end + 2560), last); };
    return {around(window_.x), around(window_.y)};
  }
  /// Anywhere, but often before the window.
  Position far() {
    const bool before = random_() % 2 == 0;
    return {between(first, before ? 256 * window_.x : last), between(first, before ? 256 * window_.y : last)};
  }
  void add(const std::array<Position, 3>& corners, std::vector<int32_t>& triangles) {
    namespace word = lower::triangle_word;
    std::array<int32_t, word::stride> record{};
    for (int i = 0; i < 3; ++i) {
      record[word::vertex + i] = i;
      record[word::position + 2 * i] = corners[i].x;
      record[word::position + 2 * i + 1] = corners[i].y;
      record[word::depth + i] = between(0x3f000000, 0x3f7fffff);
      record[word::inverse_w + i] = 0x3f800000;
    }
    record[word::object] = (object_ << lower::triangle_flag::bits) | lower::triangle_flag::wide;
    triangles.insert(triangles.end(), record.begin(), record.end());
  }

  backends::Window window_;
  int object_;
  std::mt19937 random_;
};

TEST(Parts, TrianglesThatStartFarOutsideMatchTheCpu) {
  const auto cpu = cpu_backend();
  const auto vulkan = vulkan_backend();
  render::Plan made = plan(scene_path("borders"));
  backends::View& view = made.frame.views.back();
  view.target.width = view.target.height = raster::max_image_size;
  const int object = view.draws[0].object;
  support::Diagnostics diagnostics;
  for (const backends::Window window : {backends::Window{3072, 4096, 128, 128},
                                        {8000, 0, 192, 64},
                                        {0, 8128, 65, 64},
                                        {7168, 7168, 1024, 1024},
                                        {1024, 1024, 70, 1},
                                        {64, 1, 33, 70}}) {
    WideTriangles shapes(window, object);
    for (int i = 0; i < 150; ++i) {
      const std::vector<int32_t> triangles = shapes.make(3);  // so few that they do not hide each other
      backends::Image images[2];
      for (const bool second : {false, true}) {
        backends::Backend& backend = second ? *vulkan : *cpu;
        backends::SlotAllocator slots;
        const backends::Slot depth = slots.take(window.width, window.height, 1);
        const backends::Slot color = slots.take(window.width, window.height, 4);
        ASSERT_TRUE(backend.reserve(slots.length(), diagnostics));
        ASSERT_TRUE(backend.draw({.pass = {made.frame, view},
                                  .vertices = made.frame.vertices,
                                  .triangles = triangles,
                                  .window = window,
                                  .depth = depth,
                                  .color = color},
                                 diagnostics))
            << diagnostics.text();
        const auto rgba = backend.read(color), depths = backend.read(depth);
        images[second] = {window.width, window.height, {rgba.begin(), rgba.end()}, {depths.begin(), depths.end()}};
      }
      expect_identical(images[0], images[1], std::to_string(window.x) + "," + std::to_string(window.y));
    }
  }
}
#endif

}  // namespace
}  // namespace isoshade::equivalence
