// SPDX-License-Identifier: Apache-2.0
// The white furnace as a picture: under an even sky, what absorbs no light cannot be told from the sky.
#include "tests/equivalence/scenes.h"
#include "tests/unit/gltf_files.h"

namespace isoshade::equivalence {
namespace {

TEST(WhiteSky, MetalsAndDielectricsThatAreWhiteAreWhiteUnderIt) {
  const testing::Folder folder;
  folder.write("white.json", R"({"isoshade": 1, "effect": "white", "parameters": {
    "roughness": {"type": "float", "value": 0.5, "min": 0, "max": 1},
    "metallic": {"type": "float", "value": 1, "min": 0, "max": 1}},
    "nodes": {"n": {"type": "normal"}, "lit": {"type": "material/standard", "normal": "n", "base_color": [1, 1, 1],
      "metallic": "metallic", "roughness": "roughness"}}, "passes": [{"name": "base", "color": "lit"}]})");
  const render::Plan made = plan(folder.write("furnace.json", R"({"isoshade": 1, "scene": "s",
    "camera": {"position": [0, 0, 30], "target": [0, 0, 0], "fov": 20},
    "environment": {"sky": {"horizon": [1, 1, 1], "zenith": [1, 1, 1], "ground": [1, 1, 1]}},
    "objects": {"balls": {"mesh": "sphere", "effect": "white.json", "transform": {"translate": [-4, -2.5, 0]},
      "repeat": [{"count": 5, "step": [2, 0, 0], "parameters": {"roughness": {"values": [0, 0.05, 0.2, 0.5, 1]}}},
        {"count": 2, "step": [0, 4, 0], "parameters": {"metallic": {"from": 0, "to": 1}}}]}}})"), 120, 90);
  const backends::Image image = draw(made, *cpu_backend());
  int seen = 0;
  for (size_t i = 0; i < image.depth.size(); ++i) {
    if (image.depth[i] == 0) continue;
    ++seen;
    for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(image.rgba[4 * i + c], 1, 5e-6) << i;
  }
  EXPECT_GT(seen, 1000);
}

}  // namespace
}  // namespace isoshade::equivalence
