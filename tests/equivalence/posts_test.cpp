// SPDX-License-Identifier: Apache-2.0
// Post documents over images that a test makes: what they read, and that every backend reads the same.
#include <algorithm>

#include "backends/cpu/lane_count.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/scene/placement.h"
#include "tests/equivalence/screen.h"

namespace isoshade::equivalence {
namespace {

/// Every float is another.
Pixels numbered(int width, int height, size_t channels = 4) {
  Pixels pixels{width, height, {}};
  for (size_t i = 0; i < channels * static_cast<size_t>(width * height); ++i)
    pixels.floats.push_back(static_cast<float>(i + 1) * 0.37f);
  return pixels;
}

support::Source post_text(const std::string& nodes, const std::string& more = "") {
  return std::make_shared<support::SourceFile>("post.json", R"({"isoshade": 1, "post": "p", )" + more +
                                                                R"("nodes": {)" + nodes +
                                                                R"(}, "outputs": {"color": "color"}})");
}

/// The pixel that a coordinate means, or -1.
int by_rule(int at, int size, const std::string& edge) {
  if (edge == "constant" && (at < 0 || at >= size)) return -1;
  if (edge == "mirror") at = at < 0 ? -1 - at : at >= size ? 2 * size - 1 - at : at;
  return std::clamp(at, 0, size - 1);
}

TEST(Posts, SceneColorAppliesItsEdgeModeOutsideTheImage) {
  const Pixels image = numbered(5, 4);
  for (const std::string edge : {"clamp", "mirror", "constant"}) {
    for (const int dx : {-11, -5, -2, 0, 1, 4, 9, 100}) {
      for (const int dy : {-9, -1, 0, 3, 8}) {
        Screen screen(post_text(R"("color": {"type": "scenecolor", "edge": ")" + edge + R"(", "offsetx": )" +
                                std::to_string(dx) + R"(, "offsety": )" + std::to_string(dy) + "}"),
                      5, 4, {}, {image});
        const std::vector<float> found = screen.interpreted();
        for (int y = 0; y < 4; ++y) {
          for (int x = 0; x < 5; ++x) {
            const int from_x = by_rule(x + dx, 5, edge), from_y = by_rule(y + dy, 4, edge);
            for (int c = 0; c < 4; ++c) {
              const float expected = from_x < 0 || from_y < 0 ? 0.0f : image.at(from_x, from_y)[c];
              ASSERT_EQ(found[static_cast<size_t>(4 * (5 * y + x) + c)], expected)
                  << edge << " " << dx << " " << dy << " at " << x << " " << y;
            }
          }
        }
      }
    }
  }
}

TEST(Posts, SceneColorReadsTheCoincidentPixelOfImagesOfOtherSizes) {
  // Of every pair of sizes here, exactly in integers.
  for (const int made : {1, 2, 3, 5, 8, 13, 640}) {
    for (const int read : {1, 2, 3, 4, 7, 320, 641}) {
      Screen screen(post_text(R"("color": {"type": "scenecolor"})"), made, 1, {}, {numbered(read, 1)});
      const std::vector<float> found = screen.interpreted();
      for (int x = 0; x < made; ++x) {
        const int under = (2 * x + 1) * read / (2 * made);
        ASSERT_EQ(found[static_cast<size_t>(4 * x)], static_cast<float>(4 * under + 1) * 0.37f)
            << made << " from " << read << " at " << x;
      }
    }
  }
}

/// The first of the two pixels between whose centres the centre of pixel `at` lies, where `made` of them lie over `read`,
/// and how far it is on the way to the second: a fraction of integers, rounded once, less a half.
std::pair<int, float> between(int at, int made, int read) {
  const int centre = (2 * at + 1) * read, under = centre / (2 * made);
  const float inside = static_cast<float>(centre % (2 * made)) / static_cast<float>(2 * made) - 0.5f;
  return inside < 0 ? std::pair{under - 1, inside + 1.0f} : std::pair{under, inside};
}

TEST(Posts, LinearFilterInterpolatesBetweenPixels) {
  const Pixels image = numbered(3, 2);
  constexpr int width = 7, height = 5;
  Screen screen(post_text(R"("color": {"type": "scenecolor", "filter": "linear"})"), width, height, {},
                {image});
  const std::vector<float> found = screen.interpreted();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto [left, fx] = between(x, width, 3);
      const auto [up, fy] = between(y, height, 2);
      const auto pixel = [&](int i, int j) { return image.at(std::clamp(i, 0, 2), std::clamp(j, 0, 1))[0]; };
      const float upper = pixel(left, up) * (1.0f - fx) + pixel(left + 1, up) * fx;
      const float lower = pixel(left, up + 1) * (1.0f - fx) + pixel(left + 1, up + 1) * fx;
      ASSERT_EQ(found[static_cast<size_t>(4 * (width * y + x))], upper * (1.0f - fy) + lower * fy) << x << " " << y;
    }
  }
}

TEST(Posts, LinearFilterAtEqualSizeIsTheIdentity) {
  const Pixels image = numbered(33, 17);
  Screen screen(post_text(R"("color": {"type": "scenecolor", "filter": "linear"})"), 33, 17, {}, {image});
  EXPECT_EQ(screen.interpreted(), image.floats);
}

TEST(Posts, LinearFilterAtHalfSizeAveragesFourPixels) {
  const Pixels image = numbered(8, 6);
  Screen screen(post_text(R"("color": {"type": "scenecolor", "filter": "linear"})"), 4, 3, {}, {image});
  const std::vector<float> found = screen.interpreted();
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x)
      ASSERT_FLOAT_EQ(found[static_cast<size_t>(4 * (4 * y + x))],
                      (image.at(2 * x, 2 * y)[0] + image.at(2 * x + 1, 2 * y)[0] +
                       image.at(2 * x, 2 * y + 1)[0] + image.at(2 * x + 1, 2 * y + 1)[0]) /
                          4);
}

TEST(Posts, SumTapsAddsInOrderFromZero) {
  const Pixels image = numbered(9, 1);
  Screen screen(post_text(R"json("i": {"type": "tapindex"}, "c": {"type": "scenecolor", "offsetx": "i"},
    "w": {"type": "expression", "code": "c.rgb * (1 + 0.1 * i)", "c": "c", "i": "i"},
    "color": {"type": "sum_taps", "in": "w", "first": -2, "last": 3})json"),
                9, 1, {}, {image});
  ASSERT_EQ(screen.post.parameters.taps.size(), 1u);
  EXPECT_EQ(screen.post.parameters.taps[0].value[0], 6.0f);
  const std::vector<float> found = screen.interpreted();
  for (int x = 0; x < 9; ++x) {
    float sum = 0;
    for (int i = -2; i <= 3; ++i)
      sum += image.at(std::clamp(x + i, 0, 8), 0)[0] * (1.0f + 0.1f * static_cast<float>(i));
    ASSERT_EQ(found[static_cast<size_t>(4 * x)], sum) << x;
  }
}

TEST(Posts, PixelAndScreenNodesReturnTheirCoordinates) {
  Screen screen(
      post_text(
          R"json("p": {"type": "pixelcoord"}, "uv": {"type": "screencoord"}, "s": {"type": "screensize"},
    "color": {"type": "expression", "code": "color4(p.x, p.y, uv.x + uv.y, s.x * 100 + s.y)", "p": "p", "uv": "uv",
              "s": "s"})json"),
      4, 8, {}, {numbered(1, 1)});
  const std::vector<float> found = screen.interpreted();
  const float* pixel = &found[4 * (4 * 5 + 3)];
  EXPECT_EQ(pixel[0], 3.5f);
  EXPECT_EQ(pixel[1], 5.5f);
  EXPECT_EQ(pixel[2], 0.875f + 0.6875f);
  EXPECT_EQ(pixel[3], 408.0f);
}

/// Everything that a post can read, at once.
constexpr const char* everything = R"json("i": {"type": "tapindex"},
  "c": {"type": "scenecolor", "offsetx": "i", "edge": "mirror", "filter": "linear"},
  "n": {"type": "scenecolor", "image": "other", "offsety": "i", "edge": "constant"},
  "d": {"type": "scenedepth", "offsetx": "i", "offsety": 1}, "p": {"type": "worldposition"}, "v": {"type": "viewray"},
  "uv": {"type": "screencoord"}, "dir": {"type": "cameradirection"},
  "one": {"type": "expression", "code": "color4(0.01 * p.x, v.y, uv.x, min(d, 50)) + c * exp(-0.1 * i * i) + n * dir.z",
          "p": "p", "v": "v", "uv": "uv", "d": "d.linear", "c": "c", "i": "i", "n": "n", "dir": "dir"},
  "color": {"type": "sum_taps", "in": "one", "first": -3, "last": 4})json";

TEST(Posts, AreIdenticalOnEveryBackendAtEverySize) {
  scene::Camera camera;
  camera.position = {3, 4, 7};
  camera.target = {1, 2, 0};
  const auto interpreter = interpreter::create();
  std::vector<std::pair<std::string, std::unique_ptr<backends::Backend>>> others;
  for (const char* lanes : {"1", "4", "8", "16", "16x2"})
    if (cpu::lane_count(lanes)->available()) others.emplace_back(lanes, cpu_backend(lanes));
#ifdef ISOSHADE_VULKAN
  others.emplace_back("vulkan", vulkan_backend(driver::Division::native));
  others.emplace_back("vulkan, exact division", vulkan_backend(driver::Division::exact));
#endif
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2000}, {37, 19}, {130, 7}}) {
    Pixels depth = numbered(width, height, 1);
    for (float& z : depth.floats) z = 1 / (1 + z);
    Screen screen(post_text(everything, R"("images": ["other"], )"), width, height, depth,
                  {numbered(width, height), numbered((width + 1) / 2, (height + 2) / 3)});
    const lanes::FpGuard guard;
    scene::store_camera(camera, width, height, screen.view);
    const std::vector<float> expected = screen.run(*interpreter);
    for (const auto& [name, backend] : others)
      EXPECT_TRUE(screen.run(*backend) == expected) << name << " " << width << "x" << height;
  }
}

TEST(Posts, SkippingPostsWithoutEffectChangesNoBit) {
  const auto backend = cpu_backend();
  for (const auto& [name, switches] : {std::pair{"fog_balls", std::vector<std::string>{"fog_density"}},
                                       {"bloom_balls", {"bloom_strength"}}}) {
    scene::Scene scene = load(scene_path(name));
    for (scene::Post& post : scene.posts)
      for (scene::Parameter& parameter : post.parameters)
        if (std::ranges::find(switches, parameter.name) != switches.end()) parameter.value.number = 0;
    const render::Plan skipped = plan(scene, 160, 90, true), run = plan(scene, 160, 90, false);
    EXPECT_LT(skipped.posts.steps.size(), run.posts.steps.size());
    expect_identical(draw(skipped, *backend), draw(run, *backend), name);
  }
}

TEST(Posts, ShippedScenesAreIdenticalInANarrowImage) {
  const auto first = cpu_backend("1", 1);
  for (const char* name : {"fog_balls", "bloom_balls"}) {
    const render::Plan made = plan(scene_path(name), 3, 2000);
    const backends::Image expected = draw(made, *first);
    expect_identical(expected, draw(made, *cpu_backend()), name);
#ifdef ISOSHADE_VULKAN
    expect_identical(expected, draw(made, *vulkan_backend()), name);
#endif
  }
}

}  // namespace
}  // namespace isoshade::equivalence
