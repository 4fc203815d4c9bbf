// SPDX-License-Identifier: Apache-2.0
// Passes that are repeated: which draws a plan has of them, in which order, and how many are too many.
#include <gtest/gtest.h>

#include "compiler/lower/frame_layout.h"
#include "runtime/render/plan.h"
#include "tests/unit/scene_documents.h"
#include "tests/unit/temporary_folder.h"

namespace isoshade {
namespace {

namespace word = lower::object_word;

/// Scenes of an effect with a pass that is repeated between two that are not, and one whose repetitions are blended.
class RepeatTest : public ::testing::Test {
 protected:
  RepeatTest() {
    folder_.write("layered.json", R"json({"isoshade": 1, "effect": "layered",
      "parameters": {"shells": {"type": "integer", "value": 3, "min": 1, "max": 200}, "on": {"type": "boolean", "value": true},
                     "kind": {"type": "float", "value": 0}},
      "nodes": {"i": {"type": "passindex"}, "n": {"type": "passcount"},
                "color": {"type": "expression", "code": "vector3(float(i), float(n), kind)", "i": "i", "n": "n", "kind": "kind"},
                "flat": {"type": "convert", "in": "color", "to": "color3"}, "light": {"type": "lightcolor"},
                "lit": {"type": "sum_lights", "in": "light"}, "shown": {"type": "add", "in1": "flat", "in2": "lit"}},
      "passes": [{"name": "first", "color": "shown"},
                 {"name": "shells", "repeat": "shells", "enabled": "on", "color": "shown"},
                 {"name": "last", "color": "shown"}]})json");
    folder_.write("clouds.json", R"({"isoshade": 1, "effect": "clouds",
      "passes": [{"name": "a", "repeat": 2, "blend": "over", "color": [1, 1, 1]}, {"name": "b", "color": [1, 1, 1]}]})");
  }

  std::optional<render::Plan> plan(const std::string& members) {
    diagnostics_ = support::Diagnostics();
    const auto document =
        testing::document_of(testing::scene_text(members), diagnostics_, (folder_.path() / "scene.json").string());
    scene_ = document ? scene::parse_scene(*document, diagnostics_) : std::nullopt;
    EXPECT_TRUE(scene_) << diagnostics_.text();
    if (!scene_) return std::nullopt;
    options_.compiler.library = &library_;
    options_.compiler.skips.set(interface::Skip::parameters, false);  // the tests count what is skipped
    return render::plan_frame(*scene_, options_, diagnostics_);
  }

  using Numbers = std::vector<std::pair<int, int>>;
  /// The number of the repetition and their count of each draw of the picture.
  static Numbers numbers(const render::Plan& plan) {
    Numbers all;
    for (const backends::Draw& draw : plan.frame.picture().draws) {
      const float* record = &plan.frame.objects[static_cast<size_t>(draw.object)];
      all.emplace_back(static_cast<int>(record[word::pass_index]), static_cast<int>(record[word::pass_count]));
    }
    return all;
  }

  testing::TemporaryFolder folder_;
  check::Library library_;
  render::PlanOptions options_;
  support::Diagnostics diagnostics_;
  std::optional<scene::Scene> scene_;
};

TEST_F(RepeatTest, RepetitionsFollowOneAnotherWithinTheirPass) {
  const auto made = plan(R"("objects": {"a": {"mesh": "box", "effect": "layered.json"},
                                        "b": {"mesh": "box", "effect": "layered.json", "parameters": {"shells": 1}}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(numbers(*made), (Numbers{{0, 1}, {0, 3}, {1, 3}, {2, 3}, {0, 1}, {0, 1}, {0, 1}, {0, 1}}));
  EXPECT_EQ(made->origins.size(), 8u);
}

TEST_F(RepeatTest, RepetitionsShareOneProgram) {
  const auto made = plan(R"("objects": {"a": {"mesh": "box", "effect": "layered.json", "parameters": {"shells": 200}}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(made->frame.programs.size(), 2u);
  EXPECT_EQ(made->stats.draws, 202);
  EXPECT_EQ(made->stats.repetitions, 200);
  EXPECT_EQ(made->stats.repeated, 1);
  EXPECT_NE(render::text(made->stats).find("repeats:  1 passes over copies in 200 draws\n"), std::string::npos);
}

TEST_F(RepeatTest, CopiesMayHaveEachTheirCount) {
  const auto made = plan(R"("objects": {"a": {"mesh": "box", "effect": "layered.json",
    "repeat": [{"count": 3, "step": [0.1, 0, 0], "parameters": {"shells": {"values": [2, 1, 2]}, "on": {"values": [true, true, false]}}}]}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(numbers(*made), (Numbers{{0, 1}, {0, 2}, {1, 2}, {0, 1}, {0, 1}, {0, 1}, {0, 1}, {0, 1}, {0, 1}}));
  ASSERT_EQ(made->stats.skips.size(), 1u);
  EXPECT_EQ(made->stats.skips[0].what, "shells of 1 of 3 copies of a");
}

TEST_F(RepeatTest, BlendedRepetitionsComeLastInTheirOrder) {
  for (const char* sort : {"", R"("sort": "back_to_front", )"}) {
    const auto made = plan(sort + std::string(R"("objects": {
      "far": {"mesh": "box", "effect": "clouds.json", "transform": {"translate": [0, 0, -1]}},
      "near": {"mesh": "box", "effect": "clouds.json"}})"));
    ASSERT_TRUE(made) << diagnostics_.text();
    EXPECT_EQ(numbers(*made), (Numbers{{0, 1}, {0, 1}, {0, 2}, {1, 2}, {0, 2}, {1, 2}})) << sort;
  }
}

TEST_F(RepeatTest, ShadowsAreCastByEveryRepetition) {
  const auto made = plan(R"("lights": {"sun": {"type": "directional", "direction": [0, -1, -1], "shadow": {}}},
    "objects": {"a": {"mesh": "box", "effect": "layered.json"}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  ASSERT_EQ(made->frame.views.size(), 2u);
  EXPECT_EQ(made->frame.views[0].draws.size(), 5u);
  EXPECT_EQ(made->stats.repetitions, 6) << "those of the shadow map count, too";
}

TEST_F(RepeatTest, ProgramsThatChangeParametersGetAsManyAsTheyMayAskFor) {
  options_.disabled = true;
  const auto made = plan(R"("objects": {"a": {"mesh": "box", "effect": "layered.json", "parameters": {"on": false}}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(made->stats.draws, 202);
}

TEST_F(RepeatTest, RejectsMoreRepetitionsThanCanBeDrawn) {
  const auto copies = [](const std::string& most) {
    std::string counts = most;
    for (int i = 1; i < 12000; ++i) counts += ", 1";
    return R"("objects": {"a": {"mesh": "plane", "effect": "layered.json",
      "repeat": [{"count": 12000, "step": [1, 0, 0], "parameters": {"shells": {"values": [)" + counts + "]}}}]}}";
  };
  EXPECT_TRUE(plan(copies("1"))) << diagnostics_.text();
  EXPECT_FALSE(plan(copies("200")));
  EXPECT_NE(diagnostics_.text().find("error[too-large]: with object \"a\" the scene has more than 8000000 vertices to draw"),
            std::string::npos)
      << diagnostics_.text();
  EXPECT_NE(diagnostics_.text().find("fewer repetitions of passes"), std::string::npos);
}

TEST_F(RepeatTest, RejectsCountsOutsideTheRangeOfTheParameter) {
  EXPECT_FALSE(plan(R"("objects": {"a": {"mesh": "box", "effect": "layered.json", "parameters": {"shells": 201}}})"));
  EXPECT_NE(diagnostics_.text().find("error[out-of-range]: the parameter \"shells\" is at most 200"), std::string::npos)
      << diagnostics_.text();
}

}  // namespace
}  // namespace isoshade
