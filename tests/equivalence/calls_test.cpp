// SPDX-License-Identifier: Apache-2.0
// Functions that read the surface, lights, time and images: the same bits as the same nodes in the effect, on every
// backend.
#include <random>

#include "backends/cpu/lane_count.h"
#include "runtime/scene/image_file.h"
#include "tests/equivalence/scenes.h"
#include "tests/unit/temporary_folder.h"

namespace isoshade::equivalence {
namespace {

std::string noisy_png(int width, int height, uint32_t seed) {
  std::vector<uint8_t> bytes(static_cast<size_t>(4 * width * height));
  std::mt19937 random(seed);
  for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
  return scene::png(width, height, bytes);
}

class CalledFunctions : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("isoshade.root", "");
    folder_.write("a.png", noisy_png(37, 23, 1));
    folder_.write("parts/b.png", noisy_png(16, 16, 2));
  }

  /// What an object with this effect shows under lights of three kinds.
  render::Plan plan_of(const std::string& effect, int width = 93, int height = 61) const {
    folder_.write("shown.json", effect);
    return plan(folder_.write("scene.json", R"({"isoshade": 1, "scene": "s", "time": 1.25,
      "camera": {"position": [0.5, 1, 3], "target": [0, 0, 0]},
      "lights": {"sun": {"type": "directional", "direction": [-0.4, -1, -0.3], "color": [1, 0.9, 0.8], "intensity": 2},
                 "lamp": {"type": "point", "position": [1, 1.5, 1], "color": [0.4, 0.6, 1], "intensity": 3},
                 "spot": {"type": "spot", "position": [-1, 2, 2], "direction": [0.3, -1, -1], "color": [1, 0.3, 0.2],
                          "intensity": 9, "outer_angle": 40}},
      "objects": {"ball": {"mesh": {"type": "sphere", "radius": 1}, "effect": "shown.json",
                           "transform": {"rotate": [20, 30, 0], "scale": [1, 0.8, 1.2]}}}})"),
                width, height);
  }

  static backends::Image draw_everywhere(const render::Plan& plan, const std::string& what) {
    const backends::Image image = draw(plan, *interpreter::create());
    for (const char* lanes : {"1", "4", "8", "16", "8x2", "16x2"})
      if (cpu::lane_count(lanes)->available())
        expect_identical(image, draw(plan, *cpu_backend(lanes)), what + " lanes " + lanes);
#ifdef ISOSHADE_VULKAN
    expect_identical(image, draw(plan, *vulkan_backend()), what + " vulkan");
    expect_identical(image, draw(plan, *vulkan_backend(driver::Division::exact)), what + " vulkan, exact division");
#endif
    return image;
  }

  testing::TemporaryFolder folder_;
};

/// A texture that wanders with time, read in two ways; its slope on the screen; and a colour under all lights. `map` and
/// `tiles` are what the nodes link to; ids end with `end`.
std::string texel_nodes(const std::string& map, const std::string& tiles, const std::string& end) {
  const auto id = [&](const std::string& name) { return "\"" + name + end + "\""; };
  return id("uv") + R"(: {"type": "texcoord"}, )" + id("scaled") + R"(: {"type": "multiply", "in1": )" + id("uv") +
         R"(, "in2": )" + tiles + "}, " + id("color_at") + R"(: {"type": "image", "file": )" + map +
         R"(, "texcoord": )" + id("scaled") + R"(, "filtertype": "trilinear"}, )" + id("bump_at") +
         R"(: {"type": "image", "file": )" + map + R"(, "texcoord": )" + id("scaled") +
         R"(, "to": "vector3"}, )" + id("bump") + R"(: {"type": "fwidth", "in": )" + id("bump_at") + "}";
}

std::string lit_nodes(const std::string& color, const std::string& bump, const std::string& end) {
  const auto id = [&](const std::string& name) { return "\"" + name + end + "\""; };
  return id("n") + R"(: {"type": "normal"}, )" + id("bent") + R"(: {"type": "add", "in1": )" + id("n") +
         R"(, "in2": )" + bump + "}, " + id("l") + R"(: {"type": "lightdirection"}, )" + id("c") +
         R"(: {"type": "lightcolor"}, )" + id("facing") + R"(: {"type": "dotproduct", "in1": )" + id("bent") +
         R"(, "in2": )" + id("l") + "}, " + id("lit") + R"(: {"type": "saturate", "in": )" + id("facing") + "}, " +
         id("arriving") + R"(: {"type": "multiply", "in1": )" + id("c") + R"(, "in2": )" + id("lit") + "}, " +
         id("light") + R"(: {"type": "sum_lights", "in": )" + id("arriving") + "}, " + id("seen") +
         R"(: {"type": "multiply", "in1": )" + id("light") + R"(, "in2": )" + color + "}";
}

std::string glow_nodes(const std::string& seen, const std::string& share, const std::string& end) {
  const auto id = [&](const std::string& name) { return "\"" + name + end + "\""; };
  return id("t") + R"(: {"type": "time"}, )" + id("along") +
         R"(: {"type": "position", "space": "object"}, )" + id("up") +
         R"(: {"type": "transformnormal", "in": [0, 1, 0], "fromspace": "object", "tospace": "view"}, )" + id("wave") +
         R"json(: {"type": "expression", "code": "sin(t * 3 + p.y * 5) * u.z + s.x", "t": )json" + id("t") +
         R"(, "p": )" + id("along") + R"(, "u": )" + id("up") + R"(, "s": )" + id("slope") + "}, " + id("slope") +
         R"(: {"type": "fwidth", "in": )" + id("along") + "}, " + id("glow") +
         R"(: {"type": "mix", "bg": )" + seen + R"(, "fg": )" + id("wave") + R"(, "mix": )" + share + "}";
}

const std::string parameters = R"("parameters": {"map": {"type": "filename", "value": "a.png"},
  "share": {"type": "float", "value": 0.25, "min": 0, "max": 1}})";
const std::string passes = R"("passes": [{"name": "base", "color": "sum"}])";
const std::string sum_of = R"("sum": {"type": "add", "in1": "glow_1", "in2": "glow_2"})";

std::string flat_effect() {
  return R"({"isoshade": 1, "effect": "flat", )" + parameters + ",\n\"nodes\": {" +
         texel_nodes(R"({"link": "map"})", "3", "_1") + ", " + lit_nodes("\"color_at_1\"", "\"bump_1\"", "_1") + ", " +
         glow_nodes("\"seen_1\"", "\"share\"", "_1") + ",\n" + texel_nodes("\"parts/b.png\"", "1.5", "_2") + ", " +
         lit_nodes("\"color_at_2\"", "\"bump_2\"", "_2") + ", " + glow_nodes("\"seen_2\"", "0.5", "_2") + ", " +
         sum_of + "}, " + passes + "}";
}

TEST_F(CalledFunctions, NestedThreeDeepWithLightsAndImagesEqualTheFlatEffect) {
  folder_.write("parts/texel.json", R"({"isoshade": 1, "function": "texel",
    "inputs": {"map": {"type": "filename"}, "tiles": {"type": "float"}},
    "nodes": {)" + texel_nodes(R"({"link": "map"})", "\"tiles\"", "") +
                                        R"(}, "outputs": {"color": "color_at", "bump": "bump"}})");
  folder_.write("parts/lit.json", R"({"isoshade": 1, "function": "lit",
    "inputs": {"map": {"type": "filename", "value": "b.png"}, "tiles": {"type": "float", "value": 1.5}},
    "nodes": {"texel": {"type": "texel.json", "map": {"link": "map"}, "tiles": "tiles"}, )" +
                                      lit_nodes("\"texel.color\"", "\"texel.bump\"", "") +
                                      R"(}, "outputs": {"out": "seen"}})");
  folder_.write("parts/glow.json", R"({"isoshade": 1, "function": "glow",
    "inputs": {"picture": {"type": "filename"}, "tiles": {"type": "float"}, "share": {"type": "float"}},
    "nodes": {"shown": {"type": "lit.json", "map": {"link": "picture"}, "tiles": "tiles"}, )" +
                                       glow_nodes("\"shown\"", "\"share\"", "") +
                                       R"(}, "outputs": {"out": "glow"}})");
  const std::string calls = R"({"isoshade": 1, "effect": "calls", )" + parameters + R"(, "nodes": {
    "glow_1": {"type": "parts/glow.json", "picture": {"link": "map"}, "tiles": 3, "share": "share"},
    "shown_2": {"type": "parts/lit.json"}, )" +
                            glow_nodes("\"shown_2\"", "0.5", "_2") + ", " + sum_of + "}, " + passes + "}";
  const backends::Image flat = draw_everywhere(plan_of(flat_effect()), "flat");
  const backends::Image called = draw_everywhere(plan_of(calls), "calls");
  expect_identical(flat, called, "flat and calls");
  float least = 1e9f, most = -1e9f;
  for (size_t i = 0; i < flat.rgba.size(); i += 4) {
    least = std::min(least, flat.rgba[i]);
    most = std::max(most, flat.rgba[i]);
  }
  EXPECT_GT(most, least + 0.5f) << "something is lit";
}

TEST_F(CalledFunctions, MovedVerticesEqualThoseOfTheFlatEffect) {
  const auto effect = [](const std::string& nodes) {
    return R"({"isoshade": 1, "effect": "moved", "nodes": {)" + nodes +
           R"(}, "passes": [{"name": "base", "position": "at", "color": [1, 0.5, 0.25]}]})";
  };
  const std::string swollen = R"json("p": {"type": "position"}, "n": {"type": "cornernormal1"},
    "i": {"type": "image", "file": "b.png", "filtertype": "closest", "to": "float"},
    "at": {"type": "expression", "code": "p + n * vector3(i * 0.3)", "p": "p", "n": "n", "i": "i"})json";
  folder_.write("parts/swollen.json",
                R"({"isoshade": 1, "function": "swollen", "nodes": {)" + swollen + R"(}, "outputs": {"out": "at"}})");
  std::string flat = swollen;
  flat.replace(flat.find("b.png"), 5, "parts/b.png");
  expect_identical(draw_everywhere(plan_of(effect(flat)), "flat"),
                   draw_everywhere(plan_of(effect(R"("at": {"type": "parts/swollen.json"})")), "calls"),
                   "flat and calls");
}

TEST_F(CalledFunctions, AnEffectThatExtendsAnotherEqualsTheWholeEffect) {
  folder_.write("parts/base.json", R"({"isoshade": 1, "effect": "base",
    "parameters": {"map": {"type": "filename", "value": "b.png"}, "gain": {"type": "float", "value": 1, "max": 2}},
    "nodes": {"i": {"type": "image", "file": {"link": "map"}}, "own": {"type": "image", "file": "b.png"},
      "f": {"type": "twice.json", "x": "i"}, "g": {"type": "multiply", "in1": "f", "in2": "gain"},
      "c": {"type": "add", "in1": "g", "in2": "own"}},
    "passes": [{"name": "base", "color": "c"}]})");
  folder_.write("parts/twice.json", R"({"isoshade": 1, "function": "twice", "inputs": {"x": {"type": "color3"}},
    "nodes": {"n": {"type": "add", "in1": "x", "in2": "x"}}, "outputs": {"out": "n"}})");
  const std::string changed = R"({"isoshade": 1, "effect": "changed", "extends": "parts/base.json",
    "parameters": {"map": {"value": "a.png"}, "gain": {"value": 3, "max": 4}},
    "nodes": {"c": {"in2": "n"}, "n": {"type": "image", "file": "parts/b.png", "texcoord": [0.25, 0.75]}}})";
  const std::string whole = R"({"isoshade": 1, "effect": "whole",
    "parameters": {"map": {"type": "filename", "value": "a.png"}, "gain": {"type": "float", "value": 3, "max": 4}},
    "nodes": {"i": {"type": "image", "file": {"link": "map"}},
      "n": {"type": "image", "file": "parts/b.png", "texcoord": [0.25, 0.75]},
      "f": {"type": "parts/twice.json", "x": "i"}, "g": {"type": "multiply", "in1": "f", "in2": "gain"},
      "c": {"type": "add", "in1": "g", "in2": "n"}},
    "passes": [{"name": "base", "color": "c"}]})";
  expect_identical(draw(plan_of(whole), *cpu_backend()), draw(plan_of(changed), *cpu_backend()), "whole and changed");
}

}  // namespace
}  // namespace isoshade::equivalence
