// SPDX-License-Identifier: Apache-2.0
// What is left out of lights and frames changes no bit, is left out where it can be, and only there.
#include <algorithm>
#include <cmath>

#include "compiler/lower/frame_layout.h"
#include "tests/equivalence/scene_folder.h"

namespace isoshade::equivalence {
namespace {

using interface::Skip;

/// A scene beside the shipped ones.
scene::Scene scene_of(const std::string& members) {
  return load(std::make_shared<support::SourceFile>(ISOSHADE_GRAPHS "/scenes/skips.json",
                                                    isoshade::testing::scene_text(members)));
}

render::PlanOptions options_of(check::Library& library, int width, int height, interface::Skips skips) {
  render::PlanOptions options;
  options.width = width;
  options.height = height;
  options.compiler.library = &library;
  options.compiler.skips = skips;
  return options;
}

interface::Skips without(Skip skip) {
  interface::Skips skips;
  skips.set(skip, false);
  return skips;
}

/// Expects that the scene has the same bits without the skip; returns how many lights were left out.
int64_t left_out(const scene::Scene& scene, Size size = {61, 43}) {
  check::Library library(ISOSHADE_GRAPHS "/library");
  support::Diagnostics diagnostics;
  const auto with = render::plan_frame(scene, options_of(library, size.width, size.height, {}), diagnostics);
  const auto all = render::plan_frame(
      scene, options_of(library, size.width, size.height, without(Skip::lights)), diagnostics);
  if (!with || !all) {
    ADD_FAILURE() << diagnostics.text();
    return 0;
  }
  EXPECT_EQ(all->stats.left_out_lights, 0);
  for (const auto& backend : every_backend())
    expect_identical(draw(*all, *backend), draw(*with, *backend), std::string(backend->name()));
  return with->stats.left_out_lights;
}

const std::string camera = R"("camera": {"position": [0, 3, 9], "target": [0, 0, 0], "fov": 40},
  "background": [0.01, 0.02, 0.03, 1])";

/// A row of balls, and a floor.
std::string balls(const std::string& effect) {
  return R"("objects": {
    "balls": {"mesh": {"type": "sphere", "radius": 0.5, "segments": 24, "rings": 12}, "effect": ")" +
         effect + R"(",
              "transform": {"translate": [-3, 0, 0]}, "repeat": [{"count": 4, "step": [2, 0, 0]}]},
    "floor": {"mesh": {"type": "plane", "size": [12, 6], "segments": 4}, "effect": "../materials/cook_torrance.json",
              "transform": {"translate": [0, -0.5, 0]}}})";
}

/// Lamps over the balls, each of which reaches only some of them; a spot that shines past them, and one on one of them.
const std::string lamps = R"("lights": {
    "sun": {"type": "directional", "direction": [0.4, -1, -0.5], "intensity": 0.2},
    "off": {"type": "directional", "direction": [0, -1, 0], "intensity": 0},
    "black": {"type": "point", "position": [0, 1, 1], "color": [0, 0, 0], "intensity": 4},
    "left": {"type": "point", "position": [-3, 1.2, 1], "color": [1, 0.5, 0.2], "intensity": 4, "range": 2},
    "right": {"type": "point", "position": [3, 1.2, 1], "color": [0.3, 0.5, 1], "intensity": 4, "range": 2.5},
    "away": {"type": "spot", "position": [0, 2, 2], "direction": [0, 1, 1], "intensity": 9, "outer_angle": 30},
    "on": {"type": "spot", "position": [1, 3, 0], "direction": [0, -1, 0], "intensity": 9, "inner_angle": 5,
           "outer_angle": 12}})";

TEST(Lights, ThatDoNotReachAnObjectAreLeftOut) {
  for (const char* effect : {"../materials/cook_torrance.json", "../effects/cartoon.json"}) {
    const int64_t count = left_out(scene_of(camera + ",\n" + lamps + ",\n" + balls(effect)));
    // For each ball at least the two that are black and the one that shines past all.
    EXPECT_GE(count, 4 * 3 + 3) << effect;
    EXPECT_LT(count, 5 * 6) << effect;
  }
}

TEST(Lights, AreLeftOutOfMaterialsWithNormalMaps) {
  EXPECT_GE(left_out(scene_of(camera + ",\n" + lamps + ",\n" + balls("../materials/gltf_pbr.json"))),
            4 * 3 + 3);
}

TEST(Lights, WhoseShadowsFallElsewhereKeepThem) {
  std::string shadows = lamps;
  for (size_t at = 0; (at = shadows.find("\"intensity\": 9", at)) != std::string::npos; at += 40)
    shadows.insert(at, "\"shadow\": {\"size\": 64}, ");
  EXPECT_GT(left_out(scene_of(camera + ",\n" + shadows + ",\n" + balls("../materials/cook_torrance.json"))),
            0);
}

/// Where a lamp ends just before and just behind the corner of a box.
TEST(Lights, ThatReachACornerStay) {
  const auto lamp = [](const std::string& range) {
    return scene_of(R"("camera": {"position": [2, 3, 6], "target": [0, 0, 0], "fov": 30},
      "lights": {"lamp": {"type": "point", "position": [2, 2, 2], "intensity": 1e6, "range": )" +
                    range + R"(}},
      "objects": {"box": {"mesh": {"type": "box", "size": [2, 2, 2]}, "effect": "../materials/cook_torrance.json",
                          "parameters": {"ambient": 0}}})");
  };
  EXPECT_EQ(left_out(lamp("1.7321"), {200, 150}), 0);  // the corner is 1.73205 away
  EXPECT_EQ(left_out(lamp("1.732051"), {200, 150}), 0);
  EXPECT_EQ(left_out(lamp("1.73")), 1);
}

class LightsOf : public SceneFolder {
 protected:
  /// How many lights are left out of a picture with this node of its effect as the term of the sum.
  int64_t left_out_of(const std::string& nodes,
                      const std::string& sum = R"({"type": "sum_lights", "in": "term"})") {
    folder_.write("effect.json", R"({"isoshade": 1, "effect": "effect",
      "parameters": {"steep": {"type": "float", "value": 2, "min": 0, "max": 8}},
      "nodes": {"c": {"type": "lightcolor"}, "l": {"type": "lightdirection"}, "n": {"type": "normal"},
        "p": {"type": "position"}, "v": {"type": "viewdirection"}, )" +
                                     nodes + R"(, "sum": )" + sum + R"(},
      "passes": [{"name": "base", "color": "sum"}]})");
    const std::string members = camera + ",\n" + lamps + R"(, "objects": {
      "ball": {"mesh": {"type": "sphere", "segments": 16, "rings": 8}, "effect": "effect.json"}})";
    const render::Plan all = plan({40, 30}, 1, members, false), with = plan({40, 30}, 1, members);
    for (const auto& backend : every_backend())
      expect_identical(draw(all, *backend), draw(with, *backend),
                       nodes + " on " + std::string(backend->name()));
    return with.stats.left_out_lights;
  }
};

TEST_F(LightsOf, EffectsThatMultiplyByTheColourAreLeftOut) {
  EXPECT_GT(
      left_out_of(
          R"json("term": {"type": "expression", "code": "c * max(dot(n, l), 0)", "c": "c", "n": "n", "l": "l"})json"),
      0);
  EXPECT_GT(
      left_out_of(
          R"json("term": {"type": "expression", "code": "c * pow(saturate(dot(n, l)), steep) * dot(n, v)",
                            "c": "c", "n": "n", "l": "l", "v": "v", "steep": "steep"})json"),
      0);
}

TEST_F(LightsOf, EffectsThatMakeLightOfBlackLightsAreLeftOut) {
  // A step of a ramp that would be lit without light.
  EXPECT_GT(left_out_of(R"json("term": {"type": "expression", "code": "max(c, color3(0.1))", "c": "c"})json"), 0);
  // Terms that may be infinite or NaN.
  EXPECT_GT(
      left_out_of(
          R"json("term": {"type": "expression", "code": "c / dot(n, l)", "c": "c", "n": "n", "l": "l"})json"),
      0);
  EXPECT_GT(left_out_of(R"json("w": {"type": "fwidth", "in": "n"},
                            "term": {"type": "expression", "code": "c / w.x", "c": "c", "w": "w"})json"),
            0);
}

// A sum of -0 stays one, as every light that is added would make it +0.
TEST_F(LightsOf, EffectsThatSumUpLessThanAFloatHoldsAreLeftOut) {
  EXPECT_GT(left_out_of(R"json("term": {"type": "expression", "code": "c * -1e-38", "c": "c"})json",
                        R"json({"type": "expression", "code": "color3(1) / light", "light": "tiny"})json" +
                            std::string(R"json(, "tiny": {"type": "sum_lights", "in": "term"})json")),
            0);
}

TEST_F(LightsOf, EffectsThatDifferentiateTheSumAreLeftOut) {
  const std::string term =
      R"json("term": {"type": "expression", "code": "c * max(dot(n, l), 0)", "c": "c", "n": "n", "l": "l"},
    "light": {"type": "sum_lights", "in": "term"}, "w": {"type": "fwidth", "in": "light"})json";
  EXPECT_GT(left_out_of(term, R"json({"type": "add", "in1": "light", "in2": "w"})json"), 0);
}

TEST_F(LightsOf, EffectsThatDoNotReadTheColourStay) {
  EXPECT_EQ(
      left_out_of(
          R"json("term": {"type": "expression", "code": "color3(max(dot(n, l), 0))", "n": "n", "l": "l"})json"),
      0);
  // One sum that does not is enough.
  EXPECT_EQ(left_out_of(R"json("facing": {"type": "dotproduct", "in1": "n", "in2": "l"},
    "all": {"type": "sum_lights", "in": "facing"},
    "term": {"type": "expression", "code": "c * all", "c": "c", "all": "all"})json"),
            0);
}

/// Draws frames one after the other with one renderer, with the skip and without, and counts what was kept.
class Frames : public ::testing::Test {
 protected:
  struct Kept {
    int64_t frames = 0, views = 0;
  };
  Kept draw_all(const std::vector<scene::Scene>& scenes, backends::Backend& backend) {
    check::Library library(ISOSHADE_GRAPHS "/library");
    render::FramePlanner planner(options_of(library, 57, 41, {}));
    render::Renderer renderer(backend);
    Kept kept;
    for (size_t i = 0; i < scenes.size(); ++i) {
      support::Diagnostics diagnostics;
      const render::Plan* plan = planner.plan(scenes[i], diagnostics);
      render::DrawStats stats;
      EXPECT_TRUE(plan != nullptr && renderer.draw(*plan, stats, diagnostics)) << diagnostics.text();
      kept.frames += stats.is_kept ? 1 : 0;
      kept.views += stats.kept_views;
      const scene::ImageView image = renderer.image();
      backends::Image shown{image.width,
                            image.height,
                            {image.rgba.begin(), image.rgba.end()},
                            {image.depth.begin(), image.depth.end()}};
      const auto alone =
          render::plan_frame(scenes[i], options_of(library, 57, 41, interface::Skips::none()), diagnostics);
      expect_identical(draw(*alone, *fresh_), shown,
                       "frame " + std::to_string(i) + " on " + std::string(backend.name()));
    }
    return kept;
  }
  /// On every backend, which all keep the same.
  Kept draw_all(const std::vector<scene::Scene>& scenes) {
    std::optional<Kept> kept;
    for (const auto& backend : every_backend()) {
      const Kept here = draw_all(scenes, *backend);
      EXPECT_TRUE(!kept || (kept->frames == here.frames && kept->views == here.views)) << backend->name();
      kept = here;
    }
    return *kept;
  }

  std::unique_ptr<backends::Backend> fresh_ = interpreter::create();
};

const std::string lamp_with_shadow = R"("lights": {
  "lamp": {"type": "point", "position": [0, 3, 1], "intensity": 30, "shadow": {"size": 64}}})";

TEST_F(Frames, ThatAreAsTheOneBeforeAreKept) {
  std::vector<scene::Scene> scenes(
      4, scene_of(camera + ",\n" + lamp_with_shadow + ",\n" + balls("../effects/cartoon.json")));
  for (size_t i = 0; i < scenes.size(); ++i) scenes[i].time = static_cast<float>(i);  // nothing reads it
  EXPECT_EQ(draw_all(scenes).frames, 3);
}

TEST_F(Frames, KeepShadowMapsWhileOnlyTheCameraMoves) {
  std::vector<scene::Scene> scenes(
      3, scene_of(camera + ",\n" + lamp_with_shadow + ",\n" + balls("../materials/cook_torrance.json")));
  for (size_t i = 0; i < scenes.size(); ++i) scenes[i].camera.position.x = static_cast<float>(i);
  const Kept kept = draw_all(scenes);
  EXPECT_EQ(kept.frames, 0);
  EXPECT_EQ(kept.views, 2 * 6);  // the lamp has six
}

TEST_F(Frames, OfObjectsOrLightsThatMoveAreDrawn) {
  std::vector<scene::Scene> scenes(
      3, scene_of(camera + ",\n" + lamp_with_shadow + ",\n" + balls("../materials/cook_torrance.json")));
  for (size_t i = 0; i < scenes.size(); ++i)
    scenes[i].objects[0].transform.translate.y = 0.25f * static_cast<float>(i);
  EXPECT_EQ(draw_all(scenes).views, 0);
  std::vector<scene::Scene> lit(
      3, scene_of(camera + ",\n" + lamps + ",\n" + balls("../materials/cook_torrance.json")));
  for (size_t i = 0; i < lit.size(); ++i) lit[i].lights[3].position.x = static_cast<float>(i);
  EXPECT_EQ(draw_all(lit).views, 0);
}

TEST_F(Frames, WhoseTimeAPostReadsAreDrawnAgainBehindThePicture) {
  // It reads pixels beside its own, and so runs behind the picture.
  isoshade::testing::TemporaryFolder folder;
  folder.write("pulse.json", R"json({"isoshade": 1, "post": "pulse", "nodes": {"t": {"type": "time"},
    "c": {"type": "scenecolor", "offsetx": 1}, "s": {"type": "expression", "code": "c * fract(t)", "c": "c", "t": "t"}},
    "outputs": {"color": "s"}})json");
  support::Diagnostics diagnostics;
  const auto document = isoshade::testing::document_of(
      isoshade::testing::scene_text(R"("lights": {"sun": {"type": "directional", "direction": [0, -1, -1]}},
        "objects": {"ball": {"mesh": "sphere", "effect": "flat.json"}}, "posts": [{"name": "pulse", "effect": "pulse.json"}])"),
      diagnostics, (folder.path() / "scene.json").string());
  std::filesystem::copy(ISOSHADE_GRAPHS "/effects/flat.json", folder.path() / "flat.json");
  const auto scene = document ? scene::parse_scene(*document, diagnostics) : std::nullopt;
  ASSERT_TRUE(scene) << diagnostics.text();
  std::vector<scene::Scene> scenes(4, *scene);
  for (size_t i = 0; i < scenes.size(); ++i) scenes[i].time = 0.25f * static_cast<float>(i);
  scenes[3].time = scenes[2].time;
  const Kept kept = draw_all(scenes);
  EXPECT_EQ(kept.frames, 1);
  EXPECT_EQ(kept.views, 3);
}

}  // namespace
}  // namespace isoshade::equivalence
