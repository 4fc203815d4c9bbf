// SPDX-License-Identifier: Apache-2.0
// Programs for the values that a scene fixes draw the bits of those for all values.
#include <fstream>
#include <sstream>

#include "compiler/ir/expansion.h"
#include "tests/equivalence/scene_folder.h"

namespace isoshade::equivalence {
namespace {

std::string document(const std::string& name) {
  std::ifstream file(std::string(ISOSHADE_ROOT "/tests/equivalence/documents/") + name);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// An effect whose parts all depend on parameters: where vertices go, what is cut out, colors and their derivatives.
const std::string parts = R"json({"isoshade": 1, "effect": "parts", "parameters": {
    "swing": {"type": "float", "value": 0}, "holes": {"type": "float", "value": 0, "min": 0, "max": 1},
    "mode": {"type": "integer", "enum": ["plain", "bands", "noise"], "value": "plain"}, "shiny": {"type": "boolean", "value": false},
    "tint": {"type": "color3", "value": [0.7, 0.4, 0.2]}, "shells": {"type": "float", "value": 1, "min": 1, "max": 5},
    "glass": {"type": "boolean", "value": false}},
  "nodes": {"p": {"type": "position", "space": "object"}, "n": {"type": "normal", "space": "object"}, "world": {"type": "normal"},
    "i": {"type": "passindex"}, "count": {"type": "passcount"}, "uv": {"type": "texcoord"}, "t": {"type": "time"},
    "moved": {"type": "expression", "code": "p + n * (swing * sin(5 * p.y + t) + 0.1 * float(i) / float(count))", "p": "p", "n": "n",
              "swing": "swing", "t": "t", "i": "i", "count": "count"},
    "grain": {"type": "noise3d", "to": "float"},
    "bands": {"type": "expression", "code": "fract(7 * uv.x + uv.y)", "uv": "uv"},
    "slope": {"type": "fwidth", "in": "scaled"}, "scaled": {"type": "expression", "code": "bands * tint.x", "bands": "bands", "tint": "tint"},
    "value": {"type": "expression", "code": "mode == 1 ? bands : (mode == 2 ? 0.5 + 0.5 * grain : 1)", "mode": "mode", "bands": "bands", "grain": "grain"},
    "light": {"type": "lightcolor"}, "l": {"type": "lightdirection"},
    "one": {"type": "expression", "code": "light * (max(dot(world, l), 0) + (shiny ? pow(max(dot(world, l), 0), 20) : 0))", "light": "light",
            "l": "l", "world": "world", "shiny": "shiny"},
    "lit": {"type": "sum_lights", "in": "one"},
    "color": {"type": "expression", "code": "color4(tint * value * (color3(0.1) + lit) + color3(slope * 0.05), 0.5)", "tint": "tint", "value": "value",
              "lit": "lit", "slope": "slope"}},
  "passes": [{"name": "base", "repeat": "shells", "position": "moved", "position_space": "object", "cutout": "bands", "cutoff": "holes",
              "blend": "over", "blended": "glass", "color": "color"}]})json";
const std::string gain = R"json({"isoshade": 1, "post": "gain", "parameters": {"gain": {"type": "float", "value": 1}, "grey": {"type": "boolean", "value": false}},
  "nodes": {"c": {"type": "scenecolor"}, "y": {"type": "luminance", "in": "c"},
    "out": {"type": "expression", "code": "(grey ? y : c) * gain", "c": "c", "y": "y", "gain": "gain", "grey": "grey"}},
  "outputs": {"color": "out"}})json";
const std::string lights = R"("lights": {"sun": {"type": "directional", "direction": [-1, -2, -0.7], "intensity": 2, "shadow": {"size": 64}},
  "lamp": {"type": "point", "position": [1, 1, 2], "intensity": 3}}, "background": [0.1, 0.2, 0.3, 1])";

class Parameters : public SceneFolder {
 protected:
  Parameters() {
    folder_.write("layers.json", document("layers.json"));
    folder_.write("parts.json", parts);
    folder_.write("gain.json", gain);
  }

  scene::Scene scene(const std::string& members, std::optional<float> time = {}) {
    support::Diagnostics diagnostics;
    const support::Source source = std::make_shared<support::SourceFile>((folder_.path() / "scene.json").string(),
                                                                         isoshade::testing::scene_text(members));
    auto loaded = scene::load_scene(source, {}, {}, diagnostics, time);
    EXPECT_TRUE(loaded) << diagnostics.text();
    return loaded.value_or(scene::Scene());
  }
  /// The plan with all skips but perhaps this one.
  render::Plan plan(const scene::Scene& scene, bool fixes) {
    support::Diagnostics diagnostics;
    render::PlanOptions options;
    options.compiler.library = &library_;
    options.compiler.skips.set(interface::Skip::parameters, fixes);
    auto made = render::plan_frame(scene, options, diagnostics);
    EXPECT_TRUE(made) << diagnostics.text();
    return made ? *std::move(made) : render::Plan();
  }
  static uint64_t operations(const render::Plan& plan) {
    uint64_t sum = 0;
    for (const driver::Program* program : plan.frame.programs)
      sum += ir::expanded_operations(program->module, program->entry)[program->entry];
    for (const driver::Post& post : plan.post_documents)
      sum += ir::expanded_operations(post.program.module, post.program.entry)[post.program.entry];
    return sum;
  }
  static bool is_reported(const render::Plan& plan) {
    return std::ranges::any_of(plan.stats.in_programs, [](const render::Skipped& skip) { return skip.skip == interface::Skip::parameters; });
  }
  /// Compares a scene on each backend with and without fixed values.
  void expect_same_bits(const scene::Scene& scene, const std::string& what) {
    const render::Plan fixed = plan(scene, true), general = plan(scene, false);
    EXPECT_TRUE(is_reported(fixed)) << what;
    EXPECT_FALSE(is_reported(general)) << what;
    const backends::Image expected = draw(general, *interpreter_);
    EXPECT_GT(std::ranges::count_if(expected.rgba, [](float x) { return x > 0.3f && x < 0.9f; }), 100) << what;
    expect_identical(expected, draw(fixed, *interpreter_), what + ", interpreter");
    expect_identical(expected, draw(fixed, *cpu_), what + ", cpu");
#ifdef ISOSHADE_VULKAN
    expect_identical(expected, draw(fixed, *vulkan_), what + ", vulkan");
#endif
  }

  check::Library library_{ISOSHADE_GRAPHS "/library"};
  std::unique_ptr<backends::Backend> interpreter_ = interpreter::create(), cpu_ = cpu_backend("", 2);
#ifdef ISOSHADE_VULKAN
  std::unique_ptr<backends::Backend> vulkan_ = vulkan_backend();
#endif
};

std::string ball(const std::string& name, const std::string& effect, float x, const std::string& more) {
  return "\"" + name + R"(": {"mesh": {"type": "sphere", "radius": 0.8, "segments": 16, "rings": 8}, "effect": ")" + effect +
         R"(", "transform": {"translate": [)" + std::to_string(x) + ", 0, 0]}" + (more.empty() ? "" : ", " + more) + "}";
}
std::string objects(const std::vector<std::string>& all, const std::string& more = "") {
  std::string list;
  for (const std::string& object : all) list += (list.empty() ? "" : ", ") + object;
  return R"("size": [96, 64], )" + lights + ", \"objects\": {" + list + "}" + (more.empty() ? "" : ", " + more);
}

TEST_F(Parameters, OfManyLayersDrawTheSameWithoutTheirCode) {
  const scene::Scene shown = scene(objects({ball("a", "layers.json", 0, R"("parameters": {"detail": 0.3, "pattern": 0.5, "rim": 1.5})")}));
  expect_same_bits(shown, "layers");
  EXPECT_LT(2 * operations(plan(shown, true)), operations(plan(shown, false)));
}

TEST_F(Parameters, OfEveryPartOfAPassDrawTheSame) {
  expect_same_bits(scene(objects({ball("a", "parts.json", 0, "")})), "defaults");
  expect_same_bits(scene(objects({ball("a", "parts.json", 0, R"("parameters": {"swing": 0.2, "holes": 0.4, "mode": "noise", "shiny": true, "shells": 3.5})")})),
                   "all on");
  expect_same_bits(scene(objects({ball("a", "parts.json", 0, R"("parameters": {"glass": true, "mode": "bands"})"),
                                  ball("b", "parts.json", 1, R"("parameters": {"glass": true, "mode": "bands"})")})),
                   "blended");
}

TEST_F(Parameters, ThatDifferByObjectAreReadOrMakeVariants) {
  const std::string three = objects({ball("a", "parts.json", -1.5f, R"("parameters": {"mode": "noise", "tint": [1, 0, 0]})"),
                                     ball("b", "parts.json", 0, R"("parameters": {"shiny": true})"),
                                     ball("c", "parts.json", 1.5f, R"("parameters": {"mode": "noise", "tint": [0, 1, 0]})")});
  expect_same_bits(scene(three), "different values");
  EXPECT_EQ(plan(scene(three), true).effects.size(), 1u) << "variants would save too little";

  folder_.write("switched.json", R"json({"isoshade": 1, "effect": "switched",
    "parameters": {"noisy": {"type": "boolean", "value": false}, "tint": {"type": "color3", "value": [0.5, 0.5, 0.5]}},
    "nodes": {"noise": {"type": "fractal3d", "to": "float"}, "cells": {"type": "worleynoise2d"},
              "color": {"type": "expression", "code": "tint * (noisy ? noise : cells)", "tint": "tint", "noise": "noise", "cells": "cells", "noisy": "noisy"}},
    "passes": [{"name": "base", "color": "color"}]})json");
  const scene::Scene shown = scene(objects({ball("a", "switched.json", -1.5f, R"("parameters": {"tint": [0.8, 0.6, 0.4]})"),
                                            ball("b", "switched.json", 0, R"("parameters": {"noisy": true})"),
                                            ball("c", "switched.json", 1.5f, R"("parameters": {"tint": [0.4, 0.6, 0.8]})")}));
  expect_same_bits(shown, "variants");
  const render::Plan made = plan(shown, true);
  ASSERT_EQ(made.effects.size(), 2u);
  const auto tint = [](const driver::Effect& effect) { return driver::is_fixed(effect.fixed, effect.parameters, 1); };
  EXPECT_FALSE(tint(made.effects[0])) << "of a and c";
  EXPECT_TRUE(tint(made.effects[1])) << "of b alone";
  EXPECT_EQ(plan(shown, false).effects.size(), 1u);
}

TEST_F(Parameters, OfPlansForProgramsThatChangeThemAreRead) {
  support::Diagnostics diagnostics;
  render::PlanOptions options;
  options.compiler.library = &library_;
  options.disabled = true;
  const scene::Scene shown = scene(objects({ball("a", "parts.json", 0, "")}));
  const auto made = render::plan_frame(shown, options, diagnostics);
  ASSERT_TRUE(made) << diagnostics.text();
  EXPECT_FALSE(is_reported(*made));
}

TEST_F(Parameters, ThatVaryAlongAGridAreRead) {
  const std::string grid = R"("repeat": [{"count": 3, "step": [0.7, 0, 0], "parameters": {"tint": {"from": [1, 0, 0], "to": [0, 0, 1]},
                               "holes": {"values": [0, 0.2, 0.6]}}}])";
  const scene::Scene shown = scene(objects({ball("a", "parts.json", -1, grid)}));
  expect_same_bits(shown, "grid");
  const render::Plan made = plan(shown, true);
  const driver::Effect& effect = made.effects[0];
  EXPECT_FALSE(driver::is_fixed(effect.fixed, effect.parameters, *effect.parameters.find("tint")));
  EXPECT_FALSE(driver::is_fixed(effect.fixed, effect.parameters, *effect.parameters.find("holes")));
  EXPECT_TRUE(driver::is_fixed(effect.fixed, effect.parameters, *effect.parameters.find("shiny")));
}

TEST_F(Parameters, ThatMoveAreRead) {
  const std::string members = objects({ball("a", "parts.json", 0, R"("parameters": {"shiny": true})")},
                                      R"("posts": [{"name": "g", "effect": "gain.json"}, {"name": "h", "effect": "gain.json", "parameters": {"grey": true}}],
    "animate": {"objects.a.parameters.swing": {"keys": [[0, 0], [1, 0.3]]}, "posts.h.parameters.gain": {"keys": [[0, 1], [1, 0.5]]}})");
  for (const float time : {0.0f, 0.5f, 1.0f}) {
    const scene::Scene shown = scene(members, time);
    expect_same_bits(shown, "at " + std::to_string(time));
    const render::Plan made = plan(shown, true);
    const driver::Effect& effect = made.effects[0];
    EXPECT_FALSE(driver::is_fixed(effect.fixed, effect.parameters, *effect.parameters.find("swing")));
    EXPECT_TRUE(driver::is_fixed(effect.fixed, effect.parameters, *effect.parameters.find("shiny")));
    for (const driver::Post& post : made.post_documents)
      EXPECT_FALSE(driver::is_fixed(post.fixed, post.parameters, *post.parameters.find("gain"))) << "h is among its users";
  }
}

TEST_F(Parameters, ThatAreDynamicAreRead) {
  std::string text = parts;
  const std::string tint = R"("value": [0.7, 0.4, 0.2])";
  text.insert(text.find(tint), R"("dynamic": true, )");
  folder_.write("parts.json", text);
  const scene::Scene shown = scene(objects({ball("a", "parts.json", 0, "")}));
  expect_same_bits(shown, "dynamic");
  const render::Plan made = plan(shown, true);
  const driver::Effect& effect = made.effects[0];
  EXPECT_FALSE(driver::is_fixed(effect.fixed, effect.parameters, *effect.parameters.find("tint")));
  EXPECT_TRUE(driver::is_fixed(effect.fixed, effect.parameters, *effect.parameters.find("mode")));
}

TEST_F(Parameters, OfShippedScenesDrawTheSame) {
  for (const std::string& path : shipped_scenes()) {
    scene::Scene shown = load(path);
    shown.width = 80;
    shown.height = 45;
    expect_identical(draw(plan(shown, false), *interpreter_), draw(plan(shown, true), *interpreter_), path);
  }
}

}  // namespace
}  // namespace isoshade::equivalence
