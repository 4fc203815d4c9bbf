// SPDX-License-Identifier: Apache-2.0
// Shadows that darken nothing change no bit: their maps are left out, and only theirs.
#include <algorithm>
#include <iterator>

#include "tests/equivalence/scene_folder.h"

namespace isoshade::equivalence {
namespace {

/// Shadows that darken nothing are not drawn, and change no bit if they are.
class ShadowsThatDarkenNothing : public SceneFolder {
 protected:
  ShadowsThatDarkenNothing() {
    folder_.write("lit.json", R"json({"isoshade": 1, "effect": "lit",
      "nodes": {"c": {"type": "lightcolor"}, "sum": {"type": "sum_lights", "in": "c"}},
      "passes": [{"name": "base", "cull": "none", "color": "sum"}]})json");
    backends_.push_back(interpreter::create());
    backends_.push_back(cpu_backend());
#ifdef ISOSHADE_VULKAN
    backends_.push_back(vulkan_backend());
#endif
  }

  render::Plan plan_for(const std::string& members, bool skip) {
    support::Diagnostics diagnostics;
    const auto document = isoshade::testing::document_of(isoshade::testing::scene_text(members), diagnostics,
                                                         (folder_.path() / "scene.json").string());
    const auto scene = document ? scene::parse_scene(*document, diagnostics) : std::nullopt;
    EXPECT_TRUE(scene) << diagnostics.text();
    render::PlanOptions options;
    options.width = options.height = 64;
    options.compiler.library = &library_;
    options.compiler.skips.set(interface::Skip::shadows, skip);
    auto made = scene ? render::plan_frame(*scene, options, diagnostics) : std::nullopt;
    EXPECT_TRUE(made) << diagnostics.text();
    return made ? *std::move(made) : render::Plan();
  }

  /// How many maps of one light are left out, the same image being drawn with them.
  size_t left_out(const std::string& members) {
    const render::Plan skipped = plan_for(members, true), all = plan_for(members, false);
    std::vector<render::Skipped> told;
    std::ranges::copy_if(skipped.stats.skips, std::back_inserter(told),
                         [](const render::Skipped& one) { return one.skip == interface::Skip::shadows; });
    const size_t maps = all.frame.views.size() - skipped.frame.views.size();
    EXPECT_EQ(told.size(), maps == 0 ? 0u : 1u);
    for (const render::Skipped& one : told) {
      EXPECT_EQ(one.what, "shadow of l");
      EXPECT_EQ(one.bytes, static_cast<int64_t>(4 * maps * 128 * 128));
    }
    EXPECT_EQ(
        std::ranges::count(all.stats.skips, std::optional(interface::Skip::shadows), &render::Skipped::skip),
        0);
    EXPECT_GT(all.frame.views.size(), 1u) << members;
    for (const auto& backend : backends_)
      expect_identical(draw(all, *backend), draw(skipped, *backend),
                       std::string(backend->name()) + " of " + members);
    return maps;
  }

  static std::string light(const std::string& keys) {
    return R"("lights": {"l": {"shadow": {"size": 128, "softness": 3}, )" + keys + "}}, ";
  }
  static std::string ball(const std::string& effect = "lit.json", const std::string& keys = "") {
    return R"("objects": {"ball": {"mesh": "sphere", "effect": ")" + effect + "\"" + keys + "}}";
  }
  static constexpr const char* sun = R"("type": "directional", "direction": [1, -1, 0])";
  static constexpr const char* lamp = R"("type": "point", "position": [0, 5, 0])";
  static constexpr const char* spot =
      R"("type": "spot", "position": [0, 5, 0], "outer_angle": 20, "direction": )";

  check::Library library_;
  std::vector<std::unique_ptr<backends::Backend>> backends_;
};

TEST_F(ShadowsThatDarkenNothing, OfBlackLightsAreNotDrawn) {
  EXPECT_EQ(left_out(light(sun) + ball()), 0u);
  EXPECT_EQ(left_out(light(sun + std::string(R"(, "intensity": 0)")) + ball()), 1u);
  EXPECT_EQ(left_out(light(sun + std::string(R"(, "color": [0, 0, 0])")) + ball()), 1u);
  EXPECT_EQ(left_out(light(lamp + std::string(R"(, "intensity": 0)")) + ball()), 6u);
}

TEST_F(ShadowsThatDarkenNothing, OfLightsThatDoNotReachAreNotDrawn) {
  EXPECT_EQ(left_out(light(lamp) + ball()), 0u);
  EXPECT_EQ(left_out(light(lamp + std::string(R"(, "range": 4.1)")) + ball()), 0u);
  EXPECT_EQ(left_out(light(lamp + std::string(R"(, "range": 3.9)")) + ball()), 6u)
      << "it ends before it reaches anything";
  EXPECT_EQ(left_out(light(spot + std::string("[0, -1, 0]")) + ball()), 0u);
  EXPECT_EQ(left_out(light(spot + std::string("[1, -0.6, 0]")) + ball()), 1u) << "it shines past everything";
}

TEST_F(ShadowsThatDarkenNothing, WithoutCastersAreNotDrawn) {
  for (const char* kind : {sun, lamp})
    EXPECT_EQ(left_out(light(kind) + ball("lit.json", R"(, "casts_shadow": false)")), kind == sun ? 1u : 6u);
  // A plate beyond the range, in the corner of a map, where depths are least beside distances.
  const auto plate = [&](const std::string& range, const std::string& at) {
    return R"("camera": {"position": [0, 3, 8], "target": [0, 0, 0]}, )" +
           light(R"("type": "point", "position": [0, 2, 0])" + range) + R"("objects": {
      "floor": {"mesh": {"type": "plane", "size": [9, 9]}, "effect": "lit.json", "casts_shadow": false},
      "plate": {"mesh": {"type": "box", "size": [2, 2, 2]}, "effect": "lit.json", "transform": {"translate": )" +
           at + "}}}";
  };
  EXPECT_EQ(left_out(plate(R"(, "range": 4)", "[0, 1, 0]")), 0u);
  EXPECT_EQ(left_out(plate(R"(, "range": 4)", "[9, -6, 8]")), 6u);
  EXPECT_EQ(left_out(plate(R"(, "range": 4)", "[3.5, -1, 3.5]")), 0u)
      << "it lies beyond the range, but maps do not show that";
  EXPECT_EQ(left_out(plate("", "[9, -6, 8]")), 0u) << "the range has no end";
}

TEST_F(ShadowsThatDarkenNothing, OfWhatNobodyReadsAreNotDrawn) {
  folder_.write("flat.json", R"({"isoshade": 1, "effect": "flat", "passes": [{"name": "p", "color": 1}]})");
  folder_.write("dull.json", R"json({"isoshade": 1, "effect": "dull",
    "nodes": {"c": {"type": "lightcolor"}, "sum": {"type": "sum_lights", "in": "c"}},
    "passes": [{"name": "p", "receives_shadow": false, "color": "sum"}]})json");
  folder_.write("facing.json", R"json({"isoshade": 1, "effect": "facing",
    "nodes": {"l": {"type": "lightdirection"}, "n": {"type": "normal"}, "d": {"type": "dotproduct", "in1": "n", "in2": "l"},
      "sum": {"type": "sum_lights", "in": "d"}},
    "passes": [{"name": "p", "color": "sum"}]})json");
  folder_.write(
      "may.json",
      R"json({"isoshade": 1, "effect": "may", "parameters": {"lit": {"type": "boolean", "value": false}},
    "nodes": {"c": {"type": "lightcolor"}, "sum": {"type": "sum_lights", "in": "c"},
      "color": {"type": "expression", "code": "lit ? sum : color3(0.5)", "lit": "lit", "sum": "sum"}},
    "passes": [{"name": "p", "color": "color"}]})json");
  EXPECT_EQ(left_out(light(sun) + ball("flat.json")), 1u) << "no pass reads lights";
  EXPECT_EQ(left_out(light(sun) + ball("dull.json")), 1u) << "no pass receives shadows";
  EXPECT_EQ(left_out(light(sun) + ball("facing.json")), 1u) << "no pass reads colors of lights";
  EXPECT_EQ(left_out(light(sun) + ball("may.json")), 1u) << "a parameter switches lights off";
  EXPECT_EQ(left_out(light(lamp) + ball("may.json")), 6u);
  EXPECT_EQ(left_out(light(sun) + ball("may.json", R"(, "parameters": {"lit": true})")), 0u);
  EXPECT_EQ(left_out(light(sun) + ball("lit.json", R"(, "receives_shadow": false)")), 1u);
}

TEST_F(ShadowsThatDarkenNothing, OfWhatIsNotSeenAreNotDrawn) {
  const std::string away = R"(, "transform": {"translate": [0, 0, 50]})";
  for (const char* kind : {sun, lamp})
    EXPECT_EQ(left_out(light(kind) + ball("lit.json", away)), kind == sun ? 1u : 6u);
  for (const char* kind : {sun, lamp})
    EXPECT_EQ(left_out(light(kind) + R"("objects": {})"), kind == sun ? 1u : 6u);
}

}  // namespace
}  // namespace isoshade::equivalence
