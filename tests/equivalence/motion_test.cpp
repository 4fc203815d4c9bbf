// SPDX-License-Identifier: Apache-2.0
// How far things have moved since the frame before, and what motion blur makes of that: where it is exactly nothing, and
// the same bits on every backend.
#include "backends/cpu/lane_count.h"
#include "tests/equivalence/motion_scenes.h"

namespace isoshade::equivalence {
namespace {

TEST_F(Motion, OfWhatRestsIsExactlyZero) {
  const std::string objects = R"("floor": {"mesh": {"type": "plane", "size": [9, 9]}, "effect": "stripes.json",
    "transform": {"rotate": [81, 13, 7]}})";
  const std::string camera = R"("camera": {"position": [0.3, 1.7, 4.1], "target": [0.2, 0, 0.1]})";
  const auto image = draw_at(0.3f, {64, 48}, camera + R"(, "posts": [{"name": "show", "effect": "show.json"}],
    "objects": {)" + objects + "}");
  for (size_t i = 0; i < image.rgba.size(); i += 4) ASSERT_TRUE(image.rgba[i] == 0 && image.rgba[i + 1] == 0) << i;
}

TEST_F(Motion, OfWhatWasBehindTheCameraIsZero) {
  const auto image = draw_at(0.1f, {32, 32}, R"("frames_per_second": 10, "posts": [{"name": "show", "effect": "show.json"}],
    "camera": {"position": [0, 0, 5], "target": [0, 0, -9]},
    "objects": {"wall": {"mesh": {"type": "plane", "size": [20, 20]}, "effect": "flat.json",
                         "transform": {"translate": [0, 0, 2], "rotate": [90, 0, 0]}}},
    "animate": {"camera.position": {"keys": [[0, [1, 0, 1]], [0.1, [0, 0, 5]]]}})");
  for (size_t i = 0; i < image.rgba.size(); i += 4) ASSERT_TRUE(image.rgba[i] == 0 && image.rgba[i + 1] == 0) << i;
}

TEST_F(Motion, IsDrawnOnlyIfAPostReadsIt) {
  const std::string move = R"("animate": {"objects.ball.transform.translate": {"keys": [[0, [0, 0, 0]], [1, [1, 0, 0]]]}})";
  const std::string members = flat_camera + R"(, "objects": {)" + ball + "}, " + move;
  EXPECT_FALSE(plan_at(0.5f, flat_size, members).motion);
  EXPECT_TRUE(plan_at(0.5f, flat_size, members + ", " + blurred(R"("shutter": 0.5)")).motion);
  EXPECT_FALSE(plan_at(0.5f, flat_size, members + ", " + blurred(R"("shutter": 0)")).motion);
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

TEST_F(Motion, IsTheSameOnEveryBackendAtTwoTimes) {
  for (const float time : {0.25f, 0.9f}) {
    for (const int samples : {1, 4, 16}) {
      for (const std::string& posts : {std::string(R"("posts": [{"name": "show", "effect": "show.json"}])"),
                                       blurred(R"("shutter": 0.8)")}) {
        const render::Plan made = plan_at(time, {53, 37}, members_in_motion + ", " + posts, samples);
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

}  // namespace
}  // namespace isoshade::equivalence
