// SPDX-License-Identifier: Apache-2.0
// What programs that are compiled still read of records and of images.
#include <algorithm>
#include <array>
#include <filesystem>
#include <gtest/gtest.h>
#include <stdexcept>

#include "compiler/driver/reads.h"
#include "compiler/driver/texture_flow.h"
#include "compiler/graph/files.h"
#include "compiler/ir/printer.h"
#include "compiler/ir/record_words.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/lower/stages.h"
#include "tests/unit/ir_text.h"

namespace isoshade::driver {
namespace {

class Reads : public ::testing::Test {
 protected:
  /// Compiles for these values of parameters, and any values of the others.
  Effect compile(const std::string& text, const std::vector<std::pair<std::string, float>>& values = {},
                 interface::Skips skips = {}) {
    CompileOptions options;
    options.library = &library_;
    options.skips = skips;
    const auto source = std::make_shared<support::SourceFile>("document.json", text);
    auto effect = check_effect(source, options, diagnostics_);
    if (!effect) throw std::runtime_error(diagnostics_.text());
    options.fixed.resize(effect->parameters.word_count());
    for (const auto& [name, value] : values)
      options.fixed[effect->parameters.word_of(*effect->parameters.find(name))] = value;
    make_programs(*effect, options);
    return *std::move(effect);
  }

  /// "first: levels, second: -" of the images of the effect.
  static std::string text(const Effect& effect) {
    const std::vector<ImageReads> reads = images_read(effect);
    std::string text;
    for (size_t i = 0; i < reads.size(); ++i)
      text += (i == 0 ? "" : ", ") + effect.parameters.images[i].slot.name + ": " +
              (reads[i].levels ? "levels"
               : reads[i].any  ? "texels"
                               : "-");
    return text;
  }
  std::string reads(const std::string& document,
                    const std::vector<std::pair<std::string, float>>& values = {}) {
    // What is the same for a draw is read by another program, and found there.
    interface::Skips without;
    without.set(interface::Skip::rates, false);
    std::string found = text(compile(document, values));
    EXPECT_EQ(found, text(compile(document, values, without)));
    return found;
  }

  check::Library library_{ISOSHADE_GRAPHS "/library"};
  support::Diagnostics diagnostics_;
};

/// Two images by one filter, of which a strength switches the second off.
std::string two_images(const std::string& more = "") {
  return R"json({"isoshade": 1, "effect": "two", "parameters": {
      "first": {"type": "filename", "value": "a.png"}, "second": {"type": "filename", "value": "b.png"},
      "filter": {"type": "integer", "enum": ["closest", "linear", "trilinear"], "value": 1},
      "other": {"type": "integer", "enum": ["closest", "linear", "trilinear"], "value": 1},
      "strength": {"type": "float", "value": 1, "min": 0, "max": 1}, "hole": {"type": "float", "value": 0, "min": 0, "max": 1},
      "outline": {"type": "boolean", "value": false}},
    "nodes": {"uv": {"type": "texcoord"},
      "a": {"type": "image", "file": {"link": "first"}, "filtertype": {"link": "filter"}},
      "b": {"type": "image", "file": {"link": "second"}, "filtertype": {"link": "other"}, "texcoord": "uv.yx"},
      "both": {"type": "expression", "code": "a + b * strength", "a": "a", "b": "b", "strength": "strength"},
      "color": {"type": "ifgreater", "value1": "strength", "value2": 0, "in1": "both", "in2": "a"},
      "holes": {"type": "extract", "in": "b", "index": 0})json" +
         more + "}";
}
const std::string one_pass = R"(, "passes": [{"name": "base", "color": "color"}]})";

TEST_F(Reads, ImagesThatFixedValuesSwitchOffAreNotRead) {
  const std::string document = two_images() + one_pass;
  EXPECT_EQ(reads(document), "first: levels, second: levels");
  EXPECT_EQ(reads(document, {{"strength", 0}}), "first: levels, second: -");
  EXPECT_EQ(reads(document, {{"strength", 0.5f}}), "first: levels, second: levels");
}

TEST_F(Reads, LevelsAreReadByTheFilterThatAsksForThem) {
  const std::string document = two_images() + one_pass;
  for (const float plain : {0.0f, 1.0f}) {
    EXPECT_EQ(reads(document, {{"filter", plain}, {"other", plain}}), "first: texels, second: texels")
        << plain;
    // Both are read by the same functions.
    EXPECT_EQ(reads(document, {{"filter", plain}, {"other", 2}}), "first: texels, second: levels") << plain;
    EXPECT_EQ(reads(document, {{"filter", 2}, {"other", plain}}), "first: levels, second: texels") << plain;
  }
  EXPECT_EQ(reads(document, {{"filter", 1}}), "first: texels, second: levels");
}

TEST_F(Reads, LevelsAreReadForDerivativesToo) {
  const std::string document = two_images(R"(, "slope": {"type": "fwidth", "in": "a"})") +
                               R"(, "passes": [{"name": "base", "color": "slope"}]})";
  EXPECT_EQ(reads(document, {{"filter", 1}}), "first: texels");
  EXPECT_EQ(reads(document, {{"filter", 2}}), "first: levels");
}

TEST_F(Reads, LayersCountAsLevelsWhereTheseMayBeRead) {
  const auto document = [](const std::string& filter) {
    return R"({"isoshade": 1, "effect": "layered", "parameters": {"n": {"type": "integer", "value": 0}},
      "nodes": {"map": {"type": "image", "file": "a.png", "layer": "n", "filtertype": ")" +
           filter + R"("}}, "passes": [{"name": "base", "color": "map"}]})";
  };
  EXPECT_EQ(reads(document("trilinear")), "map: levels");
  EXPECT_EQ(reads(document("linear")), "map: levels");
}

TEST_F(Reads, PassesAndCutoutsThatAreSwitchedOffReadNothing) {
  const std::string document = two_images() + R"(, "passes": [
    {"name": "base", "color": "a", "cutout": "holes", "cutoff": "hole"},
    {"name": "line", "enabled": "outline", "cull": "front", "color": "both"}]})";
  EXPECT_EQ(reads(document), "first: levels, second: levels");
  EXPECT_EQ(reads(document, {{"outline", 0}}), "first: levels, second: levels");
  EXPECT_EQ(reads(document, {{"hole", 0}}), "first: levels, second: levels");
  EXPECT_EQ(reads(document, {{"outline", 0}, {"hole", 0}}), "first: levels, second: -");
  EXPECT_EQ(reads(document, {{"outline", 1}, {"hole", 0}}), "first: levels, second: levels");
  EXPECT_EQ(reads(document, {{"outline", 0}, {"hole", 0.5f}}), "first: levels, second: levels");
}

TEST_F(Reads, WordsAreThoseThatProgramsLoad) {
  const Effect effect = compile(two_images() + one_pass, {{"filter", 1}, {"other", 0}});
  const std::vector<bool> words = words_read(effect);
  const ParameterBlock& block = effect.parameters;
  ASSERT_EQ(words.size(), block.word_count());
  EXPECT_TRUE(words[block.word_of(*block.find("strength"))]);
  for (const char* name : {"filter", "other", "hole", "outline"})
    EXPECT_FALSE(words[block.word_of(*block.find(name))]) << name;
  EXPECT_TRUE(words[block.word_of_image(0)]);
  EXPECT_TRUE(words[block.word_of_image(1)]);
}

/// Otherwise all of their images would count as read.
TEST_F(Reads, OfShippedEffectsShow) {
  size_t programs = 0;
  for (const char* folder : {"/effects", "/materials"}) {
    for (const auto& file :
         std::filesystem::recursive_directory_iterator(std::string(ISOSHADE_GRAPHS) + folder)) {
      const support::Source source =
          file.path().extension() == ".json" ? graph::read_source(file.path(), diagnostics_) : nullptr;
      if (source == nullptr || kind_of(source, diagnostics_) != graph::DocumentKind::effect) continue;
      CompileOptions options;
      options.library = &library_;
      const auto effect = compile_effect(source, options, diagnostics_);
      ASSERT_TRUE(effect) << diagnostics_.text();
      for (const EffectPass& pass : effect->passes)
        for_each_program(pass, [&](const Program& program) {
          ++programs;
          const std::array buffers{static_cast<uint32_t>(lower::FrameBuffer::objects),
                                   static_cast<uint32_t>(lower::FrameBuffer::object_integers)};
          EXPECT_TRUE(ir::loaded_words(program.module, program.entry, lower::record_parameter(program.stage),
                                       buffers))
              << file.path() << " " << description(program);
          if (program.draw == nullptr) return;
          EXPECT_TRUE(ir::loaded_words(program.draw->module, program.draw->entry, 0, buffers)) << file.path();
        });
    }
  }
  EXPECT_GE(programs, 50u);
}

/// What the first function of a text reads of the textures whose numbers its parameters are.
TextureReads follow(const std::string& functions) {
  const ir::Module module = ir::valid(ir::print(lower::frame_module()) + "\n" + functions);
  const ir::Function& f = module.functions[0];
  std::vector<TextureFlow::Known> known;
  for (uint32_t i = 0; i < f.parameters.size(); ++i)
    if (f.parameters[i].type == ir::int_type) known.push_back({f.blocks[0].parameters[i], {{i}, {}}});
  return TextureFlow(module).follow(0, f.parameters.size(), known);
}

using Marks = std::vector<bool>;

/// texture_size, and a function that asks it for the width.
const std::string size = R"(
func @size(%picture: int) -> (width: int, smaller: int) {
  %stride: int = constant int 6
  %at: int = imul %picture, %stride
  %one: int = constant int 1
  %of_width: int = iadd %at, %one
  %width: int = load textures[%of_width]
  %three: int = constant int 3
  %of_smaller: int = iadd %at, %three
  %smaller: int = load textures[%of_smaller]
  return %width, %smaller
}
func @width_of(%picture: int) -> (width: int) {
  %width: int, %smaller: int = call @size(%picture)
  return %width
}
)";

TEST(TextureFlow, AsksFunctionsForTheResultsThatAreRead) {
  const TextureReads reads = follow(R"(
func @main(%a: int, %b: int, %c: int) -> (x: int, y: int) {
  %x: int = call @width_of(%a)
  %unread: int, %y: int = call @size(%b)
  return %x, %y
}
)" + size);
  EXPECT_EQ(reads.own, (Marks{true, true, false}));
  EXPECT_EQ(reads.levels, (Marks{false, true, false}));
}

TEST(TextureFlow, TakesRecordsBehindATextureForItsLevels) {
  const TextureReads reads = follow(R"(
func @main(%a: int, %b: int, %n: int) -> (x: int, y: int) {
  %next: int = iadd %a, %n
  %x: int = call @width_of(%next)
  %y: int = call @width_of(%b)
  return %x, %y
}
)" + size);
  EXPECT_EQ(reads.levels, (Marks{true, false, true}));
}

TEST(TextureFlow, FollowsNumbersThroughBranchesLoopsAndCalls) {
  const TextureReads reads = follow(R"(
func @main(%a: int, %b: int, %c: int, %d: int, %on: bool, %n: int uniform) -> (x: int) {
  %chosen: int = branch %on {
    yield %a
  } else {
    yield %b
  }
  %same: int = call @same(%chosen)
  %p: int, %q: int = loop %i < %n, %first: int = %same, %second: int = %c {
    yield %second, %d
  }
  %x: int = call @width_of(%p)
  return %x
}
func @same(%picture: int) -> (picture: int) {
  return %picture
}
)" + size);
  EXPECT_EQ(reads.own, (Marks{true, true, true, true, false, false}));
  EXPECT_EQ(reads.levels, Marks(6));
}

TEST(TextureFlow, TakesWhatItDoesNotKnowForLevels) {
  const auto levels = [](const std::string& body) {
    return follow("func @main(%a: int, %b: int) -> (x: int) {\n" + body + "  return %x\n}\n" + size).levels;
  };
  EXPECT_EQ(levels("  %x: int = load textures[%a]\n"), (Marks{true, false}));
  EXPECT_EQ(
      levels("  %five: int = constant int 5\n  %at: int = imul %a, %five\n  %x: int = load textures[%at]\n"),
      (Marks{true, false}));
  EXPECT_EQ(levels("  %f = itof %b\n  %x: int = ftoi %f\n"), (Marks{false, true}));
  EXPECT_EQ(
      levels("  %six: int = constant int 6\n  %at: int = imul %a, %six\n  %x: int = load textures[%at]\n"),
      (Marks{false, false}));
}

TEST(TextureFlow, CountsManyNumbersAsRead) {
  // A value that may be one of 70 is not followed; those that are added later count, too.
  std::string parameters, choices;
  constexpr int count = 70;
  for (int i = 0; i < count; ++i) {
    parameters += "%p" + std::to_string(i) + ": int, ";
    if (i > 0)
      choices += "  %v" + std::to_string(i) + ": int = select %on, %p" + std::to_string(i) + ", %" +
                 (i == 1 ? "p" : "v") + std::to_string(i - 1) + "\n";
  }
  const TextureReads reads = follow("func @main(" + parameters + "%on: bool) -> (x: int) {\n" + choices +
                                    "  %x: int = call @width_of(%v69)\n  return %x\n}\n" + size);
  EXPECT_EQ(std::ranges::count(reads.own, true), count);
  EXPECT_GE(std::ranges::count(reads.levels, true), 64);
}

}  // namespace
}  // namespace isoshade::driver
