// SPDX-License-Identifier: Apache-2.0
// Environments: the same bits on every backend, in effects, in functions that they call, and in posts.
#include "backends/cpu/lane_count.h"
#include "runtime/scene/image_file.h"
#include "tests/equivalence/scenes.h"
#include "tests/unit/gltf_files.h"

namespace isoshade::equivalence {
namespace {

class EnvironmentScenes : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<float> texels, depth(32 * 16);
    for (int i = 0; i < 32 * 16; ++i)
      for (const float value : {static_cast<float>(i % 7), static_cast<float>(i % 32) * 0.1f, i == 77 ? 900.0f : 0.5f, 1.0f})
        texels.push_back(value);
    folder_.write("light.exr", scene::exr({32, 16, texels, depth}));
    folder_.write("reflected.json", R"({"isoshade": 1, "function": "reflected",
      "inputs": {"n": {"type": "vector3"}, "r": {"type": "float"}},
      "nodes": {"v": {"type": "viewdirection"}, "away": {"type": "multiply", "in1": "v", "in2": -1},
        "d": {"type": "reflect", "in": "away", "normal": "n"},
        "e": {"type": "environment", "direction": "d", "roughness": "r", "default": [1, 0, 1]}},
      "outputs": {"out": "e", "exists": "e.exists"}})");
    folder_.write("shown.json", R"({"isoshade": 1, "effect": "shown", "nodes": {
      "n": {"type": "normal"}, "uv": {"type": "texcoord"},
      "mirror": {"type": "reflected.json", "n": "n", "r": "uv.y"},
      "i": {"type": "irradiance", "default": [0, 1, 0]},
      "sum": {"type": "add", "in1": "mirror", "in2": "i"},
      "color": {"type": "ifequal", "value1": "mirror.exists", "value2": true, "in1": "sum", "in2": "i"}},
      "passes": [{"name": "base", "color": "color"}]})");
    folder_.write("behind.json", R"({"isoshade": 1, "post": "behind", "nodes": {
      "c": {"type": "scenecolor"}, "ray": {"type": "viewray"},
      "e": {"type": "environment", "direction": "ray", "roughness": 0.1},
      "open": {"type": "subtract", "in1": 1, "in2": "c.a"},
      "b": {"type": "multiply", "in1": "e", "in2": "open"},
      "color": {"type": "add", "in1": "b", "in2": "c.rgb"}}, "outputs": {"color": "color"}})");
  }

  render::Plan plan_of(const std::string& environment, int samples) const {
    return plan(folder_.write("scene.json", R"({"isoshade": 1, "scene": "s", "samples": )" + std::to_string(samples) +
                                  R"(, "background": [0, 0, 0, 0],
      "camera": {"position": [0, 1, 4], "target": [0, 0, 0]},)" + environment + R"(
      "objects": {"ball": {"mesh": "sphere", "effect": "shown.json"}},
      "posts": [{"name": "behind", "effect": "behind.json"}]})"), 45, 31);
  }

  static backends::Image draw_everywhere(const render::Plan& plan, const std::string& what) {
    const backends::Image image = draw(plan, *interpreter::create());
    for (const char* lanes : {"1", "4", "8", "16", "8x2", "16x2"})
      if (cpu::lane_count(lanes)->available())
        expect_identical(image, draw(plan, *cpu_backend(lanes)), what + " lanes " + lanes);
#ifdef ISOSHADE_VULKAN
    const auto vulkan = vulkan_backend();
    expect_identical(image, draw(plan, *vulkan), what + " vulkan");
    expect_identical(image, draw(plan, *vulkan), what + " vulkan again");
#endif
    return image;
  }

  testing::Folder folder_;
};

constexpr const char* from_file = R"("environment": {"file": "light.exr", "rotate": 20, "intensity": 1.5},)";

TEST_F(EnvironmentScenes, AreIdenticalOnEveryBackendAndSampleCount) {
  for (const int samples : {1, 4, 16}) {
    const backends::Image image = draw_everywhere(plan_of(from_file, samples), std::to_string(samples));
    // The corner shows the environment, and so does the ball.
    EXPECT_GT(image.rgba[0] + image.rgba[1] + image.rgba[2], 0.1f);
    EXPECT_GT(image.rgba[4 * (15 * 45 + 22)], 0);
  }
}

TEST_F(EnvironmentScenes, WithoutOneNodesGiveTheirDefaults) {
  const backends::Image image = draw_everywhere(plan_of("", 1), "without");
  const float* const ball = &image.rgba[4 * (15 * 45 + 22)];
  EXPECT_EQ((std::vector<float>{ball[0], ball[1], ball[2]}), (std::vector<float>{0, 1, 0}));
  EXPECT_EQ(image.rgba[0] + image.rgba[1] + image.rgba[2], 0);
}

TEST_F(EnvironmentScenes, BlurredMapsAreMadeOnlyWhereSomethingReadsThem) {
  folder_.write("plain.json", R"({"isoshade": 1, "effect": "plain",
    "parameters": {"tint": {"type": "color3", "value": [0.2, 0.4, 0.6]}}, "nodes": {},
    "passes": [{"name": "base", "color": "tint"}]})");
  folder_.write("polished.json", R"({"isoshade": 1, "effect": "polished", "parameters": {
      "roughness": {"type": "float", "value": 0, "min": 0, "max": 1}},
    "nodes": {"n": {"type": "normal"}, "color": {"type": "environment", "direction": "n", "roughness": "roughness"}},
    "passes": [{"name": "base", "color": "color"}]})");
  folder_.write("backdrop.json", R"({"isoshade": 1, "post": "backdrop", "parameters": {
      "roughness": {"type": "float", "value": 0, "min": 0, "max": 1}},
    "nodes": {"c": {"type": "scenecolor"}, "ray": {"type": "viewray"},
      "e": {"type": "environment", "direction": "ray", "roughness": "roughness"},
      "color": {"type": "add", "in1": "e", "in2": "c.rgb"}}, "outputs": {"color": "color"}})");
  struct Case {
    const char *effect, *object, *post;
    bool reads_blurred;
  };
  const char* const varied = R"("repeat": [{"count": 2, "step": [1, 0, 0], "parameters": {"roughness": {"values": [0, 0.3]}}}])";
  for (const Case& c : {Case{"plain", "", "", false}, Case{"plain", "", R"(, "parameters": {"roughness": 0.25})", true},
                        Case{"polished", "", "", false}, Case{"polished", varied, "", true},
                        Case{"polished", R"("parameters": {"roughness": 0.25})", "", true}, Case{"shown", "", "", true}}) {
    const std::string object = *c.object != 0 ? std::string(", ") + c.object : "";
    const std::string file = folder_.write("scene.json", R"({"isoshade": 1, "scene": "s",
      "camera": {"position": [0, 1, 4], "target": [0, 0, 0]},)" + std::string(from_file) + R"(
      "objects": {"ball": {"mesh": "sphere", "effect": ")" + c.effect + R"(.json")" + object + R"(}},
      "posts": [{"name": "backdrop", "effect": "backdrop.json")" + c.post + "}]}");
    const render::Plan skipped = plan(file, 45, 31), whole = plan(file, 45, 31, false);
    EXPECT_EQ(skipped.frame.texels.size() == whole.frame.texels.size(), c.reads_blurred) << c.effect << object << c.post;
    expect_identical(draw(whole, *cpu_backend()), draw(skipped, *cpu_backend()), c.effect + object + c.post);
  }
}

TEST_F(EnvironmentScenes, ASkyIsIdenticalOnEveryBackend) {
  draw_everywhere(plan_of(R"("environment": {"sky": {"sun": {"direction": [0, -1, -1], "intensity": 3}}},)", 1), "sky");
}

}  // namespace
}  // namespace isoshade::equivalence
