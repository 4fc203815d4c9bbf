// SPDX-License-Identifier: Apache-2.0
// How far things have moved since the frame before, and what motion blur makes of that, against numbers that follow from the
// scene.
#include <cmath>

#include "backends/reference/backend.h"
#include "tests/equivalence/motion_scenes.h"

namespace isoshade::equivalence {
namespace {

TEST_F(Motion, IsHowFarTheTransformHasMovedAndNothingElsewhere) {
  const auto image = draw_at(0.1f, flat_size, shown(ball, R"("objects.ball.transform.translate":
      {"keys": [[0, [-0.2, 0.05, 0]], [0.1, [0.2, 0, 0]]]})"));
  const auto [x, y] = at(image, 120, 60);
  EXPECT_NEAR(x, 40, 1e-4);
  EXPECT_NEAR(y, 5, 1e-4);  // downwards
  EXPECT_EQ(at(image, 60, 60), (std::array{0.0f, 0.0f}));
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

TEST_F(Motion, OfBlendedPassesCountsOnlyIfTheyWriteDepth) {
  const std::string move = R"("objects.pane.transform.translate": {"keys": [[0, [0, 0, 1]], [0.1, [0.1, 0, 1]]]})";
  const std::string pane = R"("pane": {"mesh": {"type": "plane", "size": [2, 2]}, "transform": {"rotate": [90, 0, 0]}, "effect": )";
  EXPECT_EQ(at(draw_at(0.1f, flat_size, shown(ball + ", " + pane + R"("glass.json"})", move)), 100, 60)[0], 0);
  EXPECT_NEAR(at(draw_at(0.1f, flat_size, shown(ball + ", " + pane + R"("rising.json", "parameters": {"clear": true}})", move)),
                 100, 60)[0],
              10, 1e-4);
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

TEST_F(Motion, TheReferenceAgreesWithinRounding) {
  support::Diagnostics diagnostics;
  const auto source = std::make_shared<support::SourceFile>(
      (folder_.path() / "scene.json").string(),
      isoshade::testing::scene_text(members_in_motion + R"(, "posts": [{"name": "show", "effect": "show.json"}])"));
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
