// SPDX-License-Identifier: Apache-2.0
// The shells of fur look like strands: pictures, counted in pixels.
#include <cmath>

#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

/// A ball of radius 1 in the middle of the picture, with fur of this length.
class Fur : public ::testing::Test {
 protected:
  static constexpr int side = 400;
  static constexpr float pixels = 100;  ///< of a unit

  backends::Image ball(const std::string& length) {
    const scene::Scene scene = load(std::make_shared<support::SourceFile>(ISOSHADE_GRAPHS "/scenes/furry_ball.json", R"({"isoshade": 1,
      "scene": "ball", "camera": {"type": "orthographic", "position": [0, 0, 5], "target": [0, 0, 0], "height": 4},
      "lights": {"sun": {"type": "directional", "direction": [-1, -1, -1], "intensity": 2}},
      "objects": {"ball": {"mesh": {"type": "sphere", "segments": 128, "rings": 64}, "effect": "../effects/fur.json",
        "parameters": {"length": )" + length + R"(, "gravity": [0, 0, 0], "tousle": 0, "density": 12, "thickness": 0.4}}}})"));
    return draw(equivalence::plan(scene, side, side), *cpu_backend());
  }
  static bool is_covered(const backends::Image& image, float x, float y) {
    const auto column = static_cast<int>(side / 2 + pixels * x), row = static_cast<int>(side / 2 - pixels * y);
    return image.depth[static_cast<size_t>(row * side + column)] > 0;
  }
};

TEST_F(Fur, ChangesTheSilhouetteOfTheMesh) {
  const backends::Image bald = ball("0"), furry = ball("0.4");
  size_t mesh = 0, outside = 0;
  for (size_t i = 0; i < bald.depth.size(); ++i) {
    mesh += bald.depth[i] > 0 ? 1 : 0;
    EXPECT_TRUE(bald.depth[i] == 0 || furry.depth[i] > 0) << "the fur has a hole in the skin";
    outside += bald.depth[i] == 0 && furry.depth[i] > 0 ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(mesh), 3.14159 * pixels * pixels, 0.01 * 3.14159 * pixels * pixels);
  EXPECT_GT(outside, mesh / 10);
  EXPECT_LT(outside, mesh * 96 / 100) << "strands of a length of 0.4 reach up to 1.4";
}

TEST_F(Fur, StrandsAreSeparateAtTheSilhouette) {
  const backends::Image furry = ball("0.4");
  const auto gaps = [&](float radius) {
    int changes = 0;
    bool before = is_covered(furry, radius, 0);
    for (int step = 1; step <= 3600; ++step) {
      const float angle = static_cast<float>(step) * 3.14159265f / 1800;
      const bool now = is_covered(furry, radius * std::cos(angle), radius * std::sin(angle));
      changes += now != before ? 1 : 0;
      before = now;
    }
    return changes / 2;
  };
  EXPECT_EQ(gaps(0.9f), 0);
  EXPECT_GT(gaps(1.2f), 30);
  EXPECT_EQ(gaps(1.45f), 0) << "beyond the longest strand";
}

}  // namespace
}  // namespace isoshade::equivalence
