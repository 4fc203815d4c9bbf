// SPDX-License-Identifier: Apache-2.0
// Pixels that are infinite or NaN: they are counted, whoever made them is named, and bloom does not spread them.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <unistd.h>

#include "backends/interpreter/backend.h"
#include "runtime/render/finite.h"
#include "runtime/render/plan.h"
#include "runtime/render/render.h"
#include "tests/unit/scene_documents.h"

namespace isoshade {
namespace {

namespace fs = std::filesystem;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

TEST(NonFinite, CountsPixelsNotChannelsAndFindsTheFirst) {
  std::vector<float> rgba(4 * 5 * 3, 0.5f);
  EXPECT_EQ(render::find_non_finite(rgba, 5).count, 0);
  rgba[4 * 7 + 1] = nan;
  rgba[4 * 7 + 2] = -infinity;
  rgba[4 * 14 + 3] = infinity;
  rgba[4 * 13] = 3.4e38f;
  const render::NonFinite found = render::find_non_finite(rgba, 5);
  EXPECT_EQ(found.count, 2);
  EXPECT_EQ(found.x, 2);
  EXPECT_EQ(found.y, 1);
}

/// A square that fills the image, and is `bad` in one of its 64 cells.
class FiniteTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("isoshade_finite" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    write("cell.json", R"({"isoshade": 1, "effect": "cell",
      "parameters": {"bad": {"type": "integer", "value": 0, "max": 3}},
      "nodes": {"p": {"type": "position"},
        "one": {"type": "expression", "code": "p.x > 0 && p.x < 0.25 && p.y > 0 && p.y < 0.25", "p": "p"},
        "zero": {"type": "subtract", "in1": "p.x", "in2": "p.x"},
        "nan": {"type": "divide", "in1": "zero", "in2": "zero"},
        "infinite": {"type": "divide", "in1": 1, "in2": "zero"},
        "value": {"type": "expression", "code": "bad == 0 ? 0 : bad == 1 ? nan : bad == 2 ? infinite : 100000",
                  "bad": "bad", "nan": "nan", "infinite": "infinite"},
        "seen": {"type": "expression", "code": "one ? value : 0.25", "one": "one", "value": "value"},
        "color": {"type": "convert", "in": "seen", "to": "color3"}},
      "passes": [{"name": "base", "color": "color", "cull": "none"}]})");
    write("invert.json", R"({"isoshade": 1, "post": "invert",
      "nodes": {"c": {"type": "scenecolor"}, "color": {"type": "divide", "in1": [1, 1, 1, 1], "in2": "c"}},
      "outputs": {"color": "color"}})");
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  /// Renders 32 x 32 pixels; what is told stands in diagnostics_.
  backends::Image render(int bad, const std::string& more = "", float height = 2) {
    diagnostics_ = support::Diagnostics();
    const auto document = testing::document_of(
        testing::scene_text(
            R"("size": [32, 32],
      "camera": {"type": "orthographic", "position": [0, 0, 5], "target": [0, 0, 0], "height": )" +
            std::to_string(height) + R"(, "far": 100},
      "objects": {"wall": {"mesh": {"type": "plane", "size": [2, 2]}, "effect": "cell.json",
        "transform": {"rotate": [90, 0, 0]}, "parameters": {"bad": )" +
            std::to_string(bad) + "}}}" + more),
        diagnostics_, (folder_ / "scene.json").string());
    const auto scene = document ? scene::parse_scene(*document, diagnostics_) : std::nullopt;
    backends::Image image;
    if (!scene) return image;
    check::Library library;
    library.allow_outside(true);
    render::PlanOptions options;
    options.compiler.library = &library;
    const auto plan = render::plan_frame(*scene, options, diagnostics_);
    if (!plan) return image;
    stats_ = render::DrawStats();
    EXPECT_TRUE(render::render(*plan, *interpreter::create(), image, stats_, diagnostics_));
    render::warn_non_finite(*scene, *plan, stats_.non_finite, diagnostics_);
    return image;
  }

  bool told(const std::string& part) const { return diagnostics_.text().find(part) != std::string::npos; }

  fs::path folder_;
  support::Diagnostics diagnostics_;
  render::DrawStats stats_;
};

TEST_F(FiniteTest, FiniteImagesAreNotReported) {
  ASSERT_EQ(render(3).width, 32) << diagnostics_.text();
  EXPECT_TRUE(stats_.non_finite.none());
  EXPECT_EQ(diagnostics_.text(), "");
}

TEST_F(FiniteTest, NamesTheObjectAndPassOfTheFirstPixel) {
  for (const int bad : {1, 2}) {
    for (const int samples : {1, 4, 16}) {
      render(bad, ", \"samples\": " + std::to_string(samples));
      EXPECT_EQ(stats_.non_finite.drawn.count, 16) << bad << " " << samples;
      EXPECT_EQ(stats_.non_finite.drawn.x, 16);
      EXPECT_EQ(stats_.non_finite.drawn.y, 12);
      EXPECT_TRUE(told("warning[not-finite]: 16 of 1024 pixels are infinite or NaN; the first, at (16, 12), "
                       "shows object \"wall\", pass \"base\" of \""))
          << diagnostics_.text();
    }
  }
}

TEST_F(FiniteTest, NamesThePostThatMadePixelsNonFinite) {
  render(0, R"(, "posts": [{"name": "first", "effect": "invert.json"}, {"name": "again", "effect": "invert.json"}])");
  EXPECT_EQ(stats_.non_finite.drawn.count, 0);
  ASSERT_EQ(stats_.non_finite.posts.size(), 1u);
  EXPECT_EQ(stats_.non_finite.posts[0].post, 0u);
  EXPECT_TRUE(told("in the image of post \"first\" 16 pixels are infinite or NaN")) << diagnostics_.text();
  // 1 / infinity is finite.
  EXPECT_EQ(stats_.non_finite.result.count, 0);
  EXPECT_TRUE(told("after the posts 0 of 1024 pixels are infinite or NaN")) << diagnostics_.text();
}

std::string bloom(const std::string& first = "") {
  const std::string effects = std::string(ISOSHADE_GRAPHS) + "/effects/bloom/";
  std::string posts = R"(, "posts": [{"name": "bright", "size": 0.5, "effect": ")" + effects + "threshold.json\"" +
                      first + R"(})";
  std::string last;
  for (const char* name : {"half", "quarter", "eighth"}) {
    const std::string size = name[0] == 'h' ? "0.5" : name[0] == 'q' ? "0.25" : "0.125";
    for (const bool down : {false, true})
      posts += std::string(R"(, {"name": ")") + name + (down ? "" : "_x") + R"(", "size": )" + size +
               R"(, "parameters": {"step_x": )" + (down ? "0" : "1") + R"(, "step_y": )" + (down ? "1" : "0") +
               R"(}, "effect": ")" + effects + "blur.json\"}";
  }
  return posts + R"(, {"name": "bloom", "effect": ")" + effects +
         R"(combine.json", "inputs": {"color": "scene", "narrow": "half", "middle": "quarter", "wide": "eighth"}}])";
}

TEST_F(FiniteTest, BloomDoesNotSpreadNonFinitePixels) {
  const backends::Image black = render(0, bloom());
  ASSERT_EQ(black.width, 32) << diagnostics_.text();
  EXPECT_TRUE(stats_.non_finite.none());
  for (const int bad : {1, 2}) {
    const backends::Image image = render(bad, bloom());
    EXPECT_EQ(stats_.non_finite.result.count, 16) << bad;
    for (size_t i = 0; i < black.depth.size(); ++i) {
      const int x = static_cast<int>(i % 32), y = static_cast<int>(i / 32);
      if (x >= 16 && x < 20 && y >= 12 && y < 16) continue;
      ASSERT_EQ(std::memcmp(&image.rgba[4 * i], &black.rgba[4 * i], 16), 0) << bad << " at " << x << " " << y;
    }
  }
}

TEST_F(FiniteTest, BloomLimitsFireflies) {
  const auto brightest_beside = [&](const std::string& firefly) {
    const backends::Image image =
        render(3, bloom(R"(, "parameters": {"threshold": 1, "firefly": )" + firefly + "}"), 8);  // a cell is a pixel
    EXPECT_EQ(image.width, 32) << diagnostics_.text();
    float brightest = 0;
    for (size_t i = 0; i < image.depth.size(); ++i)
      if (image.rgba[4 * i] < 50000) brightest = std::max(brightest, image.rgba[4 * i]);
    return brightest;
  };
  EXPECT_LT(brightest_beside("10"), 1.0f);
  EXPECT_GT(brightest_beside("65504"), 50.0f);
}

}  // namespace
}  // namespace isoshade
