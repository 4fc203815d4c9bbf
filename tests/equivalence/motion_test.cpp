// SPDX-License-Identifier: Apache-2.0
// How far things have moved since the frame before, and what motion blur makes of that: by numbers that follow from the
// scene, and with the same bits on every backend.
#include <array>
#include <cmath>

#include "backends/cpu/lane_count.h"
#include "backends/reference/backend.h"
#include "tests/equivalence/scene_folder.h"

namespace isoshade::equivalence {
namespace {

/// Shows motion as a colour.
const std::string show = R"json({"isoshade": 1, "post": "show",
  "nodes": {"m": {"type": "motion"}, "c": {"type": "expression", "code": "color4(m.x, m.y, 0, 1)", "m": "m"}},
  "outputs": {"color": "c"}})json";

/// Moves its vertices upwards by the time, and has holes.
const std::string rising = R"json({"isoshade": 1, "effect": "rising",
  "parameters": {"speed": {"type": "float", "value": 0}, "clear": {"type": "boolean", "value": false},
                 "level": {"type": "float", "value": 0}},
  "nodes": {
    "t": {"type": "time"}, "p": {"type": "position"}, "before": {"type": "previousposition"}, "uv": {"type": "texcoord"},
    "up": {"type": "expression", "code": "p + vector3(0, speed * t, 0)", "p": "p", "speed": "speed", "t": "t"},
    "rings": {"type": "expression", "code": "fract(5 * length(uv - vector2(0.5)))", "uv": "uv"},
    "color": {"type": "expression", "code": "color4(p.x - before.x, p.y - before.y, 1, 0.5)", "p": "p", "before": "before"}},
  "passes": [{"name": "base", "cull": "none", "position": "up", "cutout": "rings", "cutoff": "level",
              "blend": "over", "blended": "clear", "depth_write": "on", "color": "color"}]})json";

/// Glass, which does not write depth.
const std::string glass = R"json({"isoshade": 1, "effect": "glass",
  "passes": [{"name": "base", "cull": "none", "blend": "over", "color": [0.2, 0.4, 0.6, 0.5]}]})json";

const std::string flat = R"json({"isoshade": 1, "effect": "flat",
  "parameters": {"tint": {"type": "color3", "value": [1, 0.5, 0.25]}},
  "passes": [{"name": "base", "cull": "none", "color": "tint"}]})json";

/// Stripes that tell each place from its neighbours.
const std::string stripes = R"json({"isoshade": 1, "effect": "stripes",
  "nodes": {"p": {"type": "position"},
            "c": {"type": "expression", "code": "color3(fract(p.x * 7.3), fract(p.y * 5.1), fract(p.x + p.y))", "p": "p"}},
  "passes": [{"name": "base", "cull": "none", "color": "c"}]})json";

// A pixel is a hundredth of a unit.
const std::string flat_camera = R"("camera": {"type": "orthographic", "height": 1.2, "position": [0, 0, 5],
  "target": [0, 0, 0]}, "frames_per_second": 10)";
constexpr Size flat_size{200, 120};

class Motion : public SceneFolder {
 protected:
  Motion() {
    for (const auto& [name, text] : std::array{std::pair("show", &show), std::pair("rising", &rising), std::pair("glass", &glass),
                                               std::pair("flat", &flat), std::pair("stripes", &stripes)})
      folder_.write(std::string(name) + ".json", *text);
    std::filesystem::copy(ISOSHADE_GRAPHS "/effects/motion_blur", folder_.path());
  }

  render::Plan plan_at(float time, Size size, const std::string& members, int samples = 1) {
    support::Diagnostics diagnostics;
    const auto source = std::make_shared<support::SourceFile>((folder_.path() / "scene.json").string(),
                                                              isoshade::testing::scene_text(members));
    auto scene = scene::load_scene(source, {}, {"", true}, diagnostics, time);
    EXPECT_TRUE(scene) << diagnostics.text();
    scenes_.push_back(scene ? *std::move(scene) : scene::Scene());
    scenes_.back().samples = samples;
    return equivalence::plan(scenes_.back(), size.width, size.height);
  }
  backends::Image draw_at(float time, Size size, const std::string& members) {
    return draw(plan_at(time, size, members), *interpreter::create());
  }

  static std::array<float, 2> at(const backends::Image& image, int x, int y) {
    const size_t first = 4 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x));
    return {image.rgba[first], image.rgba[first + 1]};
  }

  static std::string shown(const std::string& objects, const std::string& animations) {
    return flat_camera + R"(, "posts": [{"name": "show", "effect": "show.json"}], "objects": {)" + objects +
           R"(}, "animate": {)" + animations + "}";
  }

  /// The posts of motion blur.
  static std::string blurred(const std::string& parameters) {
    return R"("posts": [
      {"name": "t4", "effect": "longest.json", "size": 0.25, "inputs": {"vectors": "motion"}},
      {"name": "t16", "effect": "longest.json", "size": 0.0625, "inputs": {"vectors": "t4"}},
      {"name": "t32", "effect": "longest.json", "size": 0.03125, "inputs": {"vectors": "t16"}},
      {"name": "around", "effect": "neighbours.json", "size": 0.03125, "inputs": {"vectors": "t32"}},
      {"name": "blur", "effect": "blur.json", "inputs": {"color": "scene", "neighbours": "around"},
       "parameters": {)" + parameters + "}}]";
  }
};

const std::string ball = R"("ball": {"mesh": {"type": "sphere", "radius": 0.2}, "effect": "flat.json"})";

TEST_F(Motion, IsHowFarTheTransformHasMovedAndNothingElsewhere) {
  const auto image = draw_at(0.1f, flat_size, shown(ball, R"("objects.ball.transform.translate":
      {"keys": [[0, [-0.2, 0.05, 0]], [0.1, [0.2, 0, 0]]]})"));
  const auto [x, y] = at(image, 120, 60);
  EXPECT_NEAR(x, 40, 1e-4);
  EXPECT_NEAR(y, 5, 1e-4);  // downwards
  EXPECT_EQ(at(image, 60, 60), (std::array{0.0f, 0.0f}));
}

TEST_F(Motion, OfWhatRestsIsExactlyZero) {
  const std::string objects = R"("floor": {"mesh": {"type": "plane", "size": [9, 9]}, "effect": "stripes.json",
    "transform": {"rotate": [81, 13, 7]}})";
  const std::string camera = R"("camera": {"position": [0.3, 1.7, 4.1], "target": [0.2, 0, 0.1]})";
  const auto image = draw_at(0.3f, {64, 48}, camera + R"(, "posts": [{"name": "show", "effect": "show.json"}],
    "objects": {)" + objects + "}");
  for (size_t i = 0; i < image.rgba.size(); i += 4) ASSERT_TRUE(image.rgba[i] == 0 && image.rgba[i + 1] == 0) << i;
}

TEST_F(Motion, FollowsVerticesThatAPassMoves) {
  const auto image = draw_at(0.1f, flat_size, shown(R"("ball": {"mesh": {"type": "sphere", "radius": 0.3},
      "effect": "rising.json", "parameters": {"speed": 1}})", R"("objects.ball.parameters.level": {"keys": [[0, 0]]})"));
  const auto [x, y] = at(image, 100, 55);
  EXPECT_NEAR(x, 0, 1e-4);
  EXPECT_NEAR(y, -10, 1e-3);
}

TEST_F(Motion, OfTheBackdropFollowsTheTurnOfTheCamera) {
  // The camera turns by five degrees to the right: the backdrop moves to the left.
  const double pi = std::acos(-1), turn = 5 * pi / 180, half = std::tan(20 * pi / 180);
  const std::string target = std::to_string(std::sin(turn)) + ", 0, " + std::to_string(-std::cos(turn));
  const auto image = draw_at(0.1f, {160, 120}, R"("frames_per_second": 10,
    "camera": {"position": [0, 0, 0], "target": [0, 0, -1], "fov": 40},
    "posts": [{"name": "show", "effect": "show.json"}],
    "animate": {"camera.target": {"keys": [[0, [0, 0, -1]], [0.1, [)" + target + R"(]]]},
                "camera.position": {"keys": [[0, [0, 0, 0]], [0.1, [0, 0, 0]]]}})");
  for (const int x : {0, 80, 159}) {
    const double from_middle = (x + 0.5 - 80) / 60 * half;
    const double before = std::tan(std::atan(from_middle) + turn);
    EXPECT_NEAR(at(image, x, 60)[0], (from_middle - before) / half * 60, 2e-3) << x;
  }
}

TEST_F(Motion, OfWhatWasBehindTheCameraIsZero) {
  const auto image = draw_at(0.1f, {32, 32}, R"("frames_per_second": 10, "posts": [{"name": "show", "effect": "show.json"}],
    "camera": {"position": [0, 0, 5], "target": [0, 0, -9]},
    "objects": {"wall": {"mesh": {"type": "plane", "size": [20, 20]}, "effect": "flat.json",
                         "transform": {"translate": [0, 0, 2], "rotate": [90, 0, 0]}}},
    "animate": {"camera.position": {"keys": [[0, [1, 0, 1]], [0.1, [0, 0, 5]]]}})");
  for (size_t i = 0; i < image.rgba.size(); i += 4) ASSERT_TRUE(image.rgba[i] == 0 && image.rgba[i + 1] == 0) << i;
}

TEST_F(Motion, OfBlendedPassesCountsOnlyIfTheyWriteDepth) {
  const std::string move = R"("objects.pane.transform.translate": {"keys": [[0, [0, 0, 1]], [0.1, [0.1, 0, 1]]]})";
  const std::string pane = R"("pane": {"mesh": {"type": "plane", "size": [2, 2]}, "transform": {"rotate": [90, 0, 0]}, "effect": )";
  EXPECT_EQ(at(draw_at(0.1f, flat_size, shown(ball + ", " + pane + R"("glass.json"})", move)), 100, 60)[0], 0);
  EXPECT_NEAR(at(draw_at(0.1f, flat_size, shown(ball + ", " + pane + R"("rising.json", "parameters": {"clear": true}})", move)),
                 100, 60)[0],
              10, 1e-4);
}

TEST_F(Motion, IsDrawnOnlyIfAPostReadsIt) {
  const std::string move = R"("animate": {"objects.ball.transform.translate": {"keys": [[0, [0, 0, 0]], [1, [1, 0, 0]]]}})";
  const std::string members = flat_camera + R"(, "objects": {)" + ball + "}, " + move;
  EXPECT_FALSE(plan_at(0.5f, flat_size, members).motion);
  EXPECT_TRUE(plan_at(0.5f, flat_size, members + ", " + blurred(R"("shutter": 0.5)")).motion);
  EXPECT_FALSE(plan_at(0.5f, flat_size, members + ", " + blurred(R"("shutter": 0)")).motion);
}

TEST_F(Motion, PreviousPositionIsThatOfTheTransformBefore) {
  const auto image = draw_at(0.1f, flat_size, flat_camera + R"(, "objects": {"ball": {"mesh": {"type": "sphere", "radius": 0.3},
      "effect": "rising.json"}}, "animate": {"objects.ball.transform.translate": {"keys": [[0, [0, 0, 0]], [0.1, [0.25, 0.125, 0]]]}})");
  const auto [x, y] = at(image, 125, 48);
  EXPECT_NEAR(x, 0.25, 1e-5);
  EXPECT_NEAR(y, 0.125, 1e-5);
}

TEST_F(Motion, ABallThatMovesFortyPixelsIsSmearedByForty) {
  const std::string members = flat_camera + R"(, "objects": {)" + ball + R"(,
      "wall": {"mesh": {"type": "plane", "size": [4, 4]}, "effect": "stripes.json",
               "transform": {"translate": [0, 0, -2], "rotate": [90, 0, 0]}}},
    "animate": {"objects.ball.transform.translate": {"keys": [[0, [-0.4, 0, 0]], [0.1, [0, 0, 0]]]}})";
  const auto sharp = draw_at(0.1f, flat_size, members);
  const auto smeared = draw_at(0.1f, flat_size, members + ", " + blurred(R"("shutter": 1)"));
  const auto still = draw_at(0.1f, flat_size, flat_camera + R"(, "objects": {"wall": {"mesh": {"type": "plane", "size": [4, 4]},
      "effect": "stripes.json", "transform": {"translate": [0, 0, -2], "rotate": [90, 0, 0]}}})");
  const auto same = [&](const backends::Image& a, const backends::Image& b, int x, int y) {
    return at(a, x, y) == at(b, x, y) &&
           a.rgba[4 * static_cast<size_t>(y * a.width + x) + 2] == b.rgba[4 * static_cast<size_t>(y * a.width + x) + 2];
  };
  for (int y = 0; y < flat_size.height; ++y) {
    int ball_width = 0, smeared_width = 0;
    for (int x = 0; x < flat_size.width; ++x) {
      ball_width += same(sharp, still, x, y) ? 0 : 1;
      smeared_width += same(smeared, still, x, y) ? 0 : 1;
    }
    if (ball_width == 0) {
      EXPECT_EQ(smeared_width, 0) << "the background of row " << y << " has changed";
    } else {
      EXPECT_NEAR(smeared_width - ball_width, 40, 1) << "row " << y;
    }
  }
}

TEST_F(Motion, BlurKeepsWhatStandsInFront) {
  // A post stands before the ball.
  const std::string post = R"("post": {"mesh": {"type": "plane", "size": [0.1, 2]}, "effect": "stripes.json",
    "transform": {"translate": [0, 0, 2], "rotate": [90, 0, 0]}})";
  const std::string members = flat_camera + R"(, "objects": {)" + ball + ", " + post + R"(},
    "animate": {"objects.ball.transform.translate": {"keys": [[0, [-0.4, 0, 0]], [0.1, [0, 0, 0]]]}})";
  const auto sharp = draw_at(0.1f, flat_size, members);
  const auto smeared = draw_at(0.1f, flat_size, members + ", " + blurred(R"("shutter": 1)"));
  for (int x = 96; x < 104; ++x) EXPECT_EQ(at(sharp, x, 60), at(smeared, x, 60)) << x;
  EXPECT_NE(at(sharp, 79, 60), at(smeared, 79, 60));
}

/// Surfaces of every kind that move in every way, before a camera that moves as well.
const std::string members = R"("frames_per_second": 12, "sort": "back_to_front", "background": [0.1, 0.2, 0.3, 0.5],
  "camera": {"position": [1, 1.2, 4], "target": [0, 0, 0], "fov": 40},
  "objects": {
    "floor": {"mesh": {"type": "plane", "size": [30, 30], "segments": 3}, "effect": "stripes.json",
              "transform": {"translate": [0, -1, 0]}},
    "rising": {"mesh": {"type": "sphere", "segments": 24, "rings": 12}, "effect": "rising.json",
               "parameters": {"speed": 0.5, "level": 0.3}},
    "mirrored": {"mesh": "box", "effect": "rising.json", "parameters": {"clear": true},
                 "transform": {"translate": [0.8, 0.2, 0.7], "scale": [-1, 1.2, 0.8]}},
    "pane": {"mesh": {"type": "plane", "size": [2, 2]}, "effect": "glass.json", "transform": {"rotate": [90, 0, 0]}},
    "grid": {"mesh": "sphere", "effect": "flat.json", "transform": {"scale": 0.2},
             "repeat": [{"count": 3, "step": [0.7, 0, -0.5]}]}},
  "animate": {
    "camera.position": {"keys": [[0, [1, 1.2, 4]], [1, [-1, 0.8, 3]]], "ease": "smooth"},
    "objects.mirrored.transform.rotate": {"keys": [[0, [0, 0, 0]], [1, [90, 400, 0]]], "loop": "ping_pong"},
    "objects.rising.parameters.speed": {"keys": [[0, 0.5], [1, 1]]},
    "objects.grid.repeat.0.step": {"keys": [[0, [0.7, 0, -0.5]], [0.5, [0.5, 0.4, -0.5]]]},
    "objects.pane.transform.translate": {"keys": [[0, [0, 0, 1]], [0.3, [0.5, 0, 1.5]]], "loop": "repeat"}})";

TEST_F(Motion, IsTheSameOnEveryBackendAtTwoTimes) {
  for (const float time : {0.25f, 0.9f}) {
    for (const int samples : {1, 4, 16}) {
      for (const std::string& posts : {std::string(R"("posts": [{"name": "show", "effect": "show.json"}])"),
                                       blurred(R"("shutter": 0.8)")}) {
        const render::Plan made = plan_at(time, {53, 37}, members + ", " + posts, samples);
        const std::string what = "time " + std::to_string(time) + ", " + std::to_string(samples) + " samples";
        const auto first = draw(made, *interpreter::create());
        for (const cpu::LaneCount& lanes : cpu::lane_counts())
          if (lanes.available()) expect_identical(first, draw(made, *cpu_backend(std::string(lanes.name))), what + ", cpu");
#ifdef ISOSHADE_VULKAN
        expect_identical(first, draw(made, *vulkan_backend()), what + ", vulkan");
        expect_identical(first, draw(made, *vulkan_backend(driver::Division::exact)), what + ", exact division");
#endif
      }
    }
  }
}

TEST_F(Motion, TheReferenceAgreesWithinRounding) {
  support::Diagnostics diagnostics;
  const auto source = std::make_shared<support::SourceFile>(
      (folder_.path() / "scene.json").string(),
      isoshade::testing::scene_text(members + R"(, "posts": [{"name": "show", "effect": "show.json"}])"));
  const auto scene = scene::load_scene(source, {}, {"", true}, diagnostics, 0.25f);
  ASSERT_TRUE(scene) << diagnostics.text();
  check::Library library(ISOSHADE_GRAPHS "/library");
  render::PlanOptions options;
  options.width = 53;
  options.height = 37;
  options.compiler.library = &library;
  options.compiler.reference = true;
  const auto reference = render::plan_frame(*scene, options, diagnostics);
  options.compiler.reference = false;
  const auto usual = render::plan_frame(*scene, options, diagnostics);
  ASSERT_TRUE(reference && usual) << diagnostics.text();
  const auto exact = draw(*reference, *reference::create()), rounded = draw(*usual, *interpreter::create());
  for (size_t i = 0; i < exact.rgba.size(); ++i) EXPECT_NEAR(exact.rgba[i], rounded.rgba[i], 2e-3) << i;
}

}  // namespace
}  // namespace isoshade::equivalence
