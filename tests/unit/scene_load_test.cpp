// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

#include "compiler/graph/extend.h"
#include "runtime/scene/load.h"

namespace isoshade::scene {
namespace {

namespace fs = std::filesystem;

class LoadScene : public ::testing::Test {
 protected:
  LoadScene()
      : folder_(fs::path(::testing::TempDir()) / ("isoshade_load_scene_" + std::to_string(getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "scenes" / "base");
    write("scenes/base/base.json", R"({"isoshade": 1, "scene": "base", "time": 3, "size": [8, 8],
  "camera": {"position": [0, 0, 5], "target": [0, 0, 0], "fov": 30},
  "lights": {"sun": {"type": "spot", "position": [0, 3, 0], "direction": [0, -1, 0], "outer_angle": 20}},
  "objects": {
    "ball": {"mesh": {"type": "sphere", "radius": 2}, "effect": "e.json", "parameters": {"a": 1, "b": 2}},
    "box": {"mesh": "box", "effect": "e.json"}},
  "posts": [{"name": "fog", "effect": "fog.json"}]})");
  }
  ~LoadScene() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }

  /// A scene of these members, which stands in scenes/top.json.
  std::optional<Scene> load(const std::string& members, const std::vector<std::string>& settings = {}) {
    write("scenes/top.json", R"({"isoshade": 1, "scene": "top", )" + members + "}");
    diagnostics_ = support::Diagnostics();
    const auto source = graph::read_source((folder_ / "scenes/top.json").string(), diagnostics_);
    return load_scene(source, settings, {"", false}, diagnostics_);
  }
  /// "id: message" of the first error.
  std::string error(const std::string& members, const std::vector<std::string>& settings = {}) {
    if (load(members, settings)) return "";
    const support::Diagnostic& first = diagnostics_.all().front();
    return std::string(support::id_text(first.id)) + ": " + first.message;
  }

  fs::path folder_;
  support::Diagnostics diagnostics_;
};

TEST_F(LoadScene, ExtendsAnotherScene) {
  const auto scene = load(R"("extends": "base/base.json", "size": [4, 4], "camera": {"fov": 60},
      "lights": {"sun": {"outer_angle": 25}},
      "objects": {"box": null, "ball": {"parameters": {"a": 5, "b": null, "c": 6}},
                  "floor": {"mesh": "plane", "effect": "e.json"}})");
  ASSERT_TRUE(scene) << diagnostics_.text();
  EXPECT_EQ(scene->name, "top");
  EXPECT_EQ(scene->time, 3.0f);
  EXPECT_EQ(scene->width, 4);
  EXPECT_EQ(scene->camera.fov, 60.0f);
  EXPECT_EQ(scene->camera.position.z, 5.0f);
  EXPECT_EQ(scene->lights[0].outer_angle, 25.0f);
  ASSERT_EQ(scene->objects.size(), 2u);
  const Object& ball = scene->objects[0];
  EXPECT_EQ(ball.mesh.size.x, 2.0f);
  ASSERT_EQ(ball.parameters.size(), 2u);
  EXPECT_EQ(ball.parameters[0].value.number, 5.0f);
  EXPECT_EQ(ball.parameters[1].name, "c");
  EXPECT_EQ(scene->posts.size(), 1u);
}

TEST_F(LoadScene, PathsAreRelativeToTheFileThatContainsThem) {
  const auto scene = load(R"("extends": "base/base.json",
      "objects": {"floor": {"mesh": "plane", "effect": "e.json"}})");
  ASSERT_TRUE(scene) << diagnostics_.text();
  EXPECT_EQ(scene->objects[0].effect, (folder_ / "scenes/base/e.json").string());
  EXPECT_EQ(scene->objects[2].effect, (folder_ / "scenes/e.json").string());
  EXPECT_EQ(scene->posts[0].effect, (folder_ / "scenes/base/fog.json").string());
}

TEST_F(LoadScene, ExtendsASceneThatExtendsAnother) {
  write("scenes/middle.json",
        R"({"isoshade": 1, "scene": "m", "extends": "base/base.json", "time": 4, "posts": []})");
  const auto scene = load(R"("extends": "middle.json", "size": [2, 2])");
  ASSERT_TRUE(scene) << diagnostics_.text();
  EXPECT_EQ(scene->time, 4.0f);
  EXPECT_EQ(scene->width, 2);
  EXPECT_TRUE(scene->posts.empty());
  EXPECT_EQ(scene->objects.size(), 2u);
}

TEST_F(LoadScene, SettingsApplyToTheExtendedScene) {
  const auto scene =
      load(R"("extends": "base/base.json")", {"ball.a=7", "sun.outer_angle=30", "camera.fov=45"});
  ASSERT_TRUE(scene) << diagnostics_.text();
  EXPECT_EQ(scene->objects[0].parameters[0].value.number, 7.0f);
  EXPECT_EQ(scene->lights[0].outer_angle, 30.0f);
  EXPECT_EQ(scene->camera.fov, 45.0f);
}

TEST_F(LoadScene, ErrorsPointIntoTheirFile) {
  error(R"("extends": "base/base.json", "camera": {"fov": 0})");
  EXPECT_EQ(diagnostics_.all()[0].where.file->path(), (folder_ / "scenes/top.json").string());
  write("scenes/base/base.json", "{\"isoshade\": 1, \"scene\": \"b\",\n\"camera\": {\"position\": [0, 1]}}");
  error(R"("extends": "base/base.json", "time": 1)");
  EXPECT_EQ(diagnostics_.all()[0].where.file->path(), (folder_ / "scenes/base/base.json").string());
  EXPECT_EQ(diagnostics_.all()[0].where.line(), 2u);
}

TEST_F(LoadScene, RefusesToExtendOtherDocuments) {
  write("scenes/effect.json", R"({"isoshade": 1, "effect": "e"})");
  write("scenes/self.json", R"({"isoshade": 1, "scene": "s", "extends": "top.json"})");
  write("outside.json", R"({"isoshade": 1, "scene": "s"})");
  EXPECT_EQ(error(R"("extends": 1)"), "wrong-type: \"extends\" must be the path of a scene, not a number");
  EXPECT_NE(error(R"("extends": "effect.json")").find("wrong-kind: "), std::string::npos);
  EXPECT_NE(error(R"("extends": "none.json")").find("missing-file: "), std::string::npos);
  EXPECT_NE(error(R"("extends": "base")").find("unreadable-file: "), std::string::npos);
  EXPECT_NE(error(R"("extends": "self.json")").find("recursion: the scene extends itself"),
            std::string::npos);
  EXPECT_NE(error(R"("extends": "top.json")").find("recursion: the scene extends itself"), std::string::npos);
  EXPECT_NE(error(R"("extends": "../outside.json")").find("outside-reference: "), std::string::npos);
}

TEST_F(LoadScene, AnExtendingSceneNeedsTheKeysOfADocument) {
  const auto first_error = [&](const std::string& text) {
    write("scenes/part.json", text);
    return error(R"("extends": "part.json")");
  };
  EXPECT_EQ(first_error(R"({"scene": "s", "extends": "base/base.json"})"),
            "missing-key: the document has no version");
  EXPECT_EQ(first_error(R"({"isoshade": 1, "extends": "base/base.json"})"),
            "wrong-kind: a document must be a function, effect, post, scene or image");
  EXPECT_NE(first_error(R"({"isoshade": 1, "post": "p", "extends": "base/base.json"})").find("is not a scene"),
            std::string::npos);
}

TEST_F(LoadScene, SuggestsExtendsForMisspelledKeys) {
  load(R"("extend": "base/base.json")");
  EXPECT_NE(diagnostics_.text().find("did you mean \"extends\"?"), std::string::npos) << diagnostics_.text();
}

TEST_F(LoadScene, AllowsChainsOfSixteenScenes) {
  // The scene of each number ends a chain of so many.
  write("scenes/s2.json", R"({"isoshade": 1, "scene": "s", "extends": "base/base.json"})");
  for (size_t i = 3; i <= graph::max_chain; ++i) {
    write("scenes/s" + std::to_string(i) + ".json",
          R"({"isoshade": 1, "scene": "s", "extends": "s)" + std::to_string(i - 1) + R"(.json"})");
  }
  const auto on = [](size_t last) { return R"("extends": "s)" + std::to_string(last) + R"(.json")"; };
  EXPECT_EQ(error(on(graph::max_chain - 1)), "");
  EXPECT_EQ(error(on(graph::max_chain)), "too-large: more than 16 scenes extend each other");
}

}  // namespace
}  // namespace isoshade::scene
