// SPDX-License-Identifier: Apache-2.0
// Passes that are repeated give the same bits on every backend.
#include "backends/cpu/lane_count.h"
#include "tests/equivalence/scene_folder.h"

namespace isoshade::equivalence {
namespace {

/// The numbers of the repetition in each part of a pass: where vertices go, what is cut out, the color, blending, and in a
/// function; with a shadow, which every repetition casts.
const std::string effect = R"json({"isoshade": 1, "effect": "layers",
  "parameters": {"shells": {"type": "float", "value": 5.5, "min": 1, "max": 12}, "tint": {"type": "color3", "value": [1, 0.5, 0.25]}},
  "nodes": {
    "uv": {"type": "texcoord"}, "p": {"type": "position", "space": "object"}, "n": {"type": "normal", "space": "object"},
    "i": {"type": "passindex"}, "count": {"type": "passcount"}, "share": {"type": "share.json"},
    "moved": {"type": "expression", "code": "p + n * vector3(0.4 * share)", "p": "p", "n": "n", "share": "share"},
    "slope": {"type": "fwidth", "in": "bands"},
    "bands": {"type": "expression", "code": "fract(9 * uv.x + 0.37 * share) + float(i) / (7 * float(count))", "uv": "uv",
              "share": "share", "i": "i", "count": "count"},
    "lit": {"type": "sum_lights", "in": "one"}, "one": {"type": "lightcolor"},
    "color": {"type": "expression", "code": "tint * lit * color3(0.2 + 0.8 * share) + color3(0.01 * slope)", "tint": "tint",
              "lit": "lit", "share": "share", "slope": "slope"},
    "glass": {"type": "expression", "code": "color4(tint * lit, 0.1 + 0.2 * share)", "tint": "tint", "lit": "lit", "share": "share"}},
  "passes": [
    {"name": "skin", "color": "color"},
    {"name": "shells", "repeat": "shells", "position": "moved", "position_space": "object", "cutout": "bands", "cutoff": "share",
     "color": "color"},
    {"name": "veils", "repeat": 3, "cull": "none", "position": "moved", "position_space": "object", "blend": "over",
     "color": "glass"}]})json";
const std::string share = R"json({"isoshade": 1, "function": "share", "nodes": {"i": {"type": "passindex"}, "n": {"type": "passcount"},
  "out": {"type": "expression", "code": "float(i + 1) / float(n)", "i": "i", "n": "n"}}, "outputs": {"out": "out"}})json";

const std::string members = R"("size": [160, 120], "camera": {"position": [1, 1.6, 4], "target": [0, 0, 0], "fov": 45},
  "background": [0.1, 0.2, 0.3, 1],
  "lights": {"sun": {"type": "directional", "direction": [-1, -2, -0.7], "intensity": 2, "shadow": {"size": 64}}},
  "objects": {
    "ground": {"mesh": {"type": "plane", "size": [6, 6]}, "effect": "layers.json", "transform": {"translate": [0, -1.2, 0]},
               "parameters": {"shells": 1, "tint": [0.3, 0.6, 0.4]}},
    "balls": {"mesh": {"type": "sphere", "radius": 0.6, "segments": 24, "rings": 12}, "effect": "layers.json",
              "repeat": [{"count": 2, "step": [1.3, 0, -0.4], "parameters": {"shells": {"values": [3, 12]}}}]},
    "box": {"mesh": "box", "effect": "layers.json", "transform": {"translate": [-1.2, 0, 0], "scale": [-1, 1, 1]}}})";

class Repeats : public SceneFolder {
 protected:
  Repeats() {
    folder_.write("layers.json", effect);
    folder_.write("share.json", share);
  }

  using SceneFolder::plan;
  render::Plan plan(Size size, int samples) { return plan(size, samples, members); }
};

TEST_F(Repeats, AreIdenticalForEveryLaneCountAndOnTheInterpreter) {
  const auto interpreter = interpreter::create();
  for (const int samples : {1, 4, 16}) {
    const Size size = samples == 16 ? Size{37, 29} : Size{97, 71};
    const render::Plan made = plan(size, samples);
    const backends::Image expected = draw(made, *interpreter);
    for (const char* lanes : {"1", "4", "8", "8x2"}) {
      if (!cpu::lane_count(lanes)->available()) continue;  // this machine has no registers of so many lanes
      expect_identical(expected, draw(made, *cpu_backend(lanes, 2)), text(size, samples) + " lanes " + lanes);
    }
  }
}

#ifdef ISOSHADE_VULKAN
TEST_F(Repeats, AreIdenticalOnCpuAndVulkanAtEverySize) {
  const auto cpu = cpu_backend();
  const auto vulkan = vulkan_backend();
  for (const int samples : {1, 4, 16})
    for (const Size size : {Size{160, 120}, Size{1, 1}, Size{37, 211}}) {
      const render::Plan made = plan(size, samples);
      expect_identical(draw(made, *cpu), draw(made, *vulkan), text(size, samples));
    }
}
#endif

TEST_F(Repeats, EachIsDrawnWithItsNumber) {
  folder_.write("steps.json", R"json({"isoshade": 1, "effect": "steps", "nodes": {"i": {"type": "passindex"}, "n": {"type": "passcount"},
    "p": {"type": "position"},
    "moved": {"type": "expression", "code": "p + vector3(float(i), 0, 0)", "p": "p", "i": "i"},
    "v": {"type": "expression", "code": "vector3(float(i), float(n), 0)", "i": "i", "n": "n"},
    "color": {"type": "convert", "in": "v", "to": "color3"}},
    "passes": [{"name": "p", "repeat": 4, "position": "moved", "color": "color"}]})json");
  const render::Plan made = plan({40, 10}, 1, R"("camera": {"type": "orthographic", "position": [1.5, 0, 5], "target": [1.5, 0, 0],
    "height": 1}, "objects": {"a": {"mesh": {"type": "plane"}, "effect": "steps.json", "transform": {"rotate": [90, 0, 0]}}})");
  const backends::Image image = draw(made, *cpu_backend());
  for (int i = 0; i < 4; ++i) {
    const float* const rgba = &image.rgba[static_cast<size_t>(4 * (5 * 40 + 10 * i + 5))];
    EXPECT_EQ(rgba[0], static_cast<float>(i));
    EXPECT_EQ(rgba[1], 4.0f);
  }
}

}  // namespace
}  // namespace isoshade::equivalence
