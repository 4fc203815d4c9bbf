// SPDX-License-Identifier: Apache-2.0
// What is left out of images changes no bit, is left out where no program reads it, and only there.
#include <algorithm>
#include <fstream>
#include <random>

#include "runtime/scene/image_file.h"
#include "tests/equivalence/scene_folder.h"
#include "tests/unit/gltf_files.h"

namespace isoshade::equivalence {
namespace {

using interface::Skip;

/// A surface with dirt on it, and stains on the dirt.
const std::string dirty = R"json({"isoshade": 1, "effect": "dirty", "parameters": {
    "paint": {"type": "filename", "value": "paint.png"}, "dirt": {"type": "filename", "value": "dirt.png"},
    "amount": {"type": "float", "value": 0.5, "min": 0, "max": 1}, "tint": {"type": "color3", "value": [1, 0.8, 0.6]},
    "filter": {"type": "integer", "enum": ["closest", "linear", "trilinear"], "value": "trilinear"}},
  "nodes": {"at": {"type": "texcoord"}, "uv": {"type": "multiply", "in1": "at", "in2": 3},
    "painted": {"type": "image", "file": {"link": "paint"}, "texcoord": "uv", "default": 0.5, "filtertype": {"link": "filter"}},
    "grime": {"type": "image", "file": {"link": "dirt"}, "texcoord": "uv", "filtertype": "linear", "to": "color4"},
    "covered": {"type": "mix", "bg": "painted", "fg": "grime.rgb", "mix": "amount"},
    "chosen": {"type": "ifgreater", "value1": "amount", "value2": 0, "in1": "covered", "in2": "painted"},
    "color": {"type": "multiply", "in1": "chosen", "in2": "tint"}},
  "passes": [{"name": "base", "cull": "none", "color": "color"}]})json";

class Images : public SceneFolder {
 protected:
  Images() {
    folder_.write("dirty.json", dirty);
    std::mt19937 random(5);
    for (const char* name : {"paint.png", "dirt.png", "other.png"}) {
      std::vector<uint8_t> bytes(4 * 37 * 23);
      for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
      folder_.write(name, scene::png(37, 23, bytes));
    }
    std::vector<float> floats(4 * 37 * 23);
    for (float& value : floats) value = static_cast<float>(random() % 1000) / 500.0f;
    folder_.write("dirt.exr", scene::exr({37, 23, floats, std::vector<float>(37 * 23)}));
  }

  scene::Scene scene(const std::string& objects, const std::string& more = "",
                     std::optional<float> time = {}) {
    support::Diagnostics diagnostics;
    const auto source = std::make_shared<support::SourceFile>(
        (folder_.path() / "scene.json").string(),
        isoshade::testing::scene_text(
            R"("size": [61, 43], "camera": {"position": [0, 2, 5], "target": [0, 0, 0]}, "objects": {)" +
            objects + "}" + more));
    auto loaded = scene::load_scene(source, {}, {}, diagnostics, time);
    EXPECT_TRUE(loaded) << diagnostics.text();
    return loaded.value_or(scene::Scene());
  }

  render::Plan plan(const scene::Scene& scene, bool skip) {
    support::Diagnostics diagnostics;
    render::PlanOptions options;
    options.compiler.library = &library_;
    options.compiler.skips.set(Skip::textures, skip);
    auto made = render::plan_frame(scene, options, diagnostics);
    EXPECT_TRUE(made) << diagnostics.text();
    return made ? *std::move(made) : render::Plan();
  }

  static std::vector<std::string> left_out(const render::Plan& plan) {
    std::vector<std::string> texts;
    for (const render::Skipped& skipped : plan.stats.in_programs)
      if (skipped.skip == Skip::textures)
        texts.push_back(skipped.what + ": " + std::to_string(skipped.bytes));
    return texts;
  }

  /// Expects the same bits with the skip and without; returns what was left out, with the bytes.
  std::vector<std::string> compare(const scene::Scene& scene) {
    const render::Plan with = plan(scene, true), all = plan(scene, false);
    EXPECT_TRUE(left_out(all).empty());
    int64_t bytes = 0;
    for (const render::Skipped& skipped : with.stats.in_programs)
      if (skipped.skip == Skip::textures) bytes += skipped.bytes;
    // The first word of bytes is nobody's.
    const int64_t none = with.frame.texel_bytes.empty() && !all.frame.texel_bytes.empty() ? 4 : 0;
    const int64_t tables = with.frame.texels.empty() && !all.frame.texels.empty() ? 4 * 512 : 0;
    EXPECT_EQ(all.stats.texture_bytes - with.stats.texture_bytes, bytes + none + tables);
    for (const auto& backend : every_backend()) {
      const backends::Image expected = draw(all, *backend);
      EXPECT_GT(std::ranges::count_if(expected.rgba, [](float x) { return x > 0.1f && x < 0.9f; }), 250);
      expect_identical(expected, draw(with, *backend), std::string(backend->name()));
    }
    return left_out(with);
  }

  static std::string square(const std::string& name, float x, const std::string& parameters,
                            const std::string& more = "") {
    return "\"" + name +
           R"(": {"mesh": {"type": "plane", "size": [1.8, 1.8]}, "effect": "dirty.json", "transform": {"translate": [)" +
           std::to_string(x) + R"(, 0, 0]}, "parameters": {)" + parameters + "}" + more + "}";
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string texels(const std::string& file, const std::string& user, int64_t bytes) const {
    return "texels of \"" + path(file) + "\" (" + user + "): " + std::to_string(bytes);
  }

  check::Library library_{ISOSHADE_GRAPHS "/library"};
};

using Texts = std::vector<std::string>;
constexpr int64_t largest = 37 * 23, smaller = 18 * 11 + 9 * 5 + 4 * 2 + 2 + 1;

TEST_F(Images, ThatSwitchedOffCodeReadsAreLeftOut) {
  for (const std::string file : {"dirt.png", "dirt.exr"}) {
    const std::string map = R"("amount": 0, "dirt": ")" + file + "\"";
    EXPECT_EQ(compare(scene(square("a", -1, map) + ", " + square("b", 1, map))),
              (Texts{texels(file, "dirt of dirty", largest * (file == "dirt.png" ? 4 : 16))}));
  }
  // All of them.
  const std::string no_paint = R"("amount": 0, "paint": "")";
  EXPECT_EQ(compare(scene(square("a", 0, no_paint + R"(, "filter": "linear")"))).size(), 1u);
}

TEST_F(Images, MipLevelsThatNoFilterReadsAreLeftOut) {
  for (const char* filter : {"closest", "linear"})
    EXPECT_EQ(compare(scene(square("a", 0, R"("filter": ")" + std::string(filter) + "\""))),
              (Texts{"mip levels of \"" + path("paint.png") +
                     "\" (paint of dirty): " + std::to_string(4 * smaller)}));
  // One program reads both, one of them with its levels.
  std::string both = dirty;
  both.replace(both.find(R"("filtertype": "linear")"), 22, R"("filtertype": {"link": "filter2"})");
  both.insert(
      both.find("\"filter\""),
      R"("filter2": {"type": "integer", "enum": ["closest", "linear", "trilinear"], "value": "linear"}, )");
  folder_.write("dirty.json", both);
  EXPECT_EQ(
      compare(scene(square("a", 0, ""))),
      (Texts{"mip levels of \"" + path("dirt.png") + "\" (dirt of dirty): " + std::to_string(4 * smaller)}));
  EXPECT_EQ(compare(scene(square("a", 0, R"("filter": "linear", "filter2": "trilinear")"))),
            (Texts{"mip levels of \"" + path("paint.png") +
                   "\" (paint of dirty): " + std::to_string(4 * smaller)}));
}

TEST_F(Images, ThatAProgramReadsStay) {
  EXPECT_EQ(compare(scene(square("a", 0, ""))), Texts());
  EXPECT_EQ(compare(scene(square("a", -1, R"("amount": 0)") + ", " + square("b", 1, R"("amount": 0.3)"))),
            Texts())
      << "of b";
  EXPECT_EQ(
      compare(scene(square(
          "a", -1, "",
          R"(, "repeat": [{"count": 2, "step": [2, 0, 0], "parameters": {"amount": {"values": [0, 0.7]}}}])"))),
      Texts())
      << "of one copy";
  EXPECT_EQ(compare(scene(square("a", -1, R"("filter": "linear")") + ", " +
                          square("b", 1, R"("filter": "trilinear")"))),
            Texts())
      << "levels of b";
  EXPECT_EQ(compare(scene(square("a", -1, R"("amount": 0)") + ", " +
                          square("b", 1, R"("amount": 0, "paint": "dirt.png", "dirt": "other.png")"))),
            (Texts{texels("other.png", "dirt of dirty", 4 * largest)}))
      << "as another parameter";
  EXPECT_EQ(
      compare(scene(square("a", 0, R"("amount": 0)"),
                    R"(, "animate": {"objects.a.parameters.amount": {"keys": [[0, 0], [1, 1]]}})", 0.0f)),
      Texts())
      << "at another time";
  std::string dynamic = dirty;
  dynamic.insert(dynamic.find("\"value\": 0.5"), R"("dynamic": true, )");
  folder_.write("dirty.json", dynamic);
  EXPECT_EQ(compare(scene(square("a", 0, R"("amount": 0)"))), Texts()) << "of any value";
}

TEST_F(Images, OfMaterialsOfAGltfAreRead) {
  const auto model = [&](const std::string& sampler) {
    std::vector<uint8_t> bytes(4 * 8 * 8);
    std::mt19937 random(6);
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
    folder_.write("m.glb",
                  isoshade::testing::textured_glb(scene::png(8, 8, bytes), R"({"index": 0})", sampler));
    std::filesystem::copy_file(ISOSHADE_GRAPHS "/materials/gltf_pbr.json", folder_.path() / "pbr.json",
                               std::filesystem::copy_options::overwrite_existing);
    return scene(
        R"("m": {"mesh": {"type": "gltf", "file": "m.glb"}, "effect": "pbr.json", "transform": {"scale": 3, "translate": [-1.5, -1.5, 0]}})",
        R"(, "lights": {"sun": {"type": "directional", "direction": [0, 0, -1], "intensity": 3}})");
  };
  EXPECT_EQ(compare(model("{}")), Texts());
  const Texts left = compare(model(R"({"magFilter": 9729, "minFilter": 9729})"));
  ASSERT_EQ(left.size(), 1u);
  EXPECT_NE(left[0].find("(base_color_texture of gltf_pbr): " + std::to_string(4 * (16 + 4 + 1))),
            std::string::npos)
      << left[0];
}

/// Frames in which a parameter changes for which programs were compiled.
TEST_F(Images, AreLoadedWhenALaterFrameReadsThem) {
  std::vector<scene::Scene> scenes(4, scene(square("a", 0, R"("amount": 0)")));
  const auto amount = [](scene::Scene& scene) -> float& {
    return std::ranges::find(scene.objects[0].parameters, "amount", &scene::Parameter::name)->value.number;
  };
  amount(scenes[2]) = amount(scenes[3]) = 0.5f;
  for (const auto& backend : every_backend()) {
    render::PlanOptions options;
    options.compiler.library = &library_;
    render::FramePlanner planner(options);
    render::Renderer renderer(*backend);
    for (size_t i = 0; i < scenes.size(); ++i) {
      support::Diagnostics diagnostics;
      const render::Plan* made = planner.plan(scenes[i], diagnostics);
      render::DrawStats stats;
      ASSERT_TRUE(made != nullptr && renderer.draw(*made, stats, diagnostics)) << diagnostics.text();
      EXPECT_EQ(left_out(*made).size(), i < 2 ? 1u : 0u) << i;
      const scene::ImageView image = renderer.image();
      expect_identical(draw(plan(scenes[i], false), *backend),
                       {image.width,
                        image.height,
                        {image.rgba.begin(), image.rgba.end()},
                        {image.depth.begin(), image.depth.end()}},
                       "frame " + std::to_string(i) + " on " + std::string(backend->name()));
    }
  }
}

}  // namespace
}  // namespace isoshade::equivalence
