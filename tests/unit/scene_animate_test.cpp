// SPDX-License-Identifier: Apache-2.0
// "animate": what a scene is at a time, and what is said of animations that are none.
#include <cmath>
#include <gtest/gtest.h>

#include "runtime/scene/animate.h"
#include "runtime/scene/format.h"
#include "tests/unit/scene_documents.h"

namespace isoshade::scene {
namespace {

class Animate : public ::testing::Test {
 protected:
  /// The scene at a time; of animations that are the members of "animate".
  std::optional<Scene> at(float time, const std::string& animations, const std::vector<std::string>& settings = {}) {
    const std::string text = testing::scene_text(R"("time": 7, "frames_per_second": 10,
      "camera": {"position": [0, 0, 5], "target": [0, 0, 0]},
      "lights": {"sun": {"type": "directional", "direction": [0, -1, 0]}},
      "objects": {"ball": {"mesh": "sphere", "effect": "e.json", "parameters": {"level": 0.5, "tint": [1, 0, 0]}}},
      "posts": [{"name": "fog", "effect": "f.json", "parameters": {"density": 1}}],
      "animate": {)" + animations + "}");
    diagnostics_ = support::Diagnostics();
    const auto source = std::make_shared<support::SourceFile>("scene.json", text);
    return load_scene(source, settings, {"", false}, diagnostics_, time);
  }
  float fov(float time, const std::string& animation) {
    const auto scene = at(time, R"("camera.fov": )" + animation);
    EXPECT_TRUE(scene) << diagnostics_.text();
    return scene ? scene->camera.fov : -1;
  }
  /// All that is reported for animations that fail.
  std::string error(const std::string& animations) {
    EXPECT_FALSE(at(0, animations)) << animations;
    return diagnostics_.text();
  }
  bool reports(const std::string& animations, const std::string& part) {
    const std::string text = error(animations);
    const bool found = text.find(part) != std::string::npos;
    if (!found) ADD_FAILURE() << text;
    // In the document, with its line.
    return found && text.starts_with("scene.json:");
  }

  support::Diagnostics diagnostics_;
};

TEST_F(Animate, ValuesLieBetweenTheirKeys) {
  const std::string keys = R"({"keys": [[1, 20], [2, 40], [4, 30]]})";
  EXPECT_EQ(fov(0, keys), 20.0f);
  EXPECT_EQ(fov(1, keys), 20.0f);
  EXPECT_EQ(fov(1.25f, keys), 25.0f);
  EXPECT_EQ(fov(2, keys), 40.0f);
  EXPECT_EQ(fov(3, keys), 35.0f);
  EXPECT_EQ(fov(9, keys), 30.0f);
}

TEST_F(Animate, EasesAsItIsTold) {
  EXPECT_EQ(fov(0.25f, R"({"keys": [[0, 10], [1, 42]], "ease": "smooth"})"), 10 + 32 * 0.15625f);
  EXPECT_EQ(fov(0.5f, R"({"keys": [[0, 10], [1, 42]], "ease": "smooth"})"), 26.0f);
  EXPECT_EQ(fov(0.999f, R"({"keys": [[0, 10], [1, 42]], "ease": "step"})"), 10.0f);
  EXPECT_EQ(fov(1, R"({"keys": [[0, 10], [1, 42]], "ease": "step"})"), 42.0f);
}

TEST_F(Animate, LoopsAsItIsTold) {
  const std::string repeat = R"({"keys": [[1, 10], [3, 30]], "loop": "repeat"})";
  EXPECT_EQ(fov(2, repeat), 20.0f);
  EXPECT_EQ(fov(3, repeat), 10.0f);
  EXPECT_EQ(fov(4, repeat), 20.0f);
  EXPECT_EQ(fov(0.5f, repeat), 25.0f);  // before the first key
  const std::string ping_pong = R"({"keys": [[1, 10], [3, 30]], "loop": "ping_pong"})";
  EXPECT_EQ(fov(3, ping_pong), 30.0f);
  EXPECT_EQ(fov(3.5f, ping_pong), 25.0f);
  EXPECT_EQ(fov(5, ping_pong), 10.0f);
  EXPECT_EQ(fov(0.5f, ping_pong), 15.0f);
  EXPECT_EQ(fov(5, R"({"keys": [[1, 10]], "loop": "repeat"})"), 10.0f);
}

TEST_F(Animate, MovesValuesOfEveryKind) {
  const auto scene = at(0.5f, R"(
      "camera.position": {"keys": [[0, [0, 0, 5]], [1, [2, 4, 3]]]},
      "lights.sun.intensity": {"keys": [[0, 1], [1, 2]]},
      "objects.ball.transform.rotate": {"keys": [[0, [0, 0, 0]], [1, [0, 90, 0]]]},
      "objects.ball.transform.scale": {"keys": [[0, 1], [1, 2]]},
      "objects.ball.casts_shadow": {"keys": [[0, true], [0.4, false]]},
      "objects.ball.parameters.level": {"keys": [[0, 0], [1, 1]]},
      "objects.ball.parameters.other": {"keys": [[0, [0, 2]], [1, [1, 1]]]},
      "posts.fog.parameters.density": {"keys": [[0, 2], [1, 4]]})");
  ASSERT_TRUE(scene) << diagnostics_.text();
  EXPECT_EQ(scene->time, 0.5f);
  EXPECT_EQ(scene->camera.position, glm::vec3(1, 2, 4));
  EXPECT_EQ(scene->lights[0].intensity, 1.5f);
  const Object& ball = scene->objects[0];
  EXPECT_EQ(ball.transform.rotate, glm::vec3(0, 45, 0));
  EXPECT_EQ(ball.transform.scale, glm::vec3(1.5f));
  EXPECT_FALSE(ball.casts_shadow);
  ASSERT_EQ(ball.parameters.size(), 3u);
  EXPECT_EQ(ball.parameters[0].value.number, 0.5f);
  EXPECT_EQ(ball.parameters[2].value.numbers, (std::vector<float>{0.5f, 1.5f}));
  EXPECT_EQ(scene->posts[0].parameters[0].value.number, 3.0f);
}

TEST_F(Animate, QuaternionsTurnTheShorterWayAndKeepTheirLength) {
  const auto scene = at(0.5f, R"("objects.ball.transform.rotate":
      {"keys": [[0, [0, 0, 0, 1]], [1, [0, -0.6, 0, -0.8]]]})");
  ASSERT_TRUE(scene) << diagnostics_.text();
  const std::array<float, 4> q = *scene->objects[0].transform.rotation;
  EXPECT_FLOAT_EQ(q[1] / q[3], 0.6f / 1.8f);
  EXPECT_NEAR(q[1] * q[1] + q[3] * q[3], 1, 1e-6);
}

TEST_F(Animate, TheFrameBeforeIsOneStepOfTheFrameRateEarlier) {
  const auto scene = at(0.5f, R"("camera.fov": {"keys": [[0, 10], [1, 20]]})");
  ASSERT_TRUE(scene && scene->before);
  EXPECT_EQ(scene->before->time, 0.4f);
  EXPECT_FLOAT_EQ(scene->before->camera.fov, 14.0f);
}

TEST_F(Animate, TheTimeIsTheScenesUnlessOneIsGiven) {
  const std::string animations = R"("animate": {"camera.fov": {"keys": [[0, 10], [10, 20]]}}, "time": 5)";
  const auto load = [&](const std::vector<std::string>& settings, std::optional<float> time) {
    const auto source = std::make_shared<support::SourceFile>("s.json", testing::scene_text(animations));
    return load_scene(source, settings, {"", false}, diagnostics_, time)->camera.fov;
  };
  EXPECT_EQ(load({}, {}), 15.0f);
  EXPECT_EQ(load({"time=2"}, {}), 12.0f);
  EXPECT_EQ(load({"time=2"}, 4.0f), 14.0f);
}

TEST_F(Animate, SettingsWinOverAnimations) {
  const std::string animations = R"("camera.fov": {"keys": [[0, 10], [1, 20]]},
      "objects.ball.parameters.level": {"keys": [[0, 0], [1, 1]]})";
  const auto scene = at(0.5f, animations, {"camera.fov=33", "ball.level=0.25"});
  ASSERT_TRUE(scene) << diagnostics_.text();
  EXPECT_EQ(scene->camera.fov, 33.0f);
  EXPECT_EQ(scene->before->camera.fov, 33.0f);
  EXPECT_EQ(scene->objects[0].parameters[0].value.number, 0.25f);
}

TEST_F(Animate, EveryCheckOfTheFormatAppliesToWhatMoves) {
  EXPECT_TRUE(reports(R"("camera.fov": {"keys": [[0, 190]]})", "must be from 0.01 to 179"));
  EXPECT_TRUE(reports(R"("camera.position": {"keys": [[0, [0, 0, 0]]]})", "are the same"));
  EXPECT_TRUE(reports(R"("objects.ball.transform.scale": {"keys": [[-1, -1], [1, 1]]})", "zero or nearly so"));
}

TEST_F(Animate, PathsThatLeadToNothingAreReportedWithTheNearestName) {
  EXPECT_TRUE(reports(R"("camera.positoin": {"keys": [[0, 1]]})", "did you mean \"position\"?"));
  EXPECT_TRUE(reports(R"("objects.bal.casts_shadow": {"keys": [[0, true]]})", "did you mean \"ball\"?"));
  EXPECT_TRUE(reports(R"("posts.fgo.parameters.density": {"keys": [[0, 1]]})", "did you mean \"fog\"?"));
  EXPECT_TRUE(reports(R"("lights.moon.intensity": {"keys": [[0, 1]]})", "there are sun"));
  EXPECT_TRUE(reports(R"("": {"keys": [[0, 1]]})", "leads to nothing"));
  EXPECT_TRUE(reports(R"("camera..fov": {"keys": [[0, 1]]})", "leads to nothing"));
}

TEST_F(Animate, WhatMayNotMoveIsReportedWithTheReason) {
  EXPECT_TRUE(reports(R"("objects.ball.mesh.radius": {"keys": [[0, 1]]})", "a mesh is made once"));
  EXPECT_TRUE(reports(R"("objects.ball.effect": {"keys": [[0, 1]]})", "only numbers, lists of numbers and booleans"));
  EXPECT_TRUE(reports(R"("camera.fov.": {"keys": [[0, 30]]})", "ends with a dot"));
  EXPECT_TRUE(reports(R"("size": {"keys": [[0, [8, 8]]]})", "sizes and counts are the same"));
  EXPECT_TRUE(reports(R"("samples": {"keys": [[0, 1]]})", "sizes and counts are the same"));
  EXPECT_TRUE(reports(R"("posts.fog.size": {"keys": [[0, 1]]})", "sizes and counts are the same"));
  EXPECT_TRUE(reports(R"("time": {"keys": [[0, 1]]})", "the time by which all else moves"));
  EXPECT_TRUE(reports(R"("camera": {"keys": [[0, 1]]})", "name one of its keys"));
  EXPECT_TRUE(reports(R"("objects.ball": {"keys": [[0, 1]]})", "name one of its keys"));
  EXPECT_TRUE(reports(R"("objects.ball.parameters": {"keys": [[0, 1]]})", "name one of the parameters"));
  EXPECT_TRUE(reports(R"("objects.ball.parameters.tint.r": {"keys": [[0, 1]]})", "a parameter has no parts"));
  EXPECT_TRUE(reports(R"("camera.fov.x": {"keys": [[0, 1]]})", "has no parts"));
}

TEST_F(Animate, ValuesOfAnotherShapeAreReported) {
  EXPECT_TRUE(reports(R"("camera.position": {"keys": [[0, 1]]})", "must be a list of 3 numbers, not a number"));
  EXPECT_TRUE(reports(R"("camera.fov": {"keys": [[0, true]]})", "must be a number, not a boolean"));
  EXPECT_TRUE(reports(R"("objects.ball.parameters.tint": {"keys": [[0, [1, 1]]]})", "must be a list of 3 numbers"));
  EXPECT_TRUE(reports(R"("objects.ball.transform.scale": {"keys": [[0, 1], [1, [1, 1, 1]]]})", "as the first key"));
  EXPECT_TRUE(reports(R"("camera.fov": {"keys": [[0, "wide"]]})", "must be a number, a list of numbers or a boolean"));
  EXPECT_TRUE(reports(R"("camera.position": {"keys": [[0, [1, "2", 3]]]})", "must be a number, a list of numbers or a boolean"));
}

TEST_F(Animate, KeysThatAreNoneAreReported) {
  EXPECT_TRUE(reports(R"("camera.fov": {"keys": []})", "has no keys"));
  EXPECT_TRUE(reports(R"("camera.fov": {})", "needs the key \"keys\""));
  EXPECT_TRUE(reports(R"("camera.fov": {"keys": [[0, 1], [0, 2]]})", "must ascend"));
  EXPECT_TRUE(reports(R"("camera.fov": {"keys": [[1, 1], [0, 2]]})", "must ascend"));
  EXPECT_TRUE(reports(R"("camera.fov": {"keys": [[1e10, 1]]})", "from -1e9 to 1e9"));
  EXPECT_TRUE(reports(R"("camera.fov": {"keys": [1, 2]})", "must be a time and a value"));
  EXPECT_TRUE(reports(R"("camera.fov": {"keys": [["now", 2]]})", "must be a time and a value"));
  EXPECT_TRUE(reports(R"("camera.fov": {"keys": [[0, 30]], "ease": "smoth"})", "did you mean \"smooth\"?"));
  EXPECT_TRUE(reports(R"("camera.fov": {"keys": [[0, 30]], "loop": "forever"})", "once, repeat, ping_pong"));
  EXPECT_TRUE(reports(R"("camera.fov": {"keys": [[0, 30]], "speed": 2})", "has no key \"speed\""));
  EXPECT_TRUE(reports(R"("camera.fov": 3)", "must be an object"));
}

}  // namespace
}  // namespace isoshade::scene
