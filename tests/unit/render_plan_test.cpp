// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

#include "backends/interpreter/backend.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/compare/compare.h"
#include "runtime/render/plan.h"
#include "runtime/render/render.h"
#include "tests/unit/gltf_files.h"
#include "tests/unit/scene_documents.h"

namespace isoshade {
namespace {

namespace fs = std::filesystem;
namespace word = lower::object_word;

/// Scenes beside an effect of a few parameters, in a folder of their own.
class PlanTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("isoshade_plan" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    write("tinted.json", R"({"isoshade": 1, "effect": "tinted",
      "parameters": {"tint": {"type": "color3", "value": [0.25, 0.5, 0.75]},
                     "gain": {"type": "float", "value": 2},
                     "bright": {"type": "boolean", "value": false},
                     "steps": {"type": "integer", "value": 3}},
      "nodes": {"n": {"type": "normal"}, "up": {"type": "multiply", "in1": "n.y", "in2": "gain"},
                "color": {"type": "multiply", "in1": "tint", "in2": "up"}},
      "passes": [{"name": "base", "color": "color"}]})");
    write("twice.json", R"({"isoshade": 1, "effect": "twice",
      "parameters": {"tint": {"type": "color3", "value": [1, 1, 1]}},
      "nodes": {"half": {"type": "multiply", "in1": "tint", "in2": 0.5}},
      "passes": [{"name": "back", "cull": "front", "color": "half"}, {"name": "front", "color": "tint"}]})");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  std::optional<scene::Scene> parse(const std::string& members) {
    const auto document =
        testing::document_of(testing::scene_text(members), diagnostics_, (folder_ / "scene.json").string());
    return document ? scene::parse_scene(*document, diagnostics_) : std::nullopt;
  }

  std::optional<render::Plan> plan(const std::string& members) {
    scene_ = parse(members);
    EXPECT_TRUE(scene_) << diagnostics_.text();
    if (!scene_) return std::nullopt;
    options_.compiler.library = &library_;
    options_.compiler.skips.set(interface::Skip::parameters, false);  // the tests count what is skipped
    return render::plan_frame(*scene_, options_, diagnostics_);
  }

  bool planning_fails_with(const std::string& members, const std::string& part) {
    diagnostics_ = support::Diagnostics();
    return !plan(members) && diagnostics_.text().find(part) != std::string::npos;
  }

  const float* record(const render::Plan& plan, size_t draw) const {
    return &plan.frame.objects[static_cast<size_t>(plan.frame.picture().draws[draw].object)];
  }

  fs::path folder_;
  check::Library library_;
  render::PlanOptions options_;
  support::Diagnostics diagnostics_;
  std::optional<scene::Scene> scene_;
};

TEST_F(PlanTest, SceneParametersOverrideDefaults) {
  const auto made = plan(R"("objects": {
    "plain": {"mesh": "box", "effect": "tinted.json"},
    "set": {"mesh": "box", "effect": "tinted.json",
            "parameters": {"gain": 0.5, "bright": true, "steps": 7, "tint": [1, 0, 1e-40]}}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  ASSERT_EQ(made->frame.picture().draws.size(), 2u);
  const auto words = [&](size_t draw) {
    const float* first = record(*made, draw) + word::parameters;
    return std::vector<float>(first, first + 6);
  };
  EXPECT_EQ(words(0), (std::vector<float>{0.25f, 0.5f, 0.75f, 2, 0, 3}));
  EXPECT_EQ(words(1), (std::vector<float>{1, 0, 0, 0.5f, 1, 7}));
}

TEST_F(PlanTest, GridsVaryParametersAndPositions) {
  const auto made = plan(R"("objects": {"grid": {"mesh": "box", "effect": "tinted.json",
    "transform": {"scale": 0.1},
    "repeat": [{"count": 3, "step": [0.5, 0, 0], "parameters": {"gain": {"from": 1, "to": 2}}},
               {"count": 2, "step": [0, -0.5, 0], "parameters": {
                 "tint": {"values": [[1, 0, 0], [0, 1, 0]]}}}]}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  ASSERT_EQ(made->frame.picture().draws.size(), 6u);
  const float* last = record(*made, 5);
  EXPECT_EQ(last[word::model + 9], 1.0f);
  EXPECT_EQ(last[word::model + 10], -0.5f);
  EXPECT_EQ(last[word::parameters + 1], 1.0f);
  EXPECT_EQ(last[word::parameters + 3], 2.0f);
  EXPECT_EQ(record(*made, 1)[word::parameters + 3], 1.5f);
  EXPECT_EQ(made->meshes.size(), 1u);
}

TEST_F(PlanTest, EqualMeshesEffectsAndProgramsAreShared) {
  const auto made = plan(R"("objects": {
    "a": {"mesh": "sphere", "effect": "tinted.json"},
    "b": {"mesh": {"type": "sphere"}, "effect": "./tinted.json"},
    "c": {"mesh": "box", "effect": "twice.json"}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(made->meshes.size(), 2u);
  EXPECT_EQ(made->effects.size(), 2u);
  ASSERT_EQ(made->frame.picture().draws.size(), 4u);
  // One vertex program; two of the three pixel programs do no more than load a color that the draw computes.
  EXPECT_EQ(made->frame.programs.size(), 3u);
  EXPECT_EQ(made->frame.picture().draws[0].first_vertex, made->frame.picture().draws[1].first_vertex);
  for (const backends::Draw& draw : made->frame.picture().draws) {
    EXPECT_EQ(made->frame.programs[draw.vertex_program]->stage, lower::Stage::vertex);
    EXPECT_EQ(made->frame.programs[draw.pixel_program]->stage, lower::Stage::pixel);
  }
  EXPECT_EQ(record(*made, 3)[word::program],
            static_cast<float>(made->frame.picture().draws[3].pixel_program));
}

TEST_F(PlanTest, MovedPlanKeepsItsPointersValid) {
  auto made = plan(R"("objects": {"a": {"mesh": "sphere", "effect": "tinted.json"}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  const render::Plan moved = std::move(*made);
  made.reset();
  EXPECT_EQ(moved.frame.picture().draws[0].indices.data(), moved.meshes[0].parts[0].indices.data());
  EXPECT_EQ(moved.frame.programs[0], &moved.effects[0].passes[0].vertex);
}

TEST_F(PlanTest, MirroringIsNotedAtTheDraws) {
  const auto made = plan(R"("objects": {
    "a": {"mesh": "box", "effect": "twice.json", "transform": {"scale": [1, -1, 1]}},
    "b": {"mesh": "box", "effect": "twice.json", "transform": {"scale": [-1, -1, 1]}}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  const std::vector<backends::Draw>& draws = made->frame.picture().draws;
  EXPECT_EQ(draws[0].state.cull, interface::Cull::front);
  EXPECT_EQ(draws[1].state.cull, interface::Cull::back);
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(draws[i].mirrored, i < 2) << i;  // two factors mirror nothing
}

TEST_F(PlanTest, ParametersSwitchCutOutsAndCullingOfEachDraw) {
  write("leaf.json", R"({"isoshade": 1, "effect": "leaf",
    "parameters": {"cutoff": {"type": "float", "value": 0.5}, "both": {"type": "boolean", "value": false}},
    "nodes": {"uv": {"type": "texcoord"}},
    "passes": [{"name": "base", "cutout": "uv.x", "cutoff": "cutoff", "double_sided": "both", "color": [1, 1, 1]},
               {"name": "plain", "color": [1, 1, 1]}]})");
  const auto made = plan(R"("objects": {
    "cut": {"mesh": "box", "effect": "leaf.json"},
    "whole": {"mesh": "box", "effect": "leaf.json", "parameters": {"cutoff": 0, "both": true}}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  const std::vector<backends::Draw>& draws = made->frame.picture().draws;
  ASSERT_EQ(draws.size(), 4u);
  EXPECT_TRUE(draws[0].cutout);
  EXPECT_EQ(draws[0].state.cull, interface::Cull::back);
  EXPECT_FALSE(draws[1].cutout);
  EXPECT_FALSE(draws[2].cutout);
  EXPECT_EQ(draws[2].state.cull, interface::Cull::none);
  EXPECT_EQ(draws[3].state.cull, interface::Cull::back);
  // The colours are the same, but only one of the passes has a cut-out.
  EXPECT_NE(draws[0].pixel_program, draws[1].pixel_program);
  ASSERT_GT(made->frame.cutouts.size(), draws[0].pixel_program);
  EXPECT_EQ(made->frame.programs[made->frame.cutouts[draws[0].pixel_program]]->stage, lower::Stage::cutout);
  EXPECT_EQ(made->frame.cutouts[draws[1].pixel_program], backends::Frame::no_program);
  ASSERT_EQ(made->stats.skips.size(), 1u);
  EXPECT_EQ(made->stats.skips[0].reason, "cutoff is not above 0");
}

TEST_F(PlanTest, ReportsUnknownAndMistypedParameters) {
  const auto object = [](const std::string& parameters) {
    return R"("objects": {"a": {"mesh": "box", "effect": "tinted.json", "parameters": {)" + parameters +
           "}}}";
  };
  EXPECT_TRUE(planning_fails_with(object(R"("tnit": [1, 1, 1])"), "did you mean \"tint\""));
  EXPECT_TRUE(planning_fails_with(object(R"("tint": 1)"), "an array of 3 numbers"));
  EXPECT_TRUE(planning_fails_with(object(R"("gain": "big")"), "of type float"));
  EXPECT_TRUE(planning_fails_with(object(R"("bright": 1)"), "of type boolean"));
  EXPECT_TRUE(planning_fails_with(object(R"("steps": 1.5)"), "of type integer"));
  EXPECT_TRUE(planning_fails_with(R"("objects": {"a": {"mesh": "box", "effect": "tinted.json",
    "repeat": [{"count": 2, "step": [1, 0, 0], "parameters": {"gian": {"from": 0, "to": 1}}}]}})",
                                  "\"gain\""));
  EXPECT_TRUE(planning_fails_with(R"("objects": {"a": {"mesh": "box", "effect": "tinted.json",
    "repeat": [{"count": 2, "step": [1, 0, 0], "parameters": {"steps": {"from": 0, "to": 1}}}]}})",
                                  "list its values"));
}

TEST_F(PlanTest, EnumValuesMayBeNamesOrNumbers) {
  write("named.json", R"({"isoshade": 1, "effect": "named",
    "parameters": {"mode": {"type": "integer", "enum": ["plain", "odd", "wide"], "value": "odd"}},
    "nodes": {"f": {"type": "convert", "in": "mode", "to": "color3"}}, "passes": [{"name": "p", "color": "f"}]})");
  const auto made = plan(R"("objects": {
    "a": {"mesh": "box", "effect": "named.json"},
    "b": {"mesh": "box", "effect": "named.json", "parameters": {"mode": "wide"}},
    "c": {"mesh": "box", "effect": "named.json", "parameters": {"mode": 0}},
    "d": {"mesh": "box", "effect": "named.json",
          "repeat": [{"count": 2, "step": [0.1, 0, 0], "parameters": {"mode": {"values": ["wide", 1]}}}]}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  const std::vector<float> expected{1, 2, 0, 2, 1};
  for (size_t draw = 0; draw < expected.size(); ++draw)
    EXPECT_EQ(record(*made, draw)[word::parameters], expected[draw]) << draw;
  const auto object = [](const std::string& value) {
    return R"("objects": {"a": {"mesh": "box", "effect": "named.json", "parameters": {"mode": )" + value +
           "}}}";
  };
  EXPECT_TRUE(
      planning_fails_with(object("\"wid\""), "error[unknown-choice]: no value of the parameter \"mode\""));
  EXPECT_NE(diagnostics_.text().find("did you mean \"wide\"?"), std::string::npos);
  EXPECT_NE(diagnostics_.text().find("it is 0 (plain), 1 (odd) or 2 (wide)"), std::string::npos);
  EXPECT_TRUE(planning_fails_with(object("\"zzzzzz\""), "it is 0 (plain), 1 (odd) or 2 (wide)"));
  EXPECT_TRUE(planning_fails_with(object("3"), "error[out-of-range]: the parameter \"mode\" has no value 3"));
  EXPECT_NE(diagnostics_.text().find("it is 0 (plain), 1 (odd) or 2 (wide)"), std::string::npos);
  EXPECT_TRUE(planning_fails_with(
      object("0.5"), "of type integer, a whole number without fraction, or one of plain, odd, wide"));
}

TEST_F(PlanTest, EffectErrorsNameTheObject) {
  EXPECT_TRUE(planning_fails_with(R"("objects": {"ball": {"mesh": "box", "effect": "none.json"}})",
                                  "the effect of \"ball\""))
      << diagnostics_.text();
}

TEST_F(PlanTest, RejectsScenesWithTooManyTriangles) {
  EXPECT_TRUE(planning_fails_with(
      R"("objects": {"a": {"mesh": {"type": "sphere", "segments": 1024, "rings": 1024},
                           "effect": "tinted.json",
                           "repeat": [{"count": 60000, "step": [1, 0, 0]}]}})",
      "too-large"));
}

/// Pulls its vertices up by two, in the pass "lifted".
constexpr const char* lifted = R"({"isoshade": 1, "effect": "lifted",
  "parameters": {"on": {"type": "float", "value": 1}, "tint": {"type": "color3", "value": [1, 1, 1]}},
  "nodes": {"p": {"type": "position"}, "up": {"type": "constant", "value": [0, 2, 0]},
            "moved": {"type": "add", "in1": "p", "in2": "up"}},
  "passes": [{"name": "base", "color": "tint"},
             {"name": "lifted", "color": "tint", "position": "moved", "enabled": "on"}]})";

TEST_F(PlanTest, PassesAreSkippedWhereTheirParameterIsZero) {
  write("lifted.json", lifted);
  const auto made = plan(R"("objects": {
    "row": {"mesh": "box", "effect": "lifted.json",
            "repeat": [{"count": 4, "step": [0.1, 0, 0], "parameters": {"on": {"values": [0, 0.5, -0.0, -1]}}}]},
    "one": {"mesh": "box", "effect": "lifted.json", "parameters": {"on": 0}}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(made->stats.draws, 4 + 2 + 1);
  ASSERT_EQ(made->stats.skips.size(), 2u);
  EXPECT_EQ(made->stats.skips[0].what, "lifted of 2 of 4 copies of row");
  EXPECT_EQ(made->stats.skips[0].reason, "on is 0");
  EXPECT_EQ(made->stats.skips[1].what, "lifted of one");
}

TEST_F(PlanTest, PassesThatMoveVerticesAreNotCulledByMeshBounds) {
  write("lifted.json", lifted);
  const std::string members = R"("size": [32, 32], "objects": {
    "below": {"mesh": "box", "effect": "lifted.json", "transform": {"translate": [0, -4, 0]}},
    "far": {"mesh": "box", "effect": "tinted.json", "transform": {"translate": [0, -40, 0]}}})";
  const auto made = plan(members);
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(made->stats.draws, 1);
  ASSERT_EQ(made->stats.skips.size(), 2u);
  EXPECT_EQ(made->stats.skips[0].what, "base of below");
  EXPECT_EQ(made->stats.skips[1].what, "far");
  backends::Image image;
  render::DrawStats stats;
  ASSERT_TRUE(render::render(*made, *interpreter::create(), image, stats, diagnostics_));
  const auto seen = std::ranges::count_if(image.depth, [](float depth) { return depth > 0; });
  EXPECT_GT(seen, 10);
}

TEST_F(PlanTest, PixelsSeeTheirSizeAndUndisplacedPositions) {
  write("sizes.json", R"({"isoshade": 1, "effect": "sizes", "nodes": {
    "s": {"type": "pixelsize"}, "p": {"type": "position"}, "up": {"type": "constant", "value": [0, 2, 0]},
    "c": {"type": "combine3", "in1": "s", "in2": "p.y", "to": "color3"}, "moved": {"type": "add", "in1": "p", "in2": "up"}},
    "passes": [{"name": "base", "color": "c", "position": "moved"}]})");
  for (const char* camera : {R"("fov": 90)", R"("type": "orthographic", "height": 4, "far": 9)"}) {
    const auto made =
        plan(R"("size": [9, 8], "camera": {"position": [0, 0, 2], "target": [0, 0, 0], )" +
             std::string(camera) + R"(}, "objects": {"wall": {"mesh": {"type": "plane", "size": [9, 9]},
      "effect": "sizes.json", "transform": {"translate": [0, -2, 0], "rotate": [90, 0, 0]}}})");
    ASSERT_TRUE(made) << diagnostics_.text();
    backends::Image image;
    render::DrawStats stats;
    ASSERT_TRUE(render::render(*made, *interpreter::create(), image, stats, diagnostics_));
    const float* middle = &image.rgba[static_cast<size_t>(4 * (4 * 9 + 4))];
    EXPECT_NEAR(middle[0], 0.5, 1e-5) << camera;    // 4 units are 8 pixels
    EXPECT_NEAR(middle[1], -2.25, 1e-5) << camera;  // half a pixel below the middle, and two units
  }
}

TEST_F(PlanTest, FrameHoldsCameraLightsAndBackground) {
  const auto made = plan(R"("background": [0.1, 0.2, 0.3, 0.4], "size": [17, 9], "time": 2.5,
    "lights": {"sun": {"type": "directional", "direction": [0, -1, 0]},
               "lamp": {"type": "point", "position": [1, 2, 3], "intensity": 5}}, "objects": {})");
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(made->frame.picture().target.width, 17);
  EXPECT_EQ(made->frame.picture().target.height, 9);
  EXPECT_EQ(made->frame.light_count, 2);
  EXPECT_EQ(made->frame.lights.size(), 2u * lower::light_word::stride);
  EXPECT_EQ(made->frame.lights[lower::light_word::stride + lower::light_word::color], 5.0f);
  EXPECT_EQ(made->frame.frame, (std::vector<float>{0, -1}));  // nothing reads the time, and there is no environment
  EXPECT_EQ(made->frame.picture().words.size(), static_cast<size_t>(lower::view_word::camera_words));
  const auto words = [&](int first, size_t count) {
    const float* const from = made->frame.picture().words.data() + first;
    return std::vector(from, from + count);
  };
  EXPECT_EQ(words(lower::view_word::eye, 4), (std::vector<float>{0, 0, 5, 1}));
  EXPECT_EQ(words(lower::view_word::view, 12), (std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -5}));
  EXPECT_EQ(words(lower::view_word::inverse_view, 12),
            (std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 5}));
  const std::vector<float> projection = words(lower::view_word::projection, 16);
  EXPECT_EQ(projection[11], -1.0f);  // w is the distance along the view
  EXPECT_EQ(projection[10], 0.0f);
  const std::vector<float> pixel = words(lower::view_word::pixel_size, 2);
  EXPECT_EQ(pixel[0], 0.0f);
  EXPECT_FLOAT_EQ(pixel[1] * projection[5] * 9, 2.0f);  // nine pixels are the height of clip space
  EXPECT_EQ(made->frame.picture().background[3], 0.4f);
  options_.width = 5;
  options_.height = 7;
  const auto other = plan("\"objects\": {}");
  ASSERT_TRUE(other);
  EXPECT_EQ(other->frame.picture().target.width, 5);
  EXPECT_EQ(other->frame.picture().target.height, 7);
}

TEST_F(PlanTest, CullingChangesNoBit) {
  const std::string members = R"("size": [48, 27], "background": [0.5, 0.25, 0.125, 1],
    "objects": {"grid": {"mesh": {"type": "sphere", "segments": 12, "rings": 6}, "effect": "tinted.json",
      "transform": {"translate": [-8, -4, -1], "scale": 0.6},
      "repeat": [{"count": 9, "step": [2, 0, 0], "parameters": {"gain": {"from": 0.5, "to": 3}}},
                 {"count": 5, "step": [0, 2, 0]}, {"count": 3, "step": [0, 0, 3]}]}})";
  support::Diagnostics diagnostics;
  const auto backend = interpreter::create();
  backends::Image images[2];
  int64_t draws[2];
  for (const bool skip : {false, true}) {
    options_.compiler.skips = skip ? interface::Skips() : interface::Skips::none();
    const auto made = plan(members);
    ASSERT_TRUE(made) << diagnostics_.text();
    render::DrawStats stats;
    ASSERT_TRUE(render::render(*made, *backend, images[skip], stats, diagnostics)) << diagnostics.text();
    draws[skip] = made->stats.draws;
    if (skip) {
      ASSERT_EQ(made->stats.skips.size(), 1u);
      EXPECT_NE(render::text(made->stats).find("of 135 copies of grid: outside of the view"),
                std::string::npos)
          << render::text(made->stats);
    }
  }
  EXPECT_EQ(draws[0], 135);
  EXPECT_LT(draws[1], 100);
  EXPECT_GT(draws[1], 10);
  const auto comparison = compare::compare(images[0], images[1]);
  EXPECT_TRUE(comparison.identical()) << compare::describe(comparison, "all", "skipping");
  const size_t background =
      static_cast<size_t>(std::count(images[0].depth.begin(), images[0].depth.end(), 0.0f));
  EXPECT_GT(background, 50u);  // there is something to see, and something beside it
  EXPECT_LT(background, 48u * 27u - 50u);
}

TEST_F(PlanTest, SceneWithoutObjectsShowsItsBackground) {
  const auto made = plan(R"("size": [3, 2], "background": [0.5, 0.25, 0.125, 1])");
  ASSERT_TRUE(made) << diagnostics_.text();
  backends::Image image;
  render::DrawStats stats;
  ASSERT_TRUE(render::render(*made, *interpreter::create(), image, stats, diagnostics_));
  ASSERT_EQ(image.rgba.size(), 24u);
  EXPECT_EQ(image.rgba[4], 0.5f);
  EXPECT_EQ(image.depth, std::vector<float>(6, 0.0f));
}

TEST_F(PlanTest, ModelFactorsSetParametersTheObjectDoesNot) {
  write("model.glb", testing::glb(testing::square_json(), testing::square_data()));
  write("pbr.json", R"({"isoshade": 1, "effect": "pbr",
    "parameters": {"base_color": {"type": "color3", "value": [1, 1, 1]},
                   "metallic": {"type": "float", "value": 0},
                   "roughness": {"type": "float", "value": 1, "min": 0.5}},
    "nodes": {"a": {"type": "add", "in1": "metallic", "in2": "roughness"},
              "color": {"type": "multiply", "in1": "base_color", "in2": "a"}},
    "passes": [{"name": "base", "color": "color"}]})");
  const auto made = plan(R"("objects": {
    "a": {"mesh": {"type": "gltf", "file": "model.glb", "fit": true}, "effect": "pbr.json"},
    "b": {"mesh": {"type": "gltf", "file": "model.glb", "fit": true}, "effect": "pbr.json",
          "parameters": {"metallic": 0.125}}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(made->meshes.size(), 1u);
  EXPECT_EQ(made->meshes[0].low, glm::vec3(-0.5f, -0.5f, 0));
  EXPECT_EQ(made->meshes[0].high, glm::vec3(0.5f, 0.5f, 0));
  const float* given = record(*made, 0) + lower::object_word::parameters;
  EXPECT_EQ(std::vector<float>(given, given + 5), (std::vector<float>{0.5f, 0.25f, 1, 0.75f, 0.5f}));
  EXPECT_EQ(record(*made, 1)[lower::object_word::parameters + 3], 0.125f);
}

TEST_F(PlanTest, RejectsModelsOutsideTheCollection) {
  EXPECT_TRUE(planning_fails_with(
      R"("objects": {"a": {"mesh": {"type": "gltf", "file": "../x.glb"}, "effect": "tinted.json"}})",
      "outside-reference"));
  EXPECT_TRUE(planning_fails_with(
      R"("objects": {"a": {"mesh": {"type": "gltf", "file": "x.glb"}, "effect": "tinted.json"}})",
      "missing-file"));
}

}  // namespace
}  // namespace isoshade
