// SPDX-License-Identifier: Apache-2.0
// Scenes that show textures.
#pragma once

#include <gtest/gtest.h>
#include <optional>
#include <string>
#include <vector>

#include "backends/interpreter/backend.h"
#include "runtime/render/plan.h"
#include "runtime/render/render.h"
#include "runtime/scene/texture.h"
#include "tests/unit/gltf_files.h"
#include "tests/unit/scene_documents.h"

namespace isoshade {

/// Scenes beside a picture of 4 x 4 texels, all different, and an effect that shows one.
class Textures : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<uint8_t> bytes;
    for (int i = 0; i < 4 * 16; ++i) bytes.push_back(static_cast<uint8_t>(i % 4 == 3 ? 255 : 16 + 3 * i));
    folder_.write("a.png", scene::png(4, 4, bytes));
    folder_.write("bad.png", scene::png(4, 4, bytes).substr(0, 60));
    folder_.write("shown.json", effect("shown", R"("filtertype": "closest", "colorspace": "linear")"));
    folder_.write("small.json", effect("small", R"("filtertype": "trilinear", "colorspace": "linear")"));
    folder_.write("plain.json", R"({"isoshade": 1, "effect": "plain", "parameters": {
      "map": {"type": "filename", "value": "missing.png"}, "tint": {"type": "color3", "value": [1, 1, 1]}},
      "passes": [{"name": "base", "color": "tint"}]})");
  }

  static std::string effect(const std::string& name, const std::string& ports) {
    return R"({"isoshade": 1, "effect": ")" + name + R"(", "parameters": {
      "map": {"type": "filename", "value": "a.png"}, "tiles": {"type": "float", "value": 1}},
      "nodes": {"uv": {"type": "texcoord"}, "at": {"type": "multiply", "in1": "uv", "in2": "tiles"},
        "picture": {"type": "image", "file": {"link": "map"}, "default": 0.25, "texcoord": "at", )" +
           ports + R"(}},
      "passes": [{"name": "base", "color": "picture"}]})";
  }

  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }

  std::optional<render::Plan> plan(const std::string& members, int size = 4) {
    diagnostics_ = support::Diagnostics();
    const auto document =
        testing::document_of(testing::scene_text(members), diagnostics_, path("scene.json"));
    scene_ = document ? scene::parse_scene(*document, diagnostics_) : std::nullopt;
    if (!scene_) return std::nullopt;
    options_.compiler.library = &library_;
    options_.width = options_.height = size;
    return render::plan_frame(*scene_, options_, diagnostics_);
  }

  /// A square that fills the view, with these parameters.
  static std::string square(const std::string& effect, const std::string& parameters = "") {
    return R"("camera": {"type": "orthographic", "position": [0, 0, 5], "target": [0, 0, 0], "height": 1},
      "objects": {"square": {"mesh": "plane", "transform": {"rotate": [90, 0, 0]}, "effect": ")" +
           effect + R"(.json", "parameters": {)" + parameters + "}}}";
  }

  std::vector<float> draw(const render::Plan& plan) {
    backends::Image image;
    render::DrawStats stats;
    const auto backend = interpreter::create();
    EXPECT_TRUE(render::render(plan, *backend, image, stats, diagnostics_)) << diagnostics_.text();
    return image.rgba;
  }

  scene::TextureLevel picture() {
    const auto image = scene::read_image(path("a.png"), diagnostics_);
    return scene::linear_level(*image, false);
  }

  /// The floats of the bytes that are nearest.
  static std::vector<float> as_bytes(const scene::TextureLevel& level) {
    return scene::linear_level(scene::byte_level(level, false), false).texels;
  }

  testing::Folder folder_;
  check::Library library_;
  threads::Workers workers_{2};
  render::PlanOptions options_;
  support::Diagnostics diagnostics_;
  std::optional<scene::Scene> scene_;
};

}  // namespace isoshade
