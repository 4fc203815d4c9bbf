// SPDX-License-Identifier: Apache-2.0
// In each precision tier a scene is one image on every backend, and all tiers have the same depth.
#include <bit>

#include "backends/cpu/lane_count.h"
#include "runtime/compare/golden.h"
#include "runtime/scene/encode.h"
#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

using functions::Tier;

constexpr Tier others[] = {Tier::fast, Tier::precise};

std::string label(const std::string& path, Tier tier) {
  return path + " " + std::string(functions::tier_name(tier));
}

#ifdef ISOSHADE_VULKAN
TEST(Tiers, AreIdenticalOnCpuAndVulkan) {
  const auto cpu = cpu_backend();
  const auto native = vulkan_backend(driver::Division::native);
  const auto exact = vulkan_backend(driver::Division::exact);
  for (const std::string& path : shipped_scenes())
    for (const Tier tier : others) {
      const render::Plan made = plan(path, 320, 180, true, tier);
      const backends::Image expected = draw(made, *cpu);
      expect_identical(expected, draw(made, *native), label(path, tier));
      expect_identical(expected, draw(made, *exact), label(path, tier) + ", exact division");
    }
}
#endif

TEST(Tiers, AreIdenticalForEveryLaneCountAndOnTheInterpreter) {
  const auto interpreter = interpreter::create();
  for (const Tier tier : others) {
    const render::Plan made = plan(scene_path("material_balls"), 64, 36, true, tier);
    const backends::Image expected = draw(made, *interpreter);
    for (const char* lanes : {"1", "4", "8", "16", "8x2", "16x2"})
      if (cpu::lane_count(lanes)->available())
        expect_identical(expected, draw(made, *cpu_backend(lanes)), std::string("lanes ") + lanes);
  }
}

TEST(Tiers, HaveTheSameDepth) {
  const auto cpu = cpu_backend();
  for (const std::string& path : shipped_scenes()) {
    const backends::Image expected = draw(plan(path, 320, 180), *cpu);
    for (const Tier tier : others)
      EXPECT_EQ(draw(plan(path, 320, 180, true, tier), *cpu).depth, expected.depth);
  }
}

TEST(Golden, MatchesScenesInTheRecordedTiers) {
  support::Diagnostics diagnostics;
  const auto goldens = compare::read_goldens(ISOSHADE_GOLDENS, diagnostics);
  ASSERT_TRUE(goldens.has_value()) << diagnostics.text();
  const auto cpu = cpu_backend();
  int held = 0;
  for (const std::string& path : shipped_scenes()) {
    const std::string key = compare::golden_key(path, ISOSHADE_GOLDENS);
    const auto recorded = goldens->find(key);
    if (recorded == goldens->end()) continue;  // scenes_test tells
    for (const Tier tier : others) {
      const std::string name(functions::tier_name(tier));
      if (!recorded->second.contains(name)) continue;
      const scene::Scene scene = load(path);
      const backends::Image image = draw(plan(path, 0, 0, true, tier), *cpu);
      const auto bytes = scene::encode(image.rgba, scene.output.encoding, scene.output.exposure);
      const compare::Golden found{image.width, image.height, compare::image_hash(image),
                                  compare::encoded_hash(image.width, image.height, bytes)};
      EXPECT_EQ(compare::golden_mismatch(*goldens, key, name, found), "") << label(path, tier);
      ++held;
    }
  }
  EXPECT_GE(held, 4);
}

}  // namespace
}  // namespace isoshade::equivalence
