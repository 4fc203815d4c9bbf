// SPDX-License-Identifier: Apache-2.0
// Scenes in which things move, and posts that show how far.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "tests/equivalence/scene_folder.h"

namespace isoshade::equivalence {

/// Shows motion as a colour.
inline const std::string show = R"json({"isoshade": 1, "post": "show",
  "nodes": {"m": {"type": "motion"}, "c": {"type": "expression", "code": "color4(m.x, m.y, 0, 1)", "m": "m"}},
  "outputs": {"color": "c"}})json";

/// Moves its vertices upwards by the time, and has holes.
inline const std::string rising = R"json({"isoshade": 1, "effect": "rising",
  "parameters": {"speed": {"type": "float", "value": 0}, "clear": {"type": "boolean", "value": false},
                 "level": {"type": "float", "value": 0}},
  "nodes": {
    "t": {"type": "time"}, "p": {"type": "position"}, "before": {"type": "previousposition"}, "uv": {"type": "texcoord"},
    "up": {"type": "expression", "code": "p + vector3(0, speed * t, 0)", "p": "p", "speed": "speed", "t": "t"},
    "rings": {"type": "expression", "code": "fract(5 * length(uv - vector2(0.5)))", "uv": "uv"},
    "color": {"type": "expression", "code": "color4(p.x - before.x, p.y - before.y, 1, 0.5)", "p": "p", "before": "before"}},
  "passes": [{"name": "base", "cull": "none", "position": "up", "cutout": "rings", "cutoff": "level",
              "blend": "over", "blended": "clear", "depth_write": "on", "color": "color"}]})json";

/// Glass, which does not write depth.
inline const std::string glass = R"json({"isoshade": 1, "effect": "glass",
  "passes": [{"name": "base", "cull": "none", "blend": "over", "color": [0.2, 0.4, 0.6, 0.5]}]})json";

inline const std::string flat = R"json({"isoshade": 1, "effect": "flat",
  "parameters": {"tint": {"type": "color3", "value": [1, 0.5, 0.25]}},
  "passes": [{"name": "base", "cull": "none", "color": "tint"}]})json";

/// Stripes that tell each place from its neighbours.
inline const std::string stripes = R"json({"isoshade": 1, "effect": "stripes",
  "nodes": {"p": {"type": "position"},
            "c": {"type": "expression", "code": "color3(fract(p.x * 7.3), fract(p.y * 5.1), fract(p.x + p.y))", "p": "p"}},
  "passes": [{"name": "base", "cull": "none", "color": "c"}]})json";

// A pixel is a hundredth of a unit.
inline const std::string flat_camera = R"("camera": {"type": "orthographic", "height": 1.2, "position": [0, 0, 5],
  "target": [0, 0, 0]}, "frames_per_second": 10)";
inline constexpr Size flat_size{200, 120};

class Motion : public SceneFolder {
 protected:
  Motion() {
    for (const auto& [name, text] : std::array{std::pair("show", &show), std::pair("rising", &rising), std::pair("glass", &glass),
                                               std::pair("flat", &flat), std::pair("stripes", &stripes)})
      folder_.write(std::string(name) + ".json", *text);
    std::filesystem::copy(ISOSHADE_GRAPHS "/effects/motion_blur", folder_.path());
  }

  render::Plan plan_at(float time, Size size, const std::string& members, int samples = 1) {
    support::Diagnostics diagnostics;
    const auto source = std::make_shared<support::SourceFile>((folder_.path() / "scene.json").string(),
                                                              isoshade::testing::scene_text(members));
    auto scene = scene::load_scene(source, {}, {"", true}, diagnostics, time);
    EXPECT_TRUE(scene) << diagnostics.text();
    scenes_.push_back(scene ? *std::move(scene) : scene::Scene());
    scenes_.back().samples = samples;
    return equivalence::plan(scenes_.back(), size.width, size.height);
  }
  backends::Image draw_at(float time, Size size, const std::string& members) {
    return draw(plan_at(time, size, members), *interpreter::create());
  }

  static std::array<float, 2> at(const backends::Image& image, int x, int y) {
    const size_t first = 4 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x));
    return {image.rgba[first], image.rgba[first + 1]};
  }

  static std::string shown(const std::string& objects, const std::string& animations) {
    return flat_camera + R"(, "posts": [{"name": "show", "effect": "show.json"}], "objects": {)" + objects +
           R"(}, "animate": {)" + animations + "}";
  }

  /// The posts of motion blur.
  static std::string blurred(const std::string& parameters) {
    return R"("posts": [
      {"name": "t4", "effect": "longest.json", "size": 0.25, "inputs": {"vectors": "motion"}},
      {"name": "t16", "effect": "longest.json", "size": 0.0625, "inputs": {"vectors": "t4"}},
      {"name": "t32", "effect": "longest.json", "size": 0.03125, "inputs": {"vectors": "t16"}},
      {"name": "around", "effect": "neighbours.json", "size": 0.03125, "inputs": {"vectors": "t32"}},
      {"name": "blur", "effect": "blur.json", "inputs": {"color": "scene", "neighbours": "around"},
       "parameters": {)" + parameters + "}}]";
  }
};

inline const std::string ball = R"("ball": {"mesh": {"type": "sphere", "radius": 0.2}, "effect": "flat.json"})";

/// Surfaces of every kind that move in every way, before a camera that moves as well.
inline const std::string members_in_motion = R"("frames_per_second": 12, "sort": "back_to_front", "background": [0.1, 0.2, 0.3, 0.5],
  "camera": {"position": [1, 1.2, 4], "target": [0, 0, 0], "fov": 40},
  "objects": {
    "floor": {"mesh": {"type": "plane", "size": [30, 30], "segments": 3}, "effect": "stripes.json",
              "transform": {"translate": [0, -1, 0]}},
    "rising": {"mesh": {"type": "sphere", "segments": 24, "rings": 12}, "effect": "rising.json",
               "parameters": {"speed": 0.5, "level": 0.3}},
    "mirrored": {"mesh": "box", "effect": "rising.json", "parameters": {"clear": true},
                 "transform": {"translate": [0.8, 0.2, 0.7], "scale": [-1, 1.2, 0.8]}},
    "pane": {"mesh": {"type": "plane", "size": [2, 2]}, "effect": "glass.json", "transform": {"rotate": [90, 0, 0]}},
    "grid": {"mesh": "sphere", "effect": "flat.json", "transform": {"scale": 0.2},
             "repeat": [{"count": 3, "step": [0.7, 0, -0.5]}]}},
  "animate": {
    "camera.position": {"keys": [[0, [1, 1.2, 4]], [1, [-1, 0.8, 3]]], "ease": "smooth"},
    "objects.mirrored.transform.rotate": {"keys": [[0, [0, 0, 0]], [1, [90, 400, 0]]], "loop": "ping_pong"},
    "objects.rising.parameters.speed": {"keys": [[0, 0.5], [1, 1]]},
    "objects.grid.repeat.0.step": {"keys": [[0, [0.7, 0, -0.5]], [0.5, [0.5, 0.4, -0.5]]]},
    "objects.pane.transform.translate": {"keys": [[0, [0, 0, 1]], [0.3, [0.5, 0, 1.5]]], "loop": "repeat"}})";

}  // namespace isoshade::equivalence
