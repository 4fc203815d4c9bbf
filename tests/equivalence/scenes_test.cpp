// SPDX-License-Identifier: Apache-2.0
// One scene, one image: on every backend, at every size, lane count and thread count. No tolerance anywhere.
#include "tests/equivalence/scenes.h"

#include <set>

#include "backends/cpu/lane_count.h"
#include "compiler/support/diagnostics.h"
#include "runtime/compare/golden.h"
#include "runtime/scene/encode.h"

namespace isoshade::equivalence {
namespace {

struct Size {
  int width, height;
};

constexpr Size sizes[] = {{640, 360}, {1280, 720}, {1921, 1081}, {64, 64}, {1, 1}, {3, 500}};

std::string text(Size size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

#ifdef ISOSHADE_VULKAN
TEST(Scenes, AreIdenticalOnCpuAndVulkanAtEverySize) {
  const auto cpu = cpu_backend();
  const auto vulkan = vulkan_backend();
  for (const std::string& path : shipped_scenes())
    for (const Size size : sizes) {
      // Depth of field reads hundreds of places for each pixel: large pictures of it take minutes.
      if (size.width > 640 && load(path).posts.size() > 6) continue;
      const render::Plan made = plan(path, size.width, size.height);
      expect_identical(draw(made, *cpu), draw(made, *vulkan), path + " " + text(size));
    }
}

TEST(Scenes, AreIdenticalAsOnAGpu) {
  const auto cpu = cpu_backend();
  const auto gpu = vulkan_backend(driver::Division::exact, true);
  for (const std::string& path : shipped_scenes())
    for (const Size size : {Size{320, 180}, Size{1, 1}, Size{67, 131}}) {
      const render::Plan made = plan(path, size.width, size.height);
      const backends::Image expected = draw(made, *cpu);
      for (int frame = 0; frame < 2; ++frame)
        expect_identical(expected, draw(made, *gpu), path + " " + text(size));
    }
}

TEST(Scenes, GpusMakeTheTrianglesThatTheHostMakes) {
  const auto cpu = cpu_backend();
  const auto gpu = vulkan_backend(std::nullopt, true);
  for (const char* name : {"cartoon_village", "inside_sphere", "shadows", "transparent", "motion_blur"}) {
    const render::Plan made = plan(scene_path(name), 320, 180);
    support::Diagnostics diagnostics;
    backends::Image image;
    render::DrawStats host, device;
    ASSERT_TRUE(render::render(made, *cpu, image, host, diagnostics));
    ASSERT_TRUE(render::render(made, *gpu, image, device, diagnostics));
    EXPECT_EQ(device.triangles, host.triangles) << name;
    EXPECT_EQ(device.made_vertices, host.made_vertices) << name;
    EXPECT_EQ(device.clip_seconds, 0) << name << ": the host made triangles";
  }
}

TEST(Scenes, AreIdenticalWithExactDivision) {
  const auto native = vulkan_backend(driver::Division::native);
  const auto exact = vulkan_backend(driver::Division::exact);
  for (const std::string& path : shipped_scenes()) {
    const render::Plan made = plan(path, 320, 180);
    expect_identical(draw(made, *native), draw(made, *exact), path);
  }
}
#endif

TEST(Scenes, AreIdenticalOnTheInterpreter) {
  const auto cpu = cpu_backend();
  const auto interpreter = interpreter::create();
  for (const std::string& path : shipped_scenes()) {
    const render::Plan made = plan(path, 64, 64);
    expect_identical(draw(made, *cpu), draw(made, *interpreter), path);
  }
}

TEST(Scenes, AreIdenticalForEveryLaneCountAndThreadCount) {
  const auto first = cpu_backend("1", 1);
  for (const std::string& path : shipped_scenes()) {
    const render::Plan made = plan(path, 321, 181);
    const backends::Image expected = draw(made, *first);
    for (const char* lanes : {"4", "8", "16", "8x2", "16x2"}) {
      if (!cpu::lane_count(lanes)->available()) continue;  // this machine has no registers of so many lanes
      for (const int threads : {1, 2}) {
        const auto backend = cpu_backend(lanes, threads);
        expect_identical(expected, draw(made, *backend),
                         path + " lanes " + lanes + " threads " + std::to_string(threads));
      }
    }
  }
}

TEST(Scenes, AreIdenticalWithEitherCompiler) {
  const auto gcc = cpu_backend("", 0, "g++");
  const auto clang = cpu_backend("", 0, "clang++");
  for (const std::string& path : shipped_scenes()) {
    const render::Plan made = plan(path, 320, 180);
    expect_identical(draw(made, *gcc), draw(made, *clang), path);
  }
}

TEST(Scenes, SkippingInvisibleDrawsChangesNoBit) {
  const auto cpu = cpu_backend();
  for (const std::string& path : shipped_scenes())
    expect_identical(draw(plan(path, 320, 180, true), *cpu), draw(plan(path, 320, 180, false), *cpu), path);
}

TEST(Golden, MatchesEveryShippedSceneAtItsOwnSize) {
  support::Diagnostics diagnostics;
  const auto goldens = compare::read_goldens(ISOSHADE_GOLDENS, diagnostics);
  ASSERT_TRUE(goldens.has_value()) << diagnostics.text();
  const auto cpu = cpu_backend();
  std::set<std::string> shipped;
  for (const std::string& path : shipped_scenes()) {
    const scene::Scene scene = load(path);
    const backends::Image image = draw(plan(path), *cpu);
    const auto bytes = scene::encode(image.rgba, scene.output.encoding, scene.output.exposure);
    const compare::Golden found{image.width, image.height, compare::image_hash(image),
                                compare::encoded_hash(image.width, image.height, bytes)};
    const std::string key = compare::golden_key(path, ISOSHADE_GOLDENS);
    shipped.insert(key);
    EXPECT_EQ(compare::golden_mismatch(*goldens, key, "default", found), "") << path;
  }
  for (const auto& [key, tiers] : *goldens)
    EXPECT_TRUE(shipped.contains(key)) << key << " is no shipped scene";
}

}  // namespace
}  // namespace isoshade::equivalence
