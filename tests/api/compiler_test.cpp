// SPDX-License-Identifier: Apache-2.0
// Documents to shaders through include/isoshade/compiler.h, as a program uses it.
#include <algorithm>
#include <gtest/gtest.h>
#include <isoshade/compiler.h>
#include <thread>

namespace {

const std::string graphs = ISOSHADE_GRAPHS;

const isoshade::Document half{"/virtual/half.json", R"({
  "isoshade": 1, "function": "half", "inputs": {"in": {"type": "float"}},
  "nodes": {"y": {"type": "multiply", "in1": "in", "in2": 0.5}}, "outputs": {"out": "y"}
})"};

TEST(Compiler, HeadersAndLibraryHaveTheSameVersion) { EXPECT_STREQ(isoshade::version(), ISOSHADE_VERSION); }

TEST(Compiler, ADocumentInMemoryBecomesTexts) {
  const isoshade::Compilation made = isoshade::compile(half);
  ASSERT_TRUE(made) << made.text;
  ASSERT_NE(made.find("half.glsl"), nullptr);
  ASSERT_NE(made.find("half.h"), nullptr);
  EXPECT_NE(made.find("half.glsl")->bytes.find("float half"), std::string::npos)
      << made.find("half.glsl")->bytes;
  EXPECT_NE(made.find("half.h")->bytes.find("::half"), std::string::npos);
  EXPECT_EQ(made.find("half.txt"), nullptr);
  EXPECT_EQ(made.read, std::vector<std::string>{half.path});
}

TEST(Compiler, OptionsChooseTargetsAndPrefix) {
  isoshade::CompileOptions options;
  options.targets = {"cpp"};
  options.prefix = "mine";
  const isoshade::Compilation made = isoshade::compile(half, options);
  ASSERT_TRUE(made) << made.text;
  EXPECT_EQ(made.find("half.glsl"), nullptr);
  EXPECT_NE(made.find("half.h")->bytes.find("::mine"), std::string::npos);
  options.prefix = "not a name";
  EXPECT_EQ(isoshade::compile(half, options).diagnostics.at(0).id, "bad-id");
  options.prefix = "";
  options.targets = {"hlsl"};
  const isoshade::Compilation refused = isoshade::compile(half, options);
  EXPECT_EQ(refused.diagnostics.at(0).id, "unknown-choice");
  EXPECT_FALSE(refused.diagnostics.at(0).notes.empty());
}

std::vector<std::string> names_of(const isoshade::Compilation& made) {
  std::vector<std::string> names;
  for (const isoshade::File& file : made.files) names.push_back(file.name);
  return names;
}

TEST(Compiler, WrappersGiveTheFilesOfTheCommand) {
  isoshade::CompileOptions options;
  options.targets = {"spirv", "glsl-es"};
  options.wrapper = isoshade::Wrapper::forward;
  const isoshade::Compilation forward = isoshade::compile_file(graphs + "/effects/cartoon.json", options);
  ASSERT_TRUE(forward) << forward.text;
  const std::vector<std::string> expected{"cartoon.json",
                                          "cartoon.outline.vert.spv",
                                          "cartoon.outline.frag.spv",
                                          "cartoon.base.vert.spv",
                                          "cartoon.base.frag.spv",
                                          "cartoon.outline.es.vert",
                                          "cartoon.outline.es.frag",
                                          "cartoon.base.es.vert",
                                          "cartoon.base.es.frag"};
  EXPECT_EQ(names_of(forward), expected);
  EXPECT_EQ(forward.find("cartoon.base.frag.spv")->bytes.substr(0, 4), "\x03\x02\x23\x07")
      << "the magic number of SPIR-V";

  options.targets = {};
  options.wrapper = isoshade::Wrapper::isoshade;
  const isoshade::Compilation stages = isoshade::compile(half, options);
  ASSERT_TRUE(stages) << stages.text;
  EXPECT_EQ(names_of(stages), (std::vector<std::string>{"half.json", "half.frag", "half.cpp"}));

  options.wrapper = isoshade::Wrapper::forward;
  EXPECT_EQ(isoshade::compile(half, options).diagnostics.at(0).id, "unsupported") << "of a function";
  options.wrapper = isoshade::Wrapper::none;
  options.targets = {"spirv"};
  EXPECT_EQ(isoshade::compile(half, options).diagnostics.at(0).id, "unsupported") << "functions to include";
}

TEST(Compiler, AFileTellsWhatItReads) {
  const isoshade::Compilation made = isoshade::compile_file(graphs + "/effects/cartoon.json");
  ASSERT_TRUE(made) << made.text;
  EXPECT_FALSE(made.find("cartoon.glsl")->bytes.empty());
  EXPECT_EQ(made.read.at(0), graphs + "/effects/cartoon.json");
  EXPECT_GT(made.read.size(), 3u);
  EXPECT_TRUE(std::ranges::any_of(
      made.read, [](const std::string& path) { return path.find("library/toon") != std::string::npos; }));
}

TEST(Compiler, PrecisionChangesTheText) {
  isoshade::CompileOptions precise;
  precise.precision = isoshade::Precision::precise;
  const std::string file = graphs + "/materials/cook_torrance.json";
  const isoshade::Compilation standard = isoshade::compile_file(file),
                              other = isoshade::compile_file(graphs + "/effects/cartoon.json", precise);
  ASSERT_TRUE(standard && other) << standard.text << other.text;
  EXPECT_NE(isoshade::compile_file(graphs + "/effects/cartoon.json").find("cartoon.glsl")->bytes,
            other.find("cartoon.glsl")->bytes);
}

const isoshade::Document rim{"/virtual/rim.json", R"({
  "isoshade": 1, "effect": "rim", "parameters": {
    "strength": {"type": "float", "value": 1, "min": 0, "max": 4}, "tint": {"type": "color3", "value": [1, 1, 1]},
    "mode": {"type": "integer", "enum": ["flat", "noisy"], "value": "noisy"}, "map": {"type": "filename", "value": ""}},
  "nodes": {"noise": {"type": "noise3d", "to": "float"}, "unused": {"type": "time"},
    "picture": {"type": "image", "file": {"link": "map"}, "default": [1, 1, 1]},
    "color": {"type": "expression", "code": "tint * picture * (mode == 1 ? noise : 1) * strength",
              "tint": "tint", "picture": "picture", "noise": "noise", "mode": "mode", "strength": "strength"}},
  "passes": [{"name": "base", "color": "color"}]
})"};

TEST(Compiler, FixedValuesLeaveOutWhatOthersNeed) {
  const auto has = [](const isoshade::Compilation& made, const char* text) {
    return made.find("rim.glsl")->bytes.find(text) != std::string::npos;
  };
  isoshade::CompileOptions options;
  options.targets = {"glsl"};
  const isoshade::Compilation general = isoshade::compile(rim, options);
  ASSERT_TRUE(general) << general.text;
  for (const char* text : {"noise3d", "parameters.mode", "isoshade_texel(", "parameters.strength"}) EXPECT_TRUE(has(general, text)) << text;
  options.fixed = {"mode=noisy", "mode=flat", "map=\"\"", "tint=0.25,0.5,0.75"};
  const isoshade::Compilation fixed = isoshade::compile(rim, options);
  ASSERT_TRUE(fixed) << fixed.text;
  for (const char* text : {"noise3d", "parameters.mode", "isoshade_texel(", "parameters.tint"}) EXPECT_FALSE(has(fixed, text)) << text;
  for (const char* text : {"parameters.strength", "int mode;", "0.25"}) EXPECT_TRUE(has(fixed, text)) << text;
  EXPECT_NE(fixed.find("rim.json")->bytes.find("\"fixed\": 0"), std::string::npos) << "the reflection tells it";
  EXPECT_EQ(fixed.diagnostics.size(), 1u) << "the warning of the unused node, once\n" << fixed.text;
  for (const isoshade::Wrapper wrapper : {isoshade::Wrapper::forward, isoshade::Wrapper::isoshade}) {
    options.wrapper = wrapper;
    const isoshade::Compilation wrapped = isoshade::compile(rim, options);
    ASSERT_TRUE(wrapped) << wrapped.text;
    for (const isoshade::File& file : wrapped.files) {
      const bool is_text = file.name != "rim.json";
      EXPECT_TRUE(!is_text || file.bytes.find("noise3d") == std::string::npos) << file.name;
    }
  }
}

TEST(Compiler, FixedValuesAreChecked) {
  const auto first = [](const isoshade::Document& document, std::vector<std::string> fixed) {
    isoshade::CompileOptions options;
    options.sources.disabled_warnings = {"unused-node"};
    options.fixed = std::move(fixed);
    const isoshade::Compilation made = isoshade::compile(document, options);
    EXPECT_FALSE(made);
    EXPECT_TRUE(made.files.empty());
    return made.diagnostics.empty() ? isoshade::Diagnostic{} : made.diagnostics[0];
  };
  const isoshade::Diagnostic unknown = first(rim, {"strenght=0"});
  EXPECT_EQ(unknown.id, "unknown-parameter");
  EXPECT_NE(unknown.suggestion.find("\"strength\""), std::string::npos) << unknown.suggestion;
  const isoshade::Diagnostic outside = first(rim, {"strength=9"});
  EXPECT_EQ(outside.id, "out-of-range");
  EXPECT_EQ(outside.where.file, "--set") << "as the command calls it";
  EXPECT_EQ(outside.where.column, 10) << "of the value";
  EXPECT_EQ(first(rim, {"mode=nosy"}).id, "unknown-choice");
  EXPECT_EQ(first(rim, {"tint=1"}).id, "wrong-type");
  EXPECT_EQ(first(rim, {"strength"}).id, "bad-setting");
  EXPECT_EQ(first(rim, {"rim.strength=1"}).id, "bad-setting");
  EXPECT_EQ(first(rim, {"map=a.png"}).id, "unsupported");
  EXPECT_EQ(first(half, {"in=1"}).id, "unsupported") << "a function has no parameters";
}

TEST(Compiler, ErrorsAreDataWithPlaces) {
  isoshade::Document wrong = half;
  wrong.text.replace(wrong.text.find("\"in2\""), 5, "\"in3\"");
  const isoshade::Compilation made = isoshade::compile(wrong);
  EXPECT_EQ(made.status, isoshade::Status::failed);
  EXPECT_TRUE(made.files.empty());
  ASSERT_FALSE(made.diagnostics.empty());
  const isoshade::Diagnostic& diagnostic = made.diagnostics[0];
  EXPECT_EQ(diagnostic.id, "unknown-port");
  EXPECT_EQ(diagnostic.severity, isoshade::Severity::error);
  EXPECT_EQ(diagnostic.where.file, half.path);
  EXPECT_EQ(diagnostic.where.line, 3);
  EXPECT_FALSE(diagnostic.suggestion.empty());
  EXPECT_NE(made.text.find("^"), std::string::npos) << made.text;
}

TEST(Compiler, AMissingFileAndASceneAreErrors) {
  EXPECT_EQ(isoshade::compile_file("/nowhere/a.json").diagnostics.at(0).id, "missing-file");
  EXPECT_EQ(isoshade::compile_file(graphs + "/scenes/material_balls.json").diagnostics.at(0).id,
            "wrong-kind");
  EXPECT_EQ(isoshade::compile_file("-").diagnostics.at(0).id, "missing-file")
      << "standard input belongs to the program";
  EXPECT_EQ(isoshade::compile({"", ""}).diagnostics.at(0).id, "syntax");
}

TEST(Compiler, ThreadsCompileAtOnce) {
  const char* names[] = {"/effects/cartoon.json", "/materials/cook_torrance.json", "/effects/height_fog.json",
                         "/effects/terrain.json"};
  std::vector<std::string> alone, together(8);
  const auto text_of = [&](size_t i) {
    const isoshade::Compilation made = isoshade::compile_file(graphs + names[i % std::size(names)]);
    EXPECT_TRUE(made) << made.text;
    std::string text;
    for (const isoshade::File& file : made.files) text += file.name + file.bytes;
    return text;
  };
  for (size_t i = 0; i < together.size(); ++i) alone.push_back(text_of(i));
  std::vector<std::thread> threads;
  for (size_t i = 0; i < together.size(); ++i) threads.emplace_back([&, i] { together[i] = text_of(i); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(together, alone);
}

}  // namespace
