// SPDX-License-Identifier: Apache-2.0
// The key "environment" of scenes.
#include <gtest/gtest.h>

#include "tests/unit/scene_documents.h"

namespace isoshade {
namespace {

using testing::parse_members;

TEST(SceneEnvironment, IsAFileOrASky) {
  const auto file = parse_members(R"("environment": {"file": "a.hdr", "rotate": -90, "intensity": 2})");
  ASSERT_TRUE(file.scene && file.scene->environment) << file.first_error();
  EXPECT_EQ(file.scene->environment->file, "scenes/a.hdr");
  EXPECT_EQ(file.scene->environment->rotate, -90);
  EXPECT_EQ(file.scene->environment->intensity, 2);
  const auto sky = parse_members(R"("environment": {"sky": {"zenith": [1, 2, 3], "sun": {"direction": [0, -2, 0]}}})");
  ASSERT_TRUE(sky.scene && sky.scene->environment) << sky.first_error();
  EXPECT_TRUE(sky.scene->environment->file.empty());
  EXPECT_EQ(sky.scene->environment->sky.zenith, glm::vec3(1, 2, 3));
  ASSERT_TRUE(sky.scene->environment->sky.sun);
  EXPECT_EQ(sky.scene->environment->sky.sun->direction, glm::vec3(0, -2, 0));
  EXPECT_FALSE(parse_members("").scene->environment);
}

TEST(SceneEnvironment, MistakesAreReported) {
  const auto fails = [](const std::string& environment, const std::string& part) {
    const auto parsed = parse_members("\"environment\": " + environment);
    EXPECT_TRUE(parsed.fails_with(part)) << environment << ": " << parsed.first_error();
  };
  fails("{}", "missing-key: the environment needs a \"file\" or a \"sky\"");
  fails(R"({"file": "a.hdr", "sky": {}})", "both a \"file\" and a \"sky\"");
  fails(R"({"file": "a.hdr", "rotation": 3})", "unknown-key");
  fails(R"({"sky": {"sun": {}}})", "missing-key");
  fails(R"({"sky": {"sun": {"direction": [0, 0, 0]}}})", "degenerate");
  fails(R"({"sky": {"sun": {"direction": [1e-300, 0, 0]}}})", "\"direction\" of the sun is zero, or too short");
  fails(R"({"sky": {"colour": [0, 0, 0]}})", "unknown-key");
  fails(R"({"file": "a.hdr", "intensity": -1})", "out-of-range");
  fails(R"({"file": 3})", "wrong-type");
  fails("\"a.hdr\"", "wrong-type");
}

TEST(SceneEnvironment, IsChangedBySettings) {
  const std::string members = R"("environment": {"file": "a.hdr"})";
  const auto turned = parse_members(members, {"environment.rotate=45", "environment.intensity=0.5"});
  ASSERT_TRUE(turned.scene) << turned.first_error();
  EXPECT_EQ(turned.scene->environment->rotate, 45);
  EXPECT_EQ(turned.scene->environment->intensity, 0.5f);
}

}  // namespace
}  // namespace isoshade
