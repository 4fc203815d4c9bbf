// SPDX-License-Identifier: Apache-2.0
// Shadows give the same bits on every backend; they lie where geometry says, without stripes and without gaps.
#include <algorithm>
#include <cmath>

#include "backends/cpu/lane_count.h"
#include "compiler/lower/frame_layout.h"
#include "tests/equivalence/scene_folder.h"

namespace isoshade::equivalence {
namespace {

/// The light that arrives, whatever the angle.
const std::string lit = R"json({"isoshade": 1, "effect": "lit",
  "nodes": {"c": {"type": "lightcolor"}, "sum": {"type": "sum_lights", "in": "c"}},
  "passes": [{"name": "base", "cull": "none", "color": "sum"}]})json";

/// As a material does, with holes, on vertices that move; and with an outline.
const std::string holes = R"json({"isoshade": 1, "effect": "holes",
  "parameters": {"level": {"type": "float", "value": 0.5}},
  "nodes": {"uv": {"type": "texcoord"}, "p": {"type": "position", "space": "object"}, "n": {"type": "normal"},
    "on": {"type": "normal", "space": "object"},
    "rings": {"type": "expression", "code": "fract(5 * length(uv - vector2(0.5)))", "uv": "uv"},
    "moved": {"type": "expression", "code": "p * 1.25 + vector3(0, 0.3 * uv.x, 0)", "p": "p", "uv": "uv"},
    "hull": {"type": "expression", "code": "p * 1.25 + vector3(0, 0.3 * uv.x, 0) + n * 0.05", "p": "p", "uv": "uv", "n": "on"},
    "l": {"type": "lightdirection"}, "c": {"type": "lightcolor"}, "d": {"type": "dotproduct", "in1": "n", "in2": "l"},
    "facing": {"type": "max", "in1": "d", "in2": 0}, "arriving": {"type": "multiply", "in1": "c", "in2": "facing"},
    "sum": {"type": "sum_lights", "in": "arriving"}},
  "passes": [
    {"name": "base", "cull": "none", "position": "moved", "position_space": "object", "cutout": "rings", "cutoff": "level",
     "color": "sum"},
    {"name": "outline", "cull": "front", "position": "hull", "position_space": "object", "color": [0.1, 0, 0]}]})json";

std::string shadow(const std::string& keys = "") { return "\"shadow\": {" + keys + "}"; }

/// One light of each kind, the spot twice: with one map and with six.
std::string lights(const std::string& keys) {
  return R"("lights": {
    "sun": {"type": "directional", "direction": [0.5, -1, 0.3], "intensity": 0.5, )" + shadow(keys) + R"(},
    "spot": {"type": "spot", "position": [-2, 4, 1], "direction": [0.4, -1, 0], "intensity": 20, "outer_angle": 30, )" +
         shadow(keys) + R"(},
    "wide": {"type": "spot", "position": [0, 3, 3], "direction": [0, -1, -0.3], "intensity": 4, "outer_angle": 80, )" +
         shadow(keys) + R"(},
    "lamp": {"type": "point", "position": [1.5, 1, 0.5], "color": [1, 0.5, 0.2], "intensity": 3, )" + shadow(keys) +
         R"(},
    "fill": {"type": "directional", "direction": [0, -1, -1], "intensity": 0.1}})";
}

const std::string objects = R"(
  "camera": {"position": [1, 3, 6], "target": [0, 0.5, 0], "fov": 40}, "background": [0.1, 0.2, 0.3, 1],
  "objects": {
    "floor": {"mesh": {"type": "plane", "size": [30, 20], "segments": 2}, "effect": "lit.json"},
    "wall": {"mesh": {"type": "plane", "size": [30, 8]}, "effect": "lit.json",
             "transform": {"rotate": [90, 0, 0], "translate": [0, 2, -4]}},
    "ball": {"mesh": {"type": "sphere", "radius": 0.5, "segments": 24, "rings": 12}, "effect": "holes.json",
             "transform": {"translate": [-0.7, 0.6, 0.5]}},
    "mirrored": {"mesh": "box", "effect": "holes.json", "parameters": {"level": 0},
                 "transform": {"translate": [0.9, 0.7, -0.5], "scale": [-1, 1.2, 0.8], "rotate": [0, 30, 0]}},
    "dull": {"mesh": {"type": "torus", "radius": 0.4, "tube": 0.1}, "effect": "lit.json", "casts_shadow": false,
             "receives_shadow": false, "transform": {"translate": [0, 1.5, 0]}}})";

class Shadows : public SceneFolder {
 protected:
  Shadows() {
    folder_.write("lit.json", lit);
    folder_.write("holes.json", holes);
  }

  backends::Image picture(Size size, const std::string& members) { return draw(plan(size, 1, members), *cpu_); }

  std::unique_ptr<backends::Backend> cpu_ = cpu_backend();
};

TEST_F(Shadows, AreIdenticalForEveryLaneCountAndOnTheInterpreter) {
  const auto interpreter = interpreter::create();
  for (const int samples : {1, 4, 16}) {
    const Size size = samples == 16 ? Size{29, 23} : Size{83, 61};
    const render::Plan made = plan(size, samples, lights(R"("size": 64, "softness": 2.5)") + "," + objects);
    EXPECT_EQ(made.frame.views.size(), 1u + 1 + 1 + 6 + 6);
    const backends::Image expected = draw(made, *interpreter);
    for (const char* lanes : {"1", "4", "8", "16", "8x2", "16x2"}) {
      if (!cpu::lane_count(lanes)->available()) continue;  // this machine has no registers of so many lanes
      expect_identical(expected, draw(made, *cpu_backend(lanes, 2)), text(size, samples) + " lanes " + lanes);
    }
  }
}

#ifdef ISOSHADE_VULKAN
TEST_F(Shadows, AreIdenticalOnCpuAndVulkanAtEverySize) {
  const auto vulkan = vulkan_backend();
  const auto exact = vulkan_backend(driver::Division::exact);
  for (const int samples : {1, 4, 16})
    for (const Size size : {Size{320, 240}, Size{641, 383}, Size{1, 1}, Size{3, 200}}) {
      const render::Plan made = plan(size, samples, lights(R"("size": 300, "softness": 3)") + "," + objects);
      const backends::Image expected = draw(made, *cpu_);
      expect_identical(expected, draw(made, *vulkan), text(size, samples));
      if (size.width == 320) expect_identical(expected, draw(made, *exact), text(size, samples) + ", exact division");
    }
}
#endif

TEST_F(Shadows, SkippingChangesNoBit) {
  // The third ball casts its shadow into the picture from outside.
  const std::string members = lights(R"("size": 128)") + R"(,
    "camera": {"position": [0, 2, 2], "target": [0, 0, 0], "fov": 30},
    "objects": {
      "floor": {"mesh": {"type": "plane", "size": [8, 8]}, "effect": "lit.json"},
      "balls": {"mesh": {"type": "sphere", "radius": 0.3}, "effect": "lit.json", "transform": {"translate": [-3, 1, 0]},
                "repeat": [{"count": 3, "step": [1.2, 0, 0]}]},
      "far": {"mesh": "box", "effect": "lit.json", "transform": {"translate": [0, -40, 0]}}})";
  const render::Plan skipped = plan({160, 120}, 1, members), all = plan({160, 120}, 1, members, false);
  EXPECT_LT(skipped.stats.draws, all.stats.draws);
  expect_identical(draw(skipped, *cpu_), draw(all, *cpu_), "skipped and all");
}

/// How a pixel of a picture that looks down on a floor of 8 x 8 is lit, by its place in world space.
class Floor {
 public:
  static constexpr int pixels = 256;
  static constexpr float width = 8;
  static std::string camera() {
    return R"("camera": {"type": "orthographic", "position": [0, 9, 0], "target": [0, 0, 0], "up": [0, 0, -1], "height": 8})";
  }
  /// The light of one at (x, z), as a part of what arrives.
  static float light(const backends::Image& image, float x, float z) {
    const auto at = [](float v) { return std::clamp(static_cast<int>((v / width + 0.5f) * pixels), 0, pixels - 1); };
    return image.rgba[static_cast<size_t>(4 * (at(z) * pixels + at(x)))];
  }
};

TEST_F(Shadows, OfTheSunLieWhereItsRaysMeetTheFloor) {
  // A plate of 2 x 2 at height 2, lit along (1, -1, 0.5): its shadow has moved by (2, 1).
  const backends::Image image = picture({Floor::pixels, Floor::pixels}, Floor::camera() + R"(,
    "lights": {"sun": {"type": "directional", "direction": [1, -1, 0.5], "shadow": {"softness": 0}}},
    "objects": {
      "floor": {"mesh": {"type": "plane", "size": [8, 8]}, "effect": "lit.json"},
      "plate": {"mesh": {"type": "plane", "size": [2, 2]}, "effect": "lit.json", "transform": {"translate": [-1.5, 2, -1]}}})");
  const float middle_x = 0.5f, middle_z = 0, away = 1 + 0.05f, within = 1 - 0.05f;
  for (const float x : {-1.0f, 0.0f, 1.0f})
    for (const float z : {-1.0f, 0.0f, 1.0f}) {
      EXPECT_EQ(Floor::light(image, middle_x + within * x, middle_z + within * z), 0) << x << " " << z;
      if (x == 0 && z == 0) continue;
      EXPECT_EQ(Floor::light(image, middle_x + away * x, middle_z + away * z), 1) << x << " " << z;
    }
}

TEST_F(Shadows, OfLampsAndSpotsSpreadFromThem) {
  // A plate of 1 x 1 at height 1 under a light at height 2 has a shadow of 2 x 2.
  for (const std::string light : {R"("type": "point")", R"("type": "spot", "direction": [0, -1, 0], "outer_angle": 50)",
                                  R"("type": "spot", "direction": [0, -1, 0], "outer_angle": 89)"}) {
    const backends::Image image = picture({Floor::pixels, Floor::pixels}, Floor::camera() + R"(,
      "lights": {"lamp": {)" + light + R"(, "position": [1, 2, 0.5], "shadow": {"softness": 0}}},
      "objects": {
        "floor": {"mesh": {"type": "plane", "size": [8, 8]}, "effect": "lit.json"},
        "plate": {"mesh": {"type": "plane", "size": [1, 1]}, "effect": "lit.json",
                  "transform": {"translate": [1, 1, 0.5]}}})");
    for (const float x : {-1.0f, 0.0f, 1.0f})
      for (const float z : {-1.0f, 0.0f, 1.0f}) {
        if (x == 0 && z == 0) continue;  // the plate itself is seen there
        EXPECT_EQ(Floor::light(image, 1 + 0.95f * x, 0.5f + 0.95f * z), 0) << light << x << " " << z;
        EXPECT_GT(Floor::light(image, 1 + 1.05f * x, 0.5f + 1.05f * z), 0) << light << x << " " << z;
      }
  }
}

TEST_F(Shadows, OfALampFallInAllSixDirections) {
  // A small box on each side of the lamp darkens the middle of each wall of a room, which is seen from inside.
  const std::vector<std::string> towards = {"[1, 0, 0]", "[-1, 0, 0]", "[0, 1, 0]", "[0, -1, 0]", "[0, 0, 1]", "[0, 0, -1]"};
  for (const std::string& direction : towards) {
    const bool is_vertical = direction == towards[2] || direction == towards[3];
    const std::string up = is_vertical ? ", \"up\": [0, 0, 1]" : "";
    const auto middle = [&](const std::string& scale) {
      // The camera looks past the box, whose back it does not see.
      return picture({33, 33}, "\"camera\": {\"position\": [0, 0, 0], \"target\": " + direction + up + R"(, "fov": 60, "near": 1.5},
        "lights": {"lamp": {"type": "point", "position": [0, 0, 0], "shadow": {"size": 128}}},
        "objects": {
          "room": {"mesh": {"type": "box", "size": [8, 8, 8]}, "effect": "lit.json"},
          "box": {"mesh": {"type": "box", "size": [0.2, 0.2, 0.2]}, "effect": "lit.json",
                  "transform": {"scale": )" + scale + ", \"translate\": " + direction + "}}}");
    };
    const backends::Image image = middle("1"), empty = middle("0.001");
    EXPECT_EQ(image.rgba[4 * (16 * 33 + 16)], 0) << direction;
    EXPECT_GT(empty.rgba[4 * (16 * 33 + 16)], 0) << direction;
    EXPECT_EQ(image.rgba[0], empty.rgba[0]) << direction;
  }
}

TEST_F(Shadows, HaveNoStripesOnPlanes) {
  // A light that is not hidden by anything arrives everywhere, at every angle, filter and distance.
  const auto dark = [&](const std::string& light, const std::string& object) {
    const std::string members = R"("camera": {"position": [0, 3, 5], "target": [0, 0, 0]}, "lights": {"light": {)";
    const std::string rest = R"(}}, "objects": {"object": {"effect": "lit.json", )" + object + "}}";
    const backends::Image shaded = picture({200, 150}, members + light + rest);
    std::string without = light;
    without.erase(without.find(", \"shadow\""));
    const backends::Image free = picture({200, 150}, members + without + rest);
    size_t darker = 0, drawn = 0;
    for (size_t i = 0; i < shaded.depth.size(); ++i) {
      drawn += shaded.depth[i] > 0 ? 1 : 0;
      darker += shaded.rgba[4 * i] != free.rgba[4 * i] ? 1 : 0;
    }
    EXPECT_GT(drawn, 2000u);
    return darker;
  };
  const std::string plane = R"("mesh": {"type": "plane", "size": [30, 30], "segments": 3}, "transform": {"rotate": [3, 0, 2]})";
  for (const std::string softness : {"0", "1", "2", "5.5", "16"}) {
    const std::string shadow = ", \"shadow\": {\"size\": 256, \"softness\": " + softness + "}";
    for (const std::string direction : {"[0, -1, 0]", "[1, -1, 0.3]", "[-5, -1, 2]", "[0.3, -0.2, -20]", "[7, -0.5, -9]"})
      EXPECT_EQ(dark(R"("type": "directional", "direction": )" + direction + shadow, plane), 0u)
          << direction << " " << softness;
    for (const std::string position : {"[0, 3, 0]", "[4, 1, -3]", "[-9, 2.5, 0.1]"}) {
      EXPECT_EQ(dark(R"("type": "point", "position": )" + position + shadow, plane), 0u) << position << " " << softness;
      EXPECT_EQ(dark(R"("type": "spot", "outer_angle": 40, "direction": [0.2, -1, 0.1], "position": )" + position + shadow,
                     plane),
                0u)
          << position << " " << softness;
    }
  }
  EXPECT_GT(dark(R"("type": "directional", "direction": [1, -1, 0.3], "shadow": {"size": 256, "bias": 0})", plane), 1000u);
}

TEST_F(Shadows, BeginWhereThingsMeet) {
  // A box that stands on the floor, the sun from the left: right of its wall the floor is dark, from the first pixel on.
  const backends::Image image = picture({Floor::pixels, Floor::pixels}, Floor::camera() + R"(,
    "lights": {"sun": {"type": "directional", "direction": [1, -1, 0], "shadow": {"size": 1024}}},
    "objects": {
      "floor": {"mesh": {"type": "plane", "size": [8, 8]}, "effect": "lit.json"},
      "box": {"mesh": {"type": "box", "size": [1, 1, 1]}, "effect": "lit.json", "transform": {"translate": [0, 0.5, 0]}}})");
  constexpr float pixel = Floor::width / Floor::pixels;
  for (int i = 0; i < 28; ++i) {
    const float x = 0.5f + pixel * (static_cast<float>(i) + 0.5f);
    EXPECT_EQ(Floor::light(image, x, 0.2f), 0) << x;
  }
  EXPECT_EQ(Floor::light(image, 1.6f, 0), 1);
  EXPECT_EQ(Floor::light(image, -0.6f, 0), 1);
}

TEST_F(Shadows, CutOutsCastTheirHoles) {
  folder_.write("ring.json", R"json({"isoshade": 1, "effect": "ring",
    "nodes": {"uv": {"type": "texcoord"}, "far": {"type": "expression", "code": "length(uv - vector2(0.5)) > 0.25", "uv": "uv"}},
    "passes": [{"name": "p", "cull": "none", "cutout": "far", "color": 1}]})json");
  const backends::Image image = picture({Floor::pixels, Floor::pixels}, Floor::camera() + R"(,
    "lights": {"sun": {"type": "directional", "direction": [1, -1, 0], "shadow": {"softness": 0}}},
    "objects": {
      "floor": {"mesh": {"type": "plane", "size": [8, 8]}, "effect": "lit.json"},
      "plate": {"mesh": {"type": "plane", "size": [2, 2]}, "effect": "ring.json", "transform": {"translate": [-2, 2, 0]}}})");
  EXPECT_EQ(Floor::light(image, 0, 0), 1);
  EXPECT_EQ(Floor::light(image, 0.45f, 0), 1);
  EXPECT_EQ(Floor::light(image, 0.55f, 0), 0);
  EXPECT_EQ(Floor::light(image, 0, 0.9f), 0);
  EXPECT_EQ(Floor::light(image, 0, 1.1f), 1);
}

TEST_F(Shadows, AreCastAndReceivedByWhatSaysSo) {
  const auto light = [&](const std::string& of_floor, const std::string& of_plate, const std::string& pass = "") {
    folder_.write("plate.json", R"({"isoshade": 1, "effect": "plate", "passes": [{"name": "p", "color": 1)" + pass + "}]}");
    return Floor::light(picture({Floor::pixels, Floor::pixels}, Floor::camera() + R"(,
      "lights": {"sun": {"type": "directional", "direction": [1, -1, 0], "shadow": {}}},
      "objects": {
        "floor": {"mesh": {"type": "plane", "size": [8, 8]}, "effect": "lit.json")" + of_floor + R"(},
        "plate": {"mesh": {"type": "plane", "size": [2, 2]}, "effect": "plate.json", "transform": {"translate": [-2, 2, 0]})" +
                                                            of_plate + "}}"), 0, 0);
  };
  EXPECT_EQ(light("", ""), 0);
  EXPECT_EQ(light("", R"(, "casts_shadow": false)"), 1);
  EXPECT_EQ(light(R"(, "receives_shadow": false)", ""), 1);
  EXPECT_EQ(light("", "", R"(, "casts_shadow": false)"), 1);
  EXPECT_EQ(light("", R"(, "casts_shadow": true)", R"(, "casts_shadow": false)"), 1);
  EXPECT_EQ(light("", "", R"(, "cull": "front")"), 1) << "as outlines do";
  EXPECT_EQ(light("", "", R"(, "cull": "front", "casts_shadow": true)"), 0);
}

TEST_F(Shadows, AreCastByWhatIsBlendedOnlyWhereItIsOpaqueOrSaysSo) {
  const auto light = [&](const std::string& blended, const std::string& pass) {
    folder_.write("glass.json", R"({"isoshade": 1, "effect": "glass",
      "parameters": {"blended": {"type": "boolean", "value": true}, "n": {"type": "float", "value": 1}},
      "passes": [{"name": "p", "blend": "over", "color": [1, 1, 1, 0.5])" + pass + "}]}");
    return Floor::light(picture({Floor::pixels, Floor::pixels}, Floor::camera() + R"(,
      "lights": {"sun": {"type": "directional", "direction": [1, -1, 0], "shadow": {}}},
      "objects": {
        "floor": {"mesh": {"type": "plane", "size": [8, 8]}, "effect": "lit.json"},
        "plate": {"mesh": {"type": "plane", "size": [2, 2]}, "effect": "glass.json", "transform": {"translate": [-2, 2, 0]},
                  "parameters": {"blended": )" + blended + "}}}"), 0, 0);
  };
  const std::string key = R"(, "blended": "blended")", casts = R"(, "casts_shadow": true)";
  EXPECT_EQ(light("true", ""), 1);
  EXPECT_EQ(light("true", casts), 0);
  EXPECT_EQ(light("true", key), 1);
  EXPECT_EQ(light("true", key + casts), 0);
  EXPECT_EQ(light("false", key), 0);
  EXPECT_EQ(light("false", key + casts), 0);
  EXPECT_EQ(light("false", key + R"(, "casts_shadow": false)"), 1);
  EXPECT_EQ(light("false", key + R"(, "cull": "front")"), 1);
}

TEST_F(Shadows, AreCastFromWhereVerticesAreMovedTo) {
  folder_.write("moved.json", R"({"isoshade": 1, "effect": "moved", "parameters": {"by": {"type": "vector3", "value": [0, 0, 0]}},
    "nodes": {"p": {"type": "position"}, "to": {"type": "add", "in1": "p", "in2": "by"}},
    "passes": [{"name": "p", "position": "to", "color": 1}]})");
  const auto light = [&](const std::string& at, const std::string& by, const std::string& of_floor = "") {
    return Floor::light(picture({Floor::pixels, Floor::pixels}, Floor::camera() + R"(,
      "lights": {"sun": {"type": "directional", "direction": [1, -1, 0], "shadow": {}}},
      "objects": {
        "floor": {"mesh": {"type": "plane", "size": [8, 8]}, "effect": "lit.json")" + of_floor + R"(},
        "plate": {"mesh": {"type": "plane", "size": [2, 2]}, "effect": "moved.json", "transform": {"translate": )" + at +
                                                            R"(}, "parameters": {"by": )" + by + "}}}"), 0, 0);
  };
  EXPECT_EQ(light("[-2, 2, 0]", "[0, 0, 0]"), 0);
  EXPECT_EQ(light("[-2, 2, 0]", "[-10, 10, 0]"), 0) << "towards the light";
  EXPECT_EQ(light("[-2, -40, 0]", "[0, 42, 0]"), 0) << "from behind what is seen";
  EXPECT_EQ(light("[60, 2, 0]", "[-62, 0, 0]"), 0) << "from beside what is seen";
  EXPECT_EQ(light("[60, 2, 0]", "[-62, 0, 0]", R"(, "casts_shadow": false)"), 0) << "as the only caster";
  EXPECT_EQ(light("[60, 2, 0]", "[0, 0, 0]"), 1);
  EXPECT_EQ(light("[-2, 2, 0]", "[0, 0, 30]"), 1);
}

}  // namespace
}  // namespace isoshade::equivalence
