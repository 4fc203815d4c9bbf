// SPDX-License-Identifier: Apache-2.0
// Meshes of several materials: each part has its own.
#include <array>
#include <gtest/gtest.h>

#include "backends/cpu/backend.h"
#include "backends/interpreter/backend.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/compare/compare.h"
#include "runtime/render/plan.h"
#include "runtime/render/render.h"
#include "tests/unit/gltf_files.h"
#include "tests/unit/scene_documents.h"

namespace isoshade {
namespace {

namespace word = lower::object_word;

using Color = std::array<float, 3>;
constexpr Color own{0.25f, 0.5f, 0.75f};  // the effect's
constexpr Color green{0.125f, 1, 0.25f};  // the second material's
constexpr Color violet{0.5f, 0.25f, 1};   // the first one's

/// A camera that sees the four squares of testing::materials_json(), and their object.
class Parts : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("row.glb", testing::glb(testing::materials_json(), testing::square_data()));
    folder_.write("flat.json", R"({"isoshade": 1, "effect": "flat",
      "parameters": {"base_color": {"type": "color3", "value": [0.25, 0.5, 0.75]}},
      "passes": [{"name": "base", "color": "base_color", "cull": "none"}]})");
    folder_.write("twice.json", R"({"isoshade": 1, "effect": "twice",
      "parameters": {"base_color": {"type": "color3", "value": [0.25, 0.5, 0.75]},
                     "metallic": {"type": "float", "value": 0}},
      "passes": [{"name": "base", "color": "base_color"},
                 {"name": "shine", "color": "base_color", "enabled": "metallic"}]})");
  }

  std::optional<render::Plan> plan(const std::string& object) {
    const std::string members =
        R"("camera": {"type": "orthographic", "position": [2, 0.5, 5], "target": [2, 0.5, 0], "height": 1},
      "objects": {"row": {"mesh": {"type": "gltf", "file": "row.glb"}, )" +
        object + "}}";
    diagnostics_ = support::Diagnostics();
    const auto document =
        testing::document_of(testing::scene_text(members), diagnostics_, folder_.path() + "/scene.json");
    scene_ = document ? scene::parse_scene(*document, diagnostics_) : std::nullopt;
    EXPECT_TRUE(scene_) << diagnostics_.text();
    if (!scene_) return std::nullopt;
    options_.compiler.library = &library_;
    options_.compiler.skips.set(interface::Skip::parameters, false);  // the tests count what is skipped
    options_.width = 8;
    options_.height = 2;
    return render::plan_frame(*scene_, options_, diagnostics_);
  }

  backends::Image draw(const render::Plan& plan, backends::Backend& backend) {
    backends::Image image;
    render::DrawStats stats;
    EXPECT_TRUE(render::render(plan, backend, image, stats, diagnostics_)) << diagnostics_.text();
    return image;
  }

  /// In the middle of a square.
  static Color color_of(const backends::Image& image, size_t square) {
    const float* pixel = &image.rgba[4 * (2 * square + 1)];
    return {pixel[0], pixel[1], pixel[2]};
  }

  testing::Folder folder_;
  check::Library library_;
  render::PlanOptions options_;
  support::Diagnostics diagnostics_;
  std::optional<scene::Scene> scene_;
};

TEST_F(Parts, UseTheirMaterialsAndAreIdenticalOnAllBackends) {
  const auto made = plan(R"("effect": "flat.json")");
  ASSERT_TRUE(made) << diagnostics_.text();
  const backends::Image image = draw(*made, *interpreter::create());
  EXPECT_EQ(color_of(image, 0), green);
  EXPECT_EQ(color_of(image, 1), own);
  EXPECT_EQ(color_of(image, 2), violet);
  EXPECT_EQ(color_of(image, 3), green);
  cpu::CpuOptions options;
  options.cache = folder_.path() + "/cache";
  const auto cpu = cpu::create(options, diagnostics_);
  ASSERT_TRUE(cpu) << diagnostics_.text();
  const auto comparison = compare::compare(image, draw(*made, *cpu));
  EXPECT_TRUE(comparison.identical()) << compare::describe(comparison, "interpreter", "cpu");
}

TEST_F(Parts, OfOneMaterialShareADraw) {
  const auto made = plan(R"("effect": "flat.json")");
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(made->stats.meshes, 1);
  EXPECT_EQ(made->stats.copies, 1);
  EXPECT_EQ(made->stats.draws, 3);
  EXPECT_EQ(made->stats.vertices, 16);  // each once
  EXPECT_EQ(made->stats.triangles, 8);
  ASSERT_EQ(made->frame.picture().draws.size(), 3u);
  EXPECT_EQ(made->frame.picture().draws[0].indices.size(), 12u);
  EXPECT_EQ(made->frame.picture().draws[1].first_vertex, 8u);
  EXPECT_EQ(made->frame.picture().draws[1].indices[0], 0u);
}

TEST_F(Parts, AllHaveTheParametersOfTheObject) {
  const auto made = plan(R"("effect": "flat.json", "parameters": {"base_color": [1, 0, 0.5]})");
  ASSERT_TRUE(made) << diagnostics_.text();
  const backends::Image image = draw(*made, *interpreter::create());
  for (size_t square = 0; square < 4; ++square)
    EXPECT_EQ(color_of(image, square), (Color{1, 0, 0.5f})) << square;
}

TEST_F(Parts, AreDrawnPassByPassAndSkippedPerMaterial) {
  const auto made = plan(R"("effect": "twice.json")");
  ASSERT_TRUE(made) << diagnostics_.text();
  ASSERT_EQ(made->stats.draws, 4);
  const auto metallic = [&](size_t draw) {
    return made->frame
        .objects[static_cast<size_t>(made->frame.picture().draws[draw].object) + word::parameters + 3];
  };
  EXPECT_EQ(metallic(2), 0.75f);
  EXPECT_EQ(metallic(3), 0.75f);  // all of base, then what shines
  EXPECT_NE(made->frame.picture().draws[2].pixel_program, 0u);
  ASSERT_EQ(made->stats.skips.size(), 1u);
  EXPECT_EQ(made->stats.skips[0].what, "shine of 2 of 3 parts of row");
}

TEST_F(Parts, OutsideTheViewAreReportedAsOneCopy) {
  const auto made = plan(R"("effect": "flat.json", "repeat": [{"count": 2, "step": [0, 100, 0]}])");
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(made->stats.draws, 3);
  ASSERT_EQ(made->stats.skips.size(), 1u);
  EXPECT_EQ(made->stats.skips[0].what, "1 of 2 copies of row");
}

TEST_F(Parts, CountTowardsTheLimits) {
  // Both passes of all copies are within the limit, but not each of their three parts.
  static_assert(65536 * 2 * (word::parameters + 4) < render::max_object_words);
  static_assert(65536 * 2 * 3 * (word::parameters + lower::view_word::matrix + 4) > render::max_object_words);
  EXPECT_FALSE(plan(R"("effect": "twice.json", "repeat": [{"count": 65536, "step": [0, 100, 0]}])"));
  EXPECT_NE(diagnostics_.text().find("words of object records"), std::string::npos) << diagnostics_.text();
}

TEST_F(Parts, ReportAnUnknownParameterOnce) {
  EXPECT_FALSE(plan(R"("effect": "flat.json", "parameters": {"base_colour": [1, 0, 0]})"));
  EXPECT_EQ(diagnostics_.error_count(), 1u) << diagnostics_.text();
}

}  // namespace
}  // namespace isoshade
