// SPDX-License-Identifier: Apache-2.0
// Passes that are blended give the same bits on every backend, and those that their formulas give.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "backends/cpu/lane_count.h"
#include "runtime/render/samples.h"
#include "tests/equivalence/blending_scenes.h"
#include "tests/unit/gltf_files.h"

namespace isoshade::equivalence {
namespace {

using Color = std::array<float, 4>;

/// Surfaces in every way: with a cut-out, derivatives and vertices that move; by the side that is seen; over what is
/// nearer; with depth; and after what is opaque.
const std::string manifold = R"json({"isoshade": 1, "effect": "manifold",
  "parameters": {"tint": {"type": "color3", "value": [1, 0.5, 0.25]}, "level": {"type": "float", "value": 0.3},
                 "clear": {"type": "boolean", "value": true}},
  "nodes": {
    "uv": {"type": "texcoord"}, "p": {"type": "position", "space": "object"}, "n": {"type": "normal"},
    "v": {"type": "viewdirection"}, "front": {"type": "frontfacing"},
    "rings": {"type": "expression", "code": "fract(6 * length(uv - vector2(0.5)))", "uv": "uv"},
    "width": {"type": "fwidth", "in": "uv.x"},
    "moved": {"type": "expression", "code": "p * 1.25 + vector3(0, 0.2 * uv.x, 0)", "p": "p", "uv": "uv"},
    "side": {"type": "expression", "code": "1 - abs(dot(n, v))", "n": "n", "v": "v"},
    "over": {"type": "expression", "code": "color4(tint * 0.7, 0.2 + 0.6 * side)", "tint": "tint", "side": "side"},
    "lines": {"type": "expression", "code": "color4(tint, fract(8 * uv.x) < 24 * w ? 0.8 : 0.1)", "uv": "uv",
              "w": "width", "tint": "tint"},
    "filter": {"type": "expression", "code": "front ? color4(tint, 0.9) : color4(0.6, 0.9, 1, 0.7)", "front": "front",
               "tint": "tint"},
    "sum": {"type": "expression", "code": "color4(tint * side, 0.5)", "tint": "tint", "side": "side"}},
  "passes": [
    {"name": "base", "cull": "none", "cutout": "rings", "cutoff": "level", "blend": "over", "blended": "clear",
     "color": "over"},
    {"name": "shell", "position": "moved", "position_space": "object", "blend": "add", "color": "sum"},
    {"name": "lines", "cull": "front", "blend": "premultiplied", "depth_write": "on", "color": "lines"},
    {"name": "above", "cull": "back", "depth": "always", "cutout": "rings", "blend": "multiply", "color": "filter"}]})json";

/// Reads the picture of what is opaque: displaced, filtered, and its depth.
const std::string reader = R"json({"isoshade": 1, "effect": "reader",
  "nodes": {
    "n": {"type": "normal", "space": "view"}, "p": {"type": "position", "space": "view"},
    "bend": {"type": "expression", "code": "n.xy * 0.2", "n": "n"},
    "bent": {"type": "scenecolor", "shift": "bend", "filter": "linear"},
    "straight": {"type": "scenecolor", "offsetx": 2, "edge": "mirror"},
    "behind": {"type": "scenedepth", "shift": [0.01, -0.02]},
    "gap": {"type": "expression", "code": "saturate(1 - (far + p.z) * 2)", "far": "behind.linear", "p": "p"},
    "out": {"type": "expression", "code": "color4(mix(a.rgb, b.rgb, 0.4) + color3(gap), sky ? 0.5 : 0.9)",
            "a": "bent", "b": "straight", "gap": "gap", "sky": "behind.issky"}},
  "passes": [{"name": "base", "blend": "over", "color": "out"}]})json";

const std::string members = R"("size": [160, 120], "sort": "back_to_front", )" + pane_camera + R"(,
  "objects": {
    "behind": {"mesh": {"type": "plane", "size": [4, 4], "segments": 3}, "effect": "solid.json",
               "transform": {"translate": [0, 0, -1.5], "rotate": [80, 0, 0]}},
    "ball": {"mesh": {"type": "sphere", "segments": 24, "rings": 12}, "effect": "manifold.json"},
    "mirrored": {"mesh": "box", "effect": "manifold.json",
                 "transform": {"translate": [0.8, 0.2, 0.7], "scale": [-1, 1.2, 0.8], "rotate": [20, 30, 0]},
                 "parameters": {"tint": [0.2, 0.9, 0.4]}},
    "opaque": {"mesh": {"type": "torus", "tube": 0.3}, "effect": "manifold.json",
               "transform": {"translate": [-1, 0, 0.3], "rotate": [70, 0, 0]}, "parameters": {"clear": false}},
    "lens": {"mesh": "sphere", "effect": "reader.json", "transform": {"translate": [-0.4, 0.5, 1], "scale": 0.4}},
    "through": {"mesh": {"type": "plane", "size": [9, 9]}, "effect": "manifold.json",
                "transform": {"rotate": [90, 10, 0], "translate": [0, 0, 2]},
                "parameters": {"level": 0.9}}})";

class Blending : public SceneFolder {
 protected:
  Blending() {
    folder_.write("solid.json", R"({"isoshade": 1, "effect": "solid",
      "parameters": {"tint": {"type": "color3", "value": [0.2, 0.3, 0.4]}},
      "passes": [{"name": "p", "cull": "none", "color": "tint"}]})");
    folder_.write("manifold.json", manifold);
    folder_.write("reader.json", reader);
    write_panes(folder_);
  }

  using SceneFolder::plan;
  render::Plan plan(Size size, int samples) { return plan(size, samples, members); }

  /// A plane before the camera at this z, with a number as its name.
  static std::string plane(int number, const std::string& effect, float z, const Color& tint) {
    return R"("o)" + std::to_string(number) + R"(": {"mesh": {"type": "plane", "size": [9, 9]}, "effect": ")" + effect +
           R"(.json", "transform": {"rotate": [90, 0, 0], "translate": [0, 0, )" + std::to_string(z) +
           R"(]}, "parameters": {"tint": [)" + std::to_string(tint[0]) + ", " + std::to_string(tint[1]) + ", " +
           std::to_string(tint[2]) + ", " + std::to_string(tint[3]) + "]}}";
  }
  /// What the middle pixel shows of objects, on every backend.
  Color middle(const std::string& objects, float* depth = nullptr) {
    const render::Plan made = plan({9, 7}, 1, R"("background": [0.5, 1, 0.25, 0.5], "objects": {)" + objects + "}");
    const backends::Image image = draw(made, *interpreter::create());
    expect_identical(image, draw(made, *cpu_backend()), objects);
#ifdef ISOSHADE_VULKAN
    expect_identical(image, draw(made, *vulkan_backend()), objects);
#endif
    const size_t pixel = 3 * 9 + 4;
    if (depth != nullptr) *depth = image.depth[pixel];
    Color color;
    std::copy_n(image.rgba.begin() + 4 * pixel, 4, color.begin());
    return color;
  }

};

TEST_F(Blending, GivesWhatTheFormulasGive) {
  const Color tint{0.5f, 0.25f, 1, 0.25f};
  // Of the background (0.5, 1, 0.25, 0.5), computed by hand: every value is exact.
  EXPECT_EQ(middle(plane(0, "over", 0, tint)), (Color{0.5f, 0.8125f, 0.4375f, 0.625f}));
  EXPECT_EQ(middle(plane(0, "add", 0, tint)), (Color{0.625f, 1.0625f, 0.5f, 0.5f}));
  EXPECT_EQ(middle(plane(0, "multiply", 0, tint)), (Color{0.4375f, 0.8125f, 0.25f, 0.5f}));
  EXPECT_EQ(middle(plane(0, "premultiplied", 0, tint)), (Color{0.875f, 1, 1.1875f, 0.625f}));
}

TEST_F(Blending, LeavesAClearSurfaceWithoutATraceAndAFullOneAlone) {
  for (const char* blend : {"over", "add", "multiply"})
    EXPECT_EQ(middle(plane(0, blend, 0, {0.7f, 0.1f, 0.9f, 0})), (Color{0.5f, 1, 0.25f, 0.5f})) << blend;
  for (const char* blend : {"over", "premultiplied"})
    EXPECT_EQ(middle(plane(0, blend, 0, {0.75f, 0.125f, 0.5f, 1})), (Color{0.75f, 0.125f, 0.5f, 1})) << blend;
}

TEST_F(Blending, OfEquallyNearSurfacesFollowsTheirOrder) {
  const Color red{1, 0, 0, 0.5f}, blue{0, 0, 1, 0.5f};
  EXPECT_EQ(middle(plane(0, "over", 0, red) + "," + plane(1, "over", 0, blue)), (Color{0.375f, 0.25f, 0.5625f, 0.875f}));
  EXPECT_EQ(middle(plane(0, "over", 0, blue) + "," + plane(1, "over", 0, red)), (Color{0.625f, 0.25f, 0.3125f, 0.875f}));
}

TEST_F(Blending, FollowsTheOrderOfTheSceneUnlessItIsSorted) {
  const Color red{1, 0, 0, 0.5f}, blue{0, 0, 1, 0.5f};
  const std::string near_first = plane(0, "over", 1, red) + "," + plane(1, "over", -1, blue);
  EXPECT_EQ(middle(near_first), (Color{0.375f, 0.25f, 0.5625f, 0.875f}));
  EXPECT_EQ(middle(near_first + R"(}, "sort": "back_to_front", "posts": [], "lights": {)"),
            (Color{0.625f, 0.25f, 0.3125f, 0.875f}));
}

TEST_F(Blending, IsDrawnAfterWhatIsOpaqueAndBehindIt) {
  const Color clear{1, 0, 0, 0.5f};
  const std::string solid = R"("wall": {"mesh": {"type": "plane", "size": [9, 9]}, "effect": "solid.json",
    "transform": {"rotate": [90, 0, 0]}, "parameters": {"tint": [0.25, 0.5, 0.75]}})";
  EXPECT_EQ(middle(plane(0, "over", 1, clear) + "," + solid), (Color{0.625f, 0.25f, 0.375f, 1}));
  EXPECT_EQ(middle(plane(0, "over", -1, clear) + "," + solid), (Color{0.25f, 0.5f, 0.75f, 1}));
}

TEST_F(Blending, ChangesTheDepthOnlyIfAsked) {
  const Color red{1, 0, 0, 0.5f}, blue{0, 0, 1, 0.5f};
  float depth = 0;
  middle(plane(0, "over", 1, red), &depth);
  EXPECT_EQ(depth, 0);
  const Color alone = middle(plane(0, "over_deep", 1, red), &depth);
  EXPECT_GT(depth, 0);
  EXPECT_EQ(middle(plane(0, "over_deep", 1, red) + "," + plane(1, "over", -1, blue)), alone) << "hidden";
  EXPECT_NE(middle(plane(0, "over_deep", -1, red) + "," + plane(1, "over", 1, blue)), alone) << "in front";
  EXPECT_NE(middle(plane(0, "over", 1, red) + "," + plane(1, "over", -1, blue)), alone) << "without depth";
}

TEST_F(Blending, IsIdenticalForEveryLaneCountAndOnTheInterpreter) {
  const auto interpreter = interpreter::create();
  for (const std::string& scene : {members, forty_layers()})
    for (const int samples : {1, 4, 16}) {
      const Size size = samples == 16 ? Size{19, 13} : Size{67, 51};
      const render::Plan made = plan(size, samples, scene);
      const backends::Image expected = draw(made, *interpreter);
      for (const char* lanes : {"1", "4", "8", "16", "8x2", "16x2"}) {
        if (!cpu::lane_count(lanes)->available()) continue;  // this machine has no registers of so many lanes
        expect_identical(expected, draw(made, *cpu_backend(lanes, 2)), text(size, samples) + " lanes " + lanes);
      }
    }
}

#ifdef ISOSHADE_VULKAN
TEST_F(Blending, IsIdenticalOnCpuAndVulkanAtEverySize) {
  const auto cpu = cpu_backend();
  const auto vulkan = vulkan_backend();
  const auto exact = vulkan_backend(driver::Division::exact);
  const auto gpu = vulkan_backend(std::nullopt, true);  // draws several layers before it looks for more
  for (const std::string& scene : {members, forty_layers()})
    for (const int samples : {1, 4, 16})
      for (const Size size : {Size{160, 120}, Size{321, 193}, Size{37, 29}, Size{1, 1}, Size{3, 100}}) {
        if (size.width * samples > 1000) continue;  // it would take long
        const render::Plan made = plan(size, samples, scene);
        const backends::Image expected = draw(made, *cpu);
        expect_identical(expected, draw(made, *vulkan), text(size, samples));
        expect_identical(expected, draw(made, *gpu), text(size, samples) + ", as on a GPU");
        if (size.width == 160 && samples == 1)
          expect_identical(expected, draw(made, *exact), text(size, samples) + ", exact division");
      }
}
#endif

TEST_F(Blending, IsDoneForEverySampleAlone) {
  const auto cpu = cpu_backend();
  render::Plan in_parts = plan({530, 283}, 4, forty_layers());
  const backends::Image resolved = draw(in_parts, *cpu);
  in_parts.samples = 1;  // all samples are an image
  backends::Image samples = draw(in_parts, *cpu);
  samples = resolved_to(samples, resolved.width);
  expect_identical(samples, resolved, "530x283");
}

/// 200 balls in a cloud, listed in this order.
std::string cloud(const std::vector<int>& order, bool sorted) {
  std::string objects;
  for (const int i : order) {
    const double angle = 2.399963 * i, y = 1 - 0.01 * i;
    objects += (objects.empty() ? "" : ", ") + (R"("o)" + std::to_string(i)) +
               R"(": {"mesh": {"type": "icosphere", "subdivisions": 1, "radius": 0.22}, "effect": "over.json",
               "transform": {"translate": [)" + std::to_string(1.4 * std::cos(angle)) + ", " + std::to_string(y) + ", " +
               std::to_string(1.4 * std::sin(angle)) + R"(]}, "parameters": {"tint": [)" + std::to_string(0.005 * i) +
               ", " + std::to_string(1 - 0.005 * i) + R"(, 0.3, 0.4]}})";
  }
  return pane_camera + (sorted ? R"(, "sort": "back_to_front")" : "") + R"(, "objects": {)" + objects + "}";
}

TEST_F(Blending, OfTwoHundredSortedObjectsIsThatOfTheirListSortedByHand) {
  std::vector<int> order(200);
  std::iota(order.begin(), order.end(), 0);
  const auto distance = [](int i) {  // along the view, from the camera at (1, 1.2, 4) to the origin
    const double angle = 2.399963 * i;
    return -(1 * 1.4 * std::cos(angle) + 1.2 * (1 - 0.01 * i) + 4 * 1.4 * std::sin(angle));
  };
  std::vector<int> by_hand = order;
  std::ranges::stable_sort(by_hand, std::ranges::greater(), distance);
  const auto cpu = cpu_backend();
  const backends::Image expected = draw(plan({200, 150}, 1, cloud(by_hand, false)), *cpu);
  const render::Plan sorted = plan({200, 150}, 1, cloud(order, true));
  expect_identical(expected, draw(sorted, *cpu), "sorted");
#ifdef ISOSHADE_VULKAN
  expect_identical(expected, draw(sorted, *vulkan_backend()), "sorted, on vulkan");
#endif
  const backends::Image unsorted = draw(plan({200, 150}, 1, cloud(order, false)), *cpu);
  EXPECT_FALSE(compare::compare(expected, unsorted).identical()) << "the order decides";
}

TEST_F(Blending, OfGltfMaterialsFollowsTheirAlphaMode) {
  namespace testing = isoshade::testing;
  std::filesystem::copy(ISOSHADE_GRAPHS "/materials/gltf_pbr.json", folder_.path() / "gltf_pbr.json");
  const auto cpu = cpu_backend();
  const auto drawn = [&](const std::string& keys) {
    std::string json = testing::square_json();
    const std::string from = R"("materials": [{)";
    json.replace(json.find(from), from.size(), from + keys);
    folder_.write("square.glb", testing::glb(json, testing::square_data()));
    const render::Plan made = plan({64, 64}, 1, R"("camera": {"position": [0.5, 0.5, 2], "target": [0.5, 0.5, 0]},
      "background": [0, 0, 0, 0], "objects": {
        "square": {"mesh": {"type": "gltf", "file": "square.glb"}, "effect": "gltf_pbr.json"}})");
    const backends::Image image = draw(made, *cpu);
    expect_identical(image, draw(made, *interpreter::create()), keys);
    std::array<int, 3> counts{};  // of pixels with an alpha of 0, between 0 and 1, of 1
    for (size_t i = 3; i < image.rgba.size(); i += 4) ++counts[image.rgba[i] <= 0 ? 0 : image.rgba[i] < 1 ? 1 : 2];
    return counts;
  };
  EXPECT_EQ(drawn("")[1], 0);
  EXPECT_EQ(drawn(R"("alphaMode": "OPAQUE", )")[1], 0);
  EXPECT_EQ(drawn(R"("alphaMode": "MASK", )")[1], 0);
  EXPECT_GT(drawn(R"("alphaMode": "BLEND", )")[1], 100) << "its alpha falls from 1 to 0.2 in one of its corners";
}

TEST_F(Blending, TellsWhichObjectIsNotFinite) {
  folder_.write("bad.json", R"json({"isoshade": 1, "effect": "bad", "nodes": {"p": {"type": "position"},
    "x": {"type": "expression", "code": "color4(1 / (p.x - p.x), 1, 1, 0.5)", "p": "p"}},
    "passes": [{"name": "base", "cull": "none", "blend": "over", "color": "x"}]})json");
  const std::string wall = R"("bad": {"mesh": {"type": "plane", "size": [9, 9]}, "effect": "bad.json",
    "transform": {"rotate": [90, 0, 0]}})";
  const Color clear{1, 0, 0, 0.5f};
  const render::Plan made = plan({9, 7}, 4, R"("objects": {)" + plane(0, "over", 0.5f, clear) + "," + wall + "," +
                                                plane(1, "over", 1, clear) + "}");
  support::Diagnostics diagnostics;
  backends::Image image;
  render::DrawStats stats;
  const auto cpu = cpu_backend();
  ASSERT_TRUE(render::render(made, *cpu, image, stats, diagnostics)) << diagnostics.text();
  EXPECT_EQ(stats.non_finite.drawn.count, 9 * 7);
  EXPECT_EQ(stats.non_finite.object, made.frame.picture().draws[1].object);
}

TEST_F(Blending, ReadsThePictureOfWhatIsOpaqueAlone) {
  // The lens shows the wall, whatever else is blended.
  const std::string wall = R"("wall": {"mesh": {"type": "plane", "size": [9, 9]}, "effect": "solid.json",
    "transform": {"rotate": [90, 0, 0], "translate": [0, 0, -1]}, "parameters": {"tint": [0.25, 0.5, 0.75]}})";
  folder_.write("lens.json", R"json({"isoshade": 1, "effect": "lens", "nodes": {"c": {"type": "scenecolor"},
    "x": {"type": "convert", "in": "c.rgb", "to": "color4"}},
    "passes": [{"name": "base", "cull": "none", "blend": "over", "color": "x"}]})json");
  const std::string lens = R"("lens": {"mesh": {"type": "plane", "size": [9, 9]}, "effect": "lens.json",
    "transform": {"rotate": [90, 0, 0], "translate": [0, 0, 1]}})";
  const Color seen = middle(wall + "," + plane(0, "over", 0, {1, 1, 0, 0.5f}) + "," + lens);
  EXPECT_EQ(seen, (Color{0.25f, 0.5f, 0.75f, 1}));
}

}  // namespace
}  // namespace isoshade::equivalence
