// SPDX-License-Identifier: Apache-2.0
// Scenes, functions and images through include/isoshade/runtime.h, as a program uses it.
#include <isoshade/runtime.h>

#include <algorithm>
#include <bit>
#include <cfenv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <thread>
#include <xmmintrin.h>

namespace {

namespace fs = std::filesystem;

const std::string graphs = ISOSHADE_GRAPHS;
const std::string scene_file = graphs + "/scenes/material_balls.json";

isoshade::RenderOptions small() {
  isoshade::RenderOptions options;
  options.width = 64;
  options.height = 36;
  return options;
}

isoshade::Backend open(const std::string& name) {
  isoshade::Backend backend;
  isoshade::BackendOptions options;
  options.name = name;
  const isoshade::Outcome opened = backend.open(options);
  EXPECT_TRUE(opened) << opened.text;
  return backend;
}

TEST(Runtime, AllBackendsRenderTheSameBits) {
  const isoshade::Rendering interpreted = open("interpreter").render_file(scene_file, small());
  ASSERT_TRUE(interpreted) << interpreted.text;
  EXPECT_EQ(interpreted.image.width, 64);
  EXPECT_EQ(interpreted.image.height, 36);
  EXPECT_EQ(interpreted.image.rgba.size(), 4u * 64 * 36);
#ifdef ISOSHADE_VULKAN
  const char* others[] = {"cpu", "vulkan"};
#else
  const char* others[] = {"cpu"};
#endif
  for (const char* name : others) {
    const isoshade::Backend backend = open(name);
    EXPECT_FALSE(backend.description().empty());
    const isoshade::Rendering other = backend.render_file(scene_file, small());
    ASSERT_TRUE(other) << other.text;
    const isoshade::Comparison comparison = isoshade::compare_images(interpreted.image, other.image);
    EXPECT_TRUE(comparison.identical()) << name << " differs in " << comparison.differing << " pixels";
    EXPECT_EQ(comparison.pixels, 64 * 36);
    EXPECT_EQ(isoshade::hash_of(interpreted.image), isoshade::hash_of(other.image));
  }
}

TEST(Runtime, ComparisonFindsTheFirstDifferingPixel) {
  isoshade::Image a;
  a.width = 3;
  a.height = 2;
  a.rgba.assign(24, 0.5f);
  a.depth.assign(6, 0.25f);
  isoshade::Image b = a;
  b.rgba[4 * 4 + 1] = std::nextafter(0.5f, 1.0f);
  b.depth[5] = 0;
  const isoshade::Comparison comparison = isoshade::compare_images(a, b);
  EXPECT_TRUE(comparison.same_size);
  EXPECT_EQ(comparison.differing, 2);
  ASSERT_TRUE(comparison.first);
  EXPECT_EQ(comparison.first->x, 1);
  EXPECT_EQ(comparison.first->y, 1);
  EXPECT_EQ(comparison.first->a[1], 0.5f);
  EXPECT_EQ(comparison.first->b[1], std::nextafter(0.5f, 1.0f));
  EXPECT_NE(isoshade::hash_of(a), isoshade::hash_of(b));
}

TEST(Runtime, AnImageWithoutItsPixelsIsRefused) {
  isoshade::Image image;
  image.width = 1 << 20;
  image.height = 1 << 20;
  EXPECT_EQ(isoshade::hash_of(image), "");
  EXPECT_FALSE(isoshade::compare_images(image, image).identical());
  const isoshade::Outcome written = isoshade::write_image("/nowhere/a.png", image);
  EXPECT_EQ(written.status, isoshade::Status::failed);
  EXPECT_EQ(written.diagnostics.at(0).id, "bad-image");
}

TEST(Runtime, SettingsReachTheScene) {
  const isoshade::Backend cpu = open("interpreter");
  isoshade::RenderOptions options = small();
  const isoshade::Rendering before = cpu.render_file(scene_file, options);
  options.settings = {"camera.fov=20"};
  const isoshade::Rendering after = cpu.render_file(scene_file, options);
  ASSERT_TRUE(before && after) << before.text << after.text;
  EXPECT_FALSE(isoshade::compare_images(before.image, after.image).identical());

  options.settings = {"balls.rughness=0.5"};
  const isoshade::Rendering wrong = cpu.render_file(scene_file, options);
  EXPECT_EQ(wrong.status, isoshade::Status::failed);
  ASSERT_FALSE(wrong.diagnostics.empty());
  EXPECT_EQ(wrong.diagnostics[0].severity, isoshade::Severity::error);
  EXPECT_NE(wrong.text.find("rughness"), std::string::npos) << wrong.text;
  EXPECT_TRUE(wrong.image.rgba.empty());
}

TEST(Runtime, AnImpossibleSizeIsAnError) {
  isoshade::RenderOptions options;
  options.width = 100000;
  EXPECT_EQ(open("interpreter").render_file(scene_file, options).diagnostics.at(0).id, "out-of-range");
  options = {};
  options.samples = 3;
  EXPECT_EQ(open("interpreter").render_file(scene_file, options).diagnostics.at(0).id, "out-of-range");
}

const isoshade::Document red_effect{"/virtual/effects/red.json", R"({
  "isoshade": 1, "effect": "red",
  "nodes": {"half": {"type": "halve.json", "in": 1},
            "v": {"type": "combine3", "in1": "half", "in2": 0, "in3": 0},
            "c": {"type": "convert", "in": "v", "to": "color3"}},
  "passes": [{"name": "base", "color": "c"}]
})"};
const isoshade::Document halve{"/virtual/effects/halve.json", R"({
  "isoshade": 1, "function": "halve", "inputs": {"in": {"type": "float"}},
  "nodes": {"out": {"type": "multiply", "in1": "in", "in2": 0.5}}, "outputs": {"out": "out"}
})"};
const isoshade::Document red_scene{"/virtual/scenes/red.json", R"({
  "isoshade": 1, "scene": "red", "size": [8, 8],
  "camera": {"type": "orthographic", "position": [0, 0, 5], "target": [0, 0, 0], "height": 2},
  "objects": {"box": {"mesh": {"type": "box", "size": [4, 4, 1]}, "effect": "../effects/red.json"}}
})"};

TEST(Runtime, AllDocumentsMayBeInMemory) {
  isoshade::RenderOptions options;
  options.sources.documents = {red_effect, halve, {"/virtual/isoshade.root", ""}};
  const isoshade::Rendering rendering = open("interpreter").render(red_scene, options);
  ASSERT_TRUE(rendering) << rendering.text;
  EXPECT_EQ(rendering.image.rgba.at(0), 0.5f);
  EXPECT_EQ(rendering.image.rgba.at(1), 0.0f);

  options.sources.documents.pop_back();
  const isoshade::Rendering refused = open("interpreter").render(red_scene, options);
  EXPECT_EQ(refused.diagnostics.at(0).id, "outside-reference") << refused.text;
  options.sources.allow_outside = true;
  EXPECT_TRUE(open("interpreter").render(red_scene, options));
}

TEST(Runtime, AnErrorNamesThePlaceInADocumentInMemory) {
  isoshade::RenderOptions options;
  options.sources.documents = {{"/virtual/scenes/red.json", red_scene.text}};
  isoshade::Document scene = red_scene;
  scene.text.replace(scene.text.find("\"height\": 2"), 11, "\"hight\": 2");
  const isoshade::Rendering rendering = open("interpreter").render(scene, options);
  EXPECT_EQ(rendering.status, isoshade::Status::failed);
  const auto found = std::ranges::find(rendering.diagnostics, "unknown-key", &isoshade::Diagnostic::id);
  ASSERT_NE(found, rendering.diagnostics.end()) << rendering.text;
  const isoshade::Diagnostic& diagnostic = *found;
  EXPECT_EQ(diagnostic.where.file, scene.path);
  EXPECT_EQ(diagnostic.where.line, 3);
  EXPECT_GT(diagnostic.where.column, 1);
  EXPECT_EQ(diagnostic.pointer, "/camera/hight");
  EXPECT_NE(diagnostic.suggestion.find("height"), std::string::npos);
}

TEST(Runtime, NothingIsOpenBeforeOpen) {
  isoshade::Backend backend;
  EXPECT_FALSE(backend.is_open());
  EXPECT_EQ(backend.description(), "");
  EXPECT_EQ(backend.render_file(scene_file).diagnostics.at(0).id, "missing-argument");
  isoshade::BackendOptions options;
  options.name = "gpu";
  EXPECT_EQ(backend.open(options).diagnostics.at(0).id, "unknown-choice");
  options = {};
  options.lanes = "3";
  EXPECT_EQ(backend.open(options).diagnostics.at(0).id, "bad-lanes");
  EXPECT_FALSE(backend.is_open());
}

TEST(Runtime, AFunctionIsEvaluatedOverRows) {
  isoshade::Function ggx;
  const isoshade::Outcome loaded = ggx.load_file(graphs + "/library/brdf/ggx_d.json");
  ASSERT_TRUE(loaded) << loaded.text;
  ASSERT_EQ(ggx.inputs().size(), 2u);
  EXPECT_EQ(ggx.inputs()[0].name, "alpha");
  EXPECT_EQ(ggx.outputs().at(0).type, "float");
  std::vector<std::int32_t> rows;
  for (int i = 0; i < 100; ++i)
    for (const float value : {0.5f, static_cast<float>(i) / 99}) rows.push_back(std::bit_cast<std::int32_t>(value));
  const isoshade::Evaluation generated = open("cpu").evaluate(ggx, rows);
  ASSERT_TRUE(generated) << generated.text;
  EXPECT_EQ(generated.words.size(), 100u);
  EXPECT_EQ(generated.words, open("interpreter").evaluate(ggx, rows).words);
  // D(0.5, 1) = 1 / (pi 0.5^2)
  EXPECT_NEAR(std::bit_cast<float>(generated.words.back()), 1.2732395f, 1e-6f);

  rows.pop_back();
  EXPECT_EQ(open("interpreter").evaluate(ggx, rows).diagnostics.at(0).id, "bad-table");
  EXPECT_EQ(open("interpreter").evaluate(isoshade::Function(), rows).diagnostics.at(0).id, "missing-argument");
}

TEST(Runtime, WritesWhatItReads) {
  isoshade::RenderOptions options;
  options.sources.documents = {red_effect, halve, {"/virtual/isoshade.root", ""}};
  const isoshade::Rendering rendering = open("interpreter").render(red_scene, options);
  ASSERT_TRUE(rendering) << rendering.text;
  const fs::path folder = fs::temp_directory_path() / ("isoshade-api-" + std::to_string(getpid()));
  fs::create_directory(folder);
  EXPECT_TRUE(isoshade::write_image((folder / "red.png").string(), rendering.image));
  EXPECT_TRUE(isoshade::write_image((folder / "red.exr").string(), rendering.image));
  EXPECT_EQ(isoshade::write_image((folder / "red.tga").string(), rendering.image).status, isoshade::Status::failed);
  std::ifstream png(folder / "red.png", std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(png), {}).substr(1, 3), "PNG");
  fs::remove_all(folder);
}

TEST(Runtime, ThreadsShareABackendAndUseTheirOwn) {
  const isoshade::Backend shared = open("cpu");
  const isoshade::Rendering first = shared.render_file(scene_file, small());
  ASSERT_TRUE(first) << first.text;
  const std::string hash = isoshade::hash_of(first.image);
  isoshade::Function ggx;
  ASSERT_TRUE(ggx.load_file(graphs + "/library/brdf/ggx_d.json"));
  std::vector<std::string> hashes(6);
  std::vector<std::vector<std::int32_t>> rows(6);
  std::vector<std::thread> threads;
  for (size_t i = 0; i < hashes.size(); ++i)
    threads.emplace_back([&, i] {
      const isoshade::Backend own = i % 3 == 0 ? shared : open(i % 3 == 1 ? "cpu" : "interpreter");
      hashes[i] = isoshade::hash_of(own.render_file(scene_file, small()).image);
      rows[i] = own.evaluate(ggx, std::vector<std::int32_t>(64, 0x3f000000)).words;
    });
  for (std::thread& thread : threads) thread.join();
  for (const std::string& other : hashes) EXPECT_EQ(other, hash);
  for (const auto& other : rows) EXPECT_EQ(other, rows[0]);
  EXPECT_EQ(rows[0].size(), 32u);
}

TEST(Runtime, TheFloatModeOfTheCallerChangesNoBit) {
  const isoshade::Backend cpu = open("cpu");
  const std::string hash = isoshade::hash_of(cpu.render_file(scene_file, small()).image);
  const unsigned before = _mm_getcsr();
  const unsigned odd = 0x1f80 | 0x8040 | 0x4000;  // flushes denormals, rounds up
  _mm_setcsr(odd);
  const isoshade::Rendering rendering = cpu.render_file(scene_file, small());
  const unsigned after = _mm_getcsr();
  _mm_setcsr(before);
  EXPECT_EQ(after & ~0x3fu, odd);
  EXPECT_EQ(isoshade::hash_of(rendering.image), hash);
}

}  // namespace
