// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/unit/scene_documents.h"

namespace isoshade {
namespace {

using testing::parse_members;
using testing::ParsedScene;

constexpr const char* members = R"("lights": {"sun": {"type": "directional", "direction": [0, -1, 0]}},
  "objects": {
    "balls": {"mesh": "sphere", "effect": "e.json", "parameters": {"metallic": 1, "gloss": 0.5},
              "repeat": [{"count": 2, "step": [1, 0, 0],
                          "parameters": {"roughness": {"from": 0, "to": 1}, "tint": {"values": [0, 1]}}}]},
    "floor": {"mesh": "plane", "effect": "e.json", "parameters": {"metallic": 0}},
    "bare": {"mesh": "box", "effect": "e.json"}})";

const scene::Parameter* find(const scene::Object& object, const std::string& name) {
  for (const scene::Parameter& parameter : object.parameters)
    if (parameter.name == name) return &parameter;
  return nullptr;
}

TEST(Settings, ReplaceAParameterOfAnObject) {
  const ParsedScene parsed = parse_members(members, {"balls.metallic=0.25"});
  ASSERT_TRUE(parsed.scene) << parsed.diagnostics.text();
  EXPECT_EQ(find(parsed.scene->objects[0], "metallic")->value.number, 0.25f);
  EXPECT_EQ(find(parsed.scene->objects[1], "metallic")->value.number, 0.0f);
}

TEST(Settings, ReplaceAVariationAlongAGrid) {
  const ParsedScene parsed = parse_members(members, {"roughness=0.5", "balls.tint=0.75"});
  ASSERT_TRUE(parsed.scene) << parsed.diagnostics.text();
  const scene::Object& balls = parsed.scene->objects[0];
  EXPECT_TRUE(balls.repeat[0].variations.empty());
  EXPECT_EQ(find(balls, "roughness")->value.number, 0.5f);
  EXPECT_EQ(find(balls, "tint")->value.number, 0.75f);
}

TEST(Settings, ReplaceTheNumberOfSamples) {
  const ParsedScene parsed = parse_members(members, {"samples=4"});
  ASSERT_TRUE(parsed.scene) << parsed.diagnostics.text();
  EXPECT_EQ(parsed.scene->samples, 4);
}

TEST(Settings, ApplyInOrder) {
  const ParsedScene parsed = parse_members(members, {"gloss=0.1", "gloss=0.2", "balls.gloss=0.3"});
  ASSERT_TRUE(parsed.scene) << parsed.diagnostics.text();
  EXPECT_EQ(find(parsed.scene->objects[0], "gloss")->value.number, 0.3f);
}

TEST(Settings, ReplaceAParameterOfAPost) {
  const std::string posts = std::string(members) + R"(,
    "posts": [{"name": "fog", "effect": "e.json", "parameters": {"density": 1}},
              {"name": "tone", "effect": "e.json", "parameters": {"gloss": 2}}])";
  const ParsedScene parsed = parse_members(posts, {"fog.density=0.25", "density=0.5", "tone.gloss=3"});
  ASSERT_TRUE(parsed.scene) << parsed.diagnostics.text();
  EXPECT_EQ(parsed.scene->posts[0].parameters[0].value.number, 0.5f);
  EXPECT_EQ(parsed.scene->posts[1].parameters[0].value.number, 3.0f);
  EXPECT_EQ(find(parsed.scene->objects[0], "gloss")->value.number, 0.5f);
  EXPECT_TRUE(
      parse_members(posts, {"fog.glow=1"}).fails_with("the effect of \"fog\" has no parameter \"glow\""));
  EXPECT_TRUE(parse_members(posts, {"gloss=1"}).fails_with("2 objects or posts have a parameter \"gloss\""));
}

TEST(Settings, ReplaceValuesOfCameraLightsOutputAndScene) {
  const ParsedScene parsed =
      parse_members(members, {"camera.fov=30", "camera.position=1,2,3", "sun.intensity=4",
                              "output.encoding=linear", "background=[1, 0, 0, 1]", "size=64,32"});
  ASSERT_TRUE(parsed.scene) << parsed.diagnostics.text();
  EXPECT_EQ(parsed.scene->camera.fov, 30.0f);
  EXPECT_EQ(parsed.scene->camera.position, glm::vec3(1, 2, 3));
  EXPECT_EQ(parsed.scene->lights[0].intensity, 4.0f);
  EXPECT_EQ(parsed.scene->output.encoding, scene::Encoding::linear);
  EXPECT_EQ(parsed.scene->background[0], 1.0f);
  EXPECT_EQ(parsed.scene->width, 64);
}

TEST(Settings, SetParametersThatOnlyTheEffectDeclares) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "isoshade_settings";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "e.json") << R"({"isoshade": 1, "effect": "e", "parameters": {"sheen": {}}})";
  testing::ParsedScene parsed;
  const auto document =
      testing::document_of(testing::scene_text(R"("objects": {"bare": {"mesh": "box", "effect": "e.json"}})"),
                           parsed.diagnostics, (folder / "scene.json").string());
  for (const char* setting : {"bare.sheen=1", "sheen=1"}) {
    graph::Document changed = *document;
    ASSERT_TRUE(scene::apply_settings(changed, {setting}, {}, parsed.diagnostics)) << parsed.diagnostics.text();
    const auto scene = scene::parse_scene(changed, parsed.diagnostics);
    ASSERT_TRUE(scene) << parsed.diagnostics.text();
    EXPECT_EQ(find(scene->objects[0], "sheen")->value.number, 1.0f);
  }
  std::filesystem::remove_all(folder);
}

TEST(Settings, SuggestTheNearestName) {
  const auto text = [](const std::string& setting) {
    return parse_members(members, {setting}).diagnostics.text();
  };
  EXPECT_NE(text("bals.metallic=1").find("\"balls\""), std::string::npos) << text("bals.metallic=1");
  EXPECT_NE(text("balls.metalic=1").find("\"metallic\""), std::string::npos) << text("balls.metalic=1");
  EXPECT_NE(text("glos=1").find("\"gloss\""), std::string::npos) << text("glos=1");
  EXPECT_NE(text("metallic=1").find("--set balls.metallic=1"), std::string::npos) << text("metallic=1");
  EXPECT_NE(text("camera.fvo=1").find("\"fov\""), std::string::npos) << text("camera.fvo=1");
}

TEST(Settings, RejectMalformedSettings) {
  for (const char* setting :
       {"", "balls", "=", "balls.=1", ".metallic=1", "balls.metallic", "balls.metallic=", "a.b.c=1",
        "balls.metallic=1\"", "balls.metallic={\"a\"", "balls.metallic=\x01", "balls.metallic=[1, 2"}) {
    EXPECT_TRUE(parse_members(members, {setting}).fails_with("bad-setting")) << setting;
  }
}

TEST(Settings, CannotInjectJson) {
  EXPECT_FALSE(parse_members(members, {R"(balls.metallic=1, "gloss": 2)"}).scene);
  EXPECT_FALSE(parse_members(members, {"balls.metallic=1}, \"x\": {"}).scene);
}

TEST(Settings, ErrorsPointIntoTheirText) {
  EXPECT_EQ(parse_members(members, {"camera.fov=30", "camera.fov= 200"}).diagnostics.text(),
            "--set:1:13: error[out-of-range]: \"fov\" of the camera must be from 0.01 to 179\n"
            "  1 | camera.fov= 200\n"
            "    |             ^^^\n");
  EXPECT_EQ(parse_members(members, {"sun.color=1,2"}).diagnostics.text(),
            "--set:1:11: error[wrong-type]: \"color\" of light \"sun\" must be an array of 3 numbers, not of 2\n"
            "  1 | sun.color=[1,2]\n"
            "    |           ^^^^^\n");
  EXPECT_EQ(parse_members(members, {"sun.colour=1"}).diagnostics.all()[0].where.begin, 4u);
}

TEST(Settings, RejectAByteOrderMarkBeforeAValue) {
  EXPECT_TRUE(parse_members(members, {"camera.fov=\xef\xbb\xbf"
                                      "30"})
                  .fails_with("bad-setting"));
}

}  // namespace
}  // namespace isoshade
