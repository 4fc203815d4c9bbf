// SPDX-License-Identifier: Apache-2.0
// Cut-outs give the same bits on every backend, whatever hides them, moves them or turns them over.
#include <algorithm>
#include <filesystem>

#include "backends/cpu/lane_count.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/render/samples.h"
#include "tests/equivalence/scene_folder.h"
#include "tests/unit/gltf_files.h"

namespace isoshade::equivalence {
namespace {

/// Holes in every way: by a boolean, by a float at its default cutoff, by derivatives, over what is nearer, on vertices
/// that move, and by the side that is seen.
const std::string effect = R"json({"isoshade": 1, "effect": "holes",
  "parameters": {"tint": {"type": "color3", "value": [1, 0.5, 0.25]}, "level": {"type": "float", "value": 0.5},
                 "both": {"type": "boolean", "value": false}},
  "nodes": {
    "uv": {"type": "texcoord"}, "p": {"type": "position", "space": "object"}, "n": {"type": "normal"},
    "front": {"type": "frontfacing"},
    "rings": {"type": "expression", "code": "fract(6 * length(uv - vector2(0.5)))", "uv": "uv"},
    "far": {"type": "expression", "code": "p * 7", "p": "p"},
    "grain": {"type": "noise3d", "position": "far"},
    "whole": {"type": "expression", "code": "grain > -0.1 || !front", "grain": "grain", "front": "front"},
    "width": {"type": "fwidth", "in": "uv.x"},
    "lines": {"type": "expression", "code": "fract(8 * uv.x) < 24 * w", "uv": "uv", "w": "width"},
    "moved": {"type": "expression", "code": "p * 1.25 + vector3(0, 0.2 * uv.x, 0)", "p": "p", "uv": "uv"},
    "shown": {"type": "expression", "code": "front ? tint : color3(uv.x, uv.y, 1)", "front": "front", "tint": "tint",
              "uv": "uv"}},
  "passes": [
    {"name": "rings", "cutout": "rings", "cutoff": "level", "double_sided": "both", "color": "shown"},
    {"name": "grain", "cull": "none", "position": "moved", "position_space": "object", "cutout": "whole",
     "color": "shown"},
    {"name": "lines", "cull": "front", "depth": "always", "cutout": "lines", "color": "tint"}]})json";

const std::string members = R"("size": [160, 120], "camera": {"position": [1, 1.2, 4], "target": [0, 0, 0], "fov": 40},
  "background": [0.1, 0.2, 0.3, 1],
  "objects": {
    "behind": {"mesh": {"type": "plane", "size": [4, 4], "segments": 3}, "effect": "solid.json",
               "transform": {"translate": [0, 0, -1.5], "rotate": [80, 0, 0]}},
    "ball": {"mesh": {"type": "sphere", "segments": 24, "rings": 12}, "effect": "holes.json"},
    "mirrored": {"mesh": "box", "effect": "holes.json",
                 "transform": {"translate": [0.8, 0.2, 0.7], "scale": [-1, 1.2, 0.8], "rotate": [20, 30, 0]},
                 "parameters": {"both": true}},
    "whole": {"mesh": {"type": "torus", "tube": 0.3}, "effect": "holes.json",
              "transform": {"translate": [-1, 0, 0.3], "rotate": [70, 0, 0]}, "parameters": {"level": 0, "both": true}},
    "through": {"mesh": {"type": "plane", "size": [9, 9]}, "effect": "holes.json",
                "transform": {"rotate": [90, 10, 0], "translate": [0, 0, 2]},
                "parameters": {"level": 0.9, "both": true}}})";

class Cutouts : public SceneFolder {
 protected:
  Cutouts() {
    folder_.write("holes.json", effect);
    folder_.write("solid.json", R"({"isoshade": 1, "effect": "solid", "passes": [{"name": "p", "color": [0.2, 0.3, 0.4]}]})");
  }

  using SceneFolder::plan;
  render::Plan plan(Size size, int samples) { return plan(size, samples, members); }
};

TEST_F(Cutouts, AreIdenticalForEveryLaneCountAndOnTheInterpreter) {
  const auto interpreter = interpreter::create();
  for (const int samples : {1, 4, 16}) {
    const Size size = samples == 16 ? Size{37, 29} : Size{97, 71};
    const render::Plan made = plan(size, samples);
    const backends::Image expected = draw(made, *interpreter);
    for (const char* lanes : {"1", "4", "8", "16", "8x2", "16x2"}) {
      if (!cpu::lane_count(lanes)->available()) continue;  // this machine has no registers of so many lanes
      expect_identical(expected, draw(made, *cpu_backend(lanes, 2)), text(size, samples) + " lanes " + lanes);
    }
  }
}

TEST_F(Cutouts, DecideForEverySampleAlone) {
  const auto cpu = cpu_backend();
  render::Plan in_parts = plan({530, 283}, 4);
  const backends::Image resolved = draw(in_parts, *cpu);
  in_parts.samples = 1;  // all samples are an image
  backends::Image samples = draw(in_parts, *cpu);
  samples = resolved_to(samples, resolved.width);
  expect_identical(samples, resolved, "530x283");
}

#ifdef ISOSHADE_VULKAN
TEST_F(Cutouts, AreIdenticalOnCpuAndVulkanAtEverySize) {
  const auto cpu = cpu_backend();
  const auto vulkan = vulkan_backend();
  const auto exact = vulkan_backend(driver::Division::exact);
  for (const int samples : {1, 4, 16})
    for (const Size size : {Size{320, 240}, Size{641, 383}, Size{1, 1}, Size{3, 200}}) {
      const render::Plan made = plan(size, samples);
      const backends::Image expected = draw(made, *cpu);
      expect_identical(expected, draw(made, *vulkan), text(size, samples));
      if (size.width == 320) expect_identical(expected, draw(made, *exact), text(size, samples) + ", exact division");
    }
}
#endif

TEST_F(Cutouts, SkippingACutoffOfZeroChangesNoBit) {
  const auto cpu = cpu_backend();
  render::Plan skipped = plan({160, 120}, 1), cut = plan({160, 120}, 1);
  size_t uncut = 0;
  for (backends::Draw& draw : cut.frame.views.back().draws) {
    const auto program = static_cast<size_t>(
        cut.frame.objects[static_cast<size_t>(draw.object) + lower::object_word::program]);
    if (cut.frame.cutouts.empty() || cut.frame.cutouts[program] == backends::Frame::no_program || draw.cutout) continue;
    draw.cutout = true;
    ++uncut;
  }
  EXPECT_EQ(uncut, 1u);
  expect_identical(draw(skipped, *cpu), draw(cut, *cpu), "the torus without its cut-out");
}

TEST_F(Cutouts, OfGltfMaterialsFollowTheirAlphaModeAndSides) {
  namespace testing = isoshade::testing;
  std::filesystem::copy(ISOSHADE_GRAPHS "/materials/gltf_pbr.json", folder_.path() / "gltf_pbr.json");
  const auto cpu = cpu_backend();
  const auto interpreter = interpreter::create();
  // The square's alpha falls from 1 to 0.2 in one of its corners.
  const auto drawn = [&](const std::string& keys, bool from_behind) {
    std::string json = testing::square_json();
    const std::string from = R"("materials": [{)";
    json.replace(json.find(from), from.size(), from + keys);
    folder_.write("square.glb", testing::glb(json, testing::square_data()));
    const render::Plan made = plan({64, 64}, 1, std::string(R"("camera": {"position": [0.5, 0.5, )") +
                                                    (from_behind ? "-2" : "2") +
                                                    R"(], "target": [0.5, 0.5, 0]}, "objects": {
        "square": {"mesh": {"type": "gltf", "file": "square.glb"}, "effect": "gltf_pbr.json"}})");
    const backends::Image image = draw(made, *cpu);
    expect_identical(image, draw(made, *interpreter), keys);
    return std::ranges::count_if(image.depth, [](float depth) { return depth > 0; });
  };
  const auto whole = drawn("", false);
  EXPECT_GT(whole, 400);
  EXPECT_EQ(drawn(R"("alphaMode": "OPAQUE", )", false), whole);
  const auto cut = drawn(R"("alphaMode": "MASK", )", false);
  EXPECT_LT(cut, whole);
  EXPECT_GT(cut, whole / 2);
  EXPECT_LT(drawn(R"("alphaMode": "MASK", "alphaCutoff": 0.75, )", false), cut);
  EXPECT_EQ(drawn(R"("alphaMode": "MASK", "alphaCutoff": 1.5, )", false), 0);
  EXPECT_EQ(drawn(R"("alphaMode": "MASK", )", true), 0) << "one-sided";
  EXPECT_EQ(drawn(R"("alphaMode": "MASK", "doubleSided": true, )", true), cut);
}

TEST_F(Cutouts, ShowWhatIsBehindTheirHoles) {
  const auto cpu = cpu_backend();
  const backends::Image image = draw(plan({160, 120}, 1), *cpu);
  size_t background = 0, behind = 0;
  for (size_t i = 0; i < image.depth.size(); ++i) {
    const float* color = &image.rgba[4 * i];
    background += image.depth[i] == 0 ? 1 : 0;
    behind += color[0] == 0.2f && color[1] == 0.3f && color[2] == 0.4f ? 1 : 0;
  }
  EXPECT_GT(background, 500u);
  EXPECT_GT(behind, 300u) << "seen through the plane in front, which covers the image";
}

}  // namespace
}  // namespace isoshade::equivalence
