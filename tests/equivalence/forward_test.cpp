// SPDX-License-Identifier: Apache-2.0
// The texts of targets that are outside the contract, for every shipped document: the forward pairs in GLSL and GLSL ES, and the
// pure shaders in GLSL ES. glslang takes them as they stand.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

#include "compiler/check/library.h"
#include "compiler/driver/forward.h"
#include "compiler/targets/targets.h"

namespace isoshade::equivalence {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> documents() {
  std::vector<fs::path> paths;
  for (const char* folder : {"library", "source_forms", "effects", "materials", "textures"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(ISOSHADE_GRAPHS) / folder))
      if (entry.path().extension() == ".json") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

const std::vector<driver::Shader>& shipped() {
  static const std::vector<driver::Shader> all = [] {
    std::vector<driver::Shader> shaders;
    support::Diagnostics diagnostics;
    static check::Library library(ISOSHADE_GRAPHS "/library");
    driver::CompileOptions options;
    options.library = &library;
    for (const fs::path& path : documents()) {
      const support::Source source = graph::read_source(path.string(), diagnostics);
      const auto kind = driver::kind_of(source, diagnostics);
      if (!kind || kind == graph::DocumentKind::scene || kind == graph::DocumentKind::image) continue;
      if (auto shader = driver::compile_shader(source, options, {}, diagnostics)) shaders.push_back(std::move(*shader));
    }
    EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.text();
    return shaders;
  }();
  return all;
}

/// What glslangValidator says of texts; empty where it accepts all.
class Validator {
 public:
  Validator() {
    std::string pattern = (fs::temp_directory_path() / "isoshade-forward-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~Validator() {
    std::error_code error;
    fs::remove_all(folder_, error);
  }

  void expect_accepted(const std::string& name, const std::string& text, const char* options) const {
    const fs::path path = folder_ / name;
    std::ofstream(path) << text;
    const std::string command = "glslangValidator " + std::string(options) + " " + path.string();
    std::string said;
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    char buffer[4096];
    while (std::fgets(buffer, sizeof(buffer), pipe) != nullptr) said += buffer;
    EXPECT_EQ(pclose(pipe), 0) << said << text;
  }

 private:
  fs::path folder_;
};

void expect_pairs_accepted(emit::TargetId id, emit::ForwardSampling sampling, const char* options) {
  const Validator validator;
  size_t pairs = 0, sampled = 0;
  for (const driver::Shader& shader : shipped()) {
    support::Diagnostics refusal;
    if (!driver::can_be_forward(shader, refusal)) continue;
    for (const driver::ForwardPair& pair : driver::forward_pairs(shader, targets::get(id), sampling)) {
      validator.expect_accepted("pair.vert", pair.text.vertex, options);
      validator.expect_accepted("pair.frag", pair.text.fragment, options);
      if (testing::Test::HasFailure()) FAIL() << pair.stem;
      ++pairs;
      sampled += pair.text.fragment.find("textureLod") != std::string::npos;
    }
  }
  EXPECT_GT(pairs, 20u);
  EXPECT_EQ(sampled > 0, sampling == emit::ForwardSampling::samplers);
  std::printf("%zu pairs, %zu of which sample\n", pairs, sampled);
}

constexpr const char* vulkan = "-V -o /dev/null";
using enum emit::ForwardSampling;

TEST(Forward, PairsOfShippedDocumentsCompileForVulkan) {
  expect_pairs_accepted(emit::TargetId::glsl, fetch, vulkan);
}
TEST(Forward, PairsThatSampleCompileForVulkan) { expect_pairs_accepted(emit::TargetId::glsl, samplers, vulkan); }
TEST(Forward, PairsOfShippedDocumentsCompileForWebGl) { expect_pairs_accepted(emit::TargetId::glsl_es, fetch, ""); }
TEST(Forward, PairsThatSampleCompileForWebGl) { expect_pairs_accepted(emit::TargetId::glsl_es, samplers, ""); }

TEST(Forward, FilesOfPassesWithLongNamesHaveNamesThatFileSystemsTake) {
  const std::string effect(128, 'e'), pass(127, 'p');
  support::Diagnostics diagnostics;
  check::Library library(ISOSHADE_GRAPHS "/library");
  driver::CompileOptions options;
  options.library = &library;
  const auto source = std::make_shared<support::SourceFile>(
      "long.json", R"({"isoshade": 1, "effect": ")" + effect + R"(", "passes": [{"name": ")" + pass +
                       R"(1", "color": [1, 1, 1]}, {"name": ")" + pass + R"(2", "color": [0, 0, 0]}]})");
  const auto shader = driver::compile_shader(source, options, {}, diagnostics);
  ASSERT_TRUE(shader) << diagnostics.text();
  const auto pairs = driver::forward_pairs(*shader, targets::get(emit::TargetId::glsl));
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_NE(pairs[0].stem, pairs[1].stem);
  for (const driver::ForwardPair& pair : pairs) EXPECT_LE(pair.stem.size(), 255 - std::string_view(".es.frag.spv").size());
}

TEST(GlslEs, PureShadersOfShippedDocumentsCompile) {
  const emit::Target& target = targets::get(emit::TargetId::glsl_es);
  const Validator validator;
  for (const driver::Shader& shader : shipped()) {
    const std::string text = driver::text(shader, target);
    EXPECT_EQ(text.find("precise "), std::string::npos) << shader.pure.name;
    validator.expect_accepted("pure.frag",
                              "#version 300 es\nprecision highp float;\nprecision highp int;\n" + text +
                                  "\nout vec4 color;\nvoid main() { color = vec4(1.0); }\n",
                              "");
    if (HasFailure()) FAIL() << shader.pure.name;
  }
}

}  // namespace
}  // namespace isoshade::equivalence
