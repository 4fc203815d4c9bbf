// SPDX-License-Identifier: Apache-2.0
// Programs for fixed values of parameters: constants in place of what records hold, and nothing of what they switch off.
#include <algorithm>
#include <gtest/gtest.h>
#include <stdexcept>

#include "compiler/driver/diagram.h"
#include "compiler/driver/explain.h"
#include "compiler/driver/shader.h"
#include "compiler/ir/expansion.h"
#include "compiler/ir/validator.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/targets/targets.h"

namespace isoshade::driver {
namespace {

/// Parameters of all types, all of which the color depends on.
const std::string types = R"json({"isoshade": 1, "effect": "types", "parameters": {
    "on": {"type": "boolean", "value": false}, "count": {"type": "integer", "value": 3, "min": -9, "max": 9},
    "size": {"type": "float", "value": 0.5}, "tint": {"type": "color4", "value": [1, 2, 3, 4]},
    "turn": {"type": "vector3", "value": [1, 2, 3]}, "map": {"type": "filename", "value": ""}},
  "nodes": {"n": {"type": "normal"}, "turned": {"type": "multiply", "in1": "n", "in2": "turn"},
    "picture": {"type": "image", "file": {"link": "map"}, "default": [0.25, 0.5, 0.75]},
    "color": {"type": "expression", "code": "on ? tint.rgb : color3(turned.x, turned.y, turned.z) * size * float(count) + picture",
              "on": "on", "tint": "tint", "turned": "turned", "size": "size", "count": "count", "picture": "picture"}},
  "passes": [{"name": "base", "color": "color"}]})json";

class Fixed : public ::testing::Test {
 protected:
  static support::Source source_of(const std::string& text) {
    return std::make_shared<support::SourceFile>("document.json", text);
  }
  CompileOptions options() {
    CompileOptions options;
    options.library = &library_;
    options.skips.set(interface::Skip::rates, false);  // programs would load what is computed of parameters
    return options;
  }
  Effect compile(const std::string& text, const FixedWords& fixed = {}) { return compile(source_of(text), fixed); }
  Effect compile(const support::Source& source, const FixedWords& fixed = {}) {
    CompileOptions of_effect = options();
    of_effect.fixed = fixed;
    auto effect = source != nullptr ? compile_effect(source, of_effect, diagnostics_) : std::nullopt;
    if (!effect) throw std::runtime_error(diagnostics_.text());
    return *std::move(effect);
  }
  Effect compile_file(const std::string& path, const FixedWords& fixed = {}) {
    return compile(graph::read_source(path, diagnostics_), fixed);
  }
  /// The default values, but for those that are named.
  static FixedWords all_fixed(const ParameterBlock& block, const std::vector<std::pair<std::string, float>>& values = {}) {
    std::vector<float> record = block.defaults();
    for (const auto& [name, value] : values) record[block.word_of(*block.find(name))] = value;
    return {record.begin(), record.end()};
  }
  static uint64_t operations(const Program& program) {
    return ir::expanded_operations(program.module, program.entry)[program.entry];
  }
  /// The words behind those of every object that a program loads.
  static std::vector<uint32_t> parameter_words(const Program& program) {
    std::vector<uint32_t> words;
    for (const ir::Function& function : program.module.functions) {
      std::vector<ir::InstructionId> made(function.values.size(), ir::none);
      for (ir::InstructionId id = 0; id < function.instructions.size(); ++id)
        made[function.instructions[id].first_result] = id;
      for (const ir::Instruction& load : function.instructions) {
        if (load.op != ir::Opcode::load || load.imm != static_cast<uint32_t>(lower::FrameBuffer::objects)) continue;
        const ir::InstructionId index = made[function.operands_of(load)[0]];
        if (index == ir::none || function.instructions[index].op != ir::Opcode::iadd) continue;
        for (const ir::ValueId part : function.operands_of(function.instructions[index]))
          if (made[part] != ir::none && function.instructions[made[part]].op == ir::Opcode::constant &&
              function.instructions[made[part]].imm >= lower::object_word::parameters)
            words.push_back(function.instructions[made[part]].imm - lower::object_word::parameters);
      }
    }
    std::ranges::sort(words);
    return words;
  }

  check::Library library_{ISOSHADE_GRAPHS "/library"};
  support::Diagnostics diagnostics_;
};

TEST_F(Fixed, ParametersOfAllTypesAreNotLoaded) {
  const Effect general = compile(types);
  EXPECT_EQ(parameter_words(general.passes[0].pixel).size(), 11u) << "on, count, size, tint, turn, map";
  const Effect fixed = compile(types, all_fixed(general.parameters));
  EXPECT_EQ(parameter_words(fixed.passes[0].pixel), std::vector<uint32_t>{});
  EXPECT_EQ(ir::validate(fixed.passes[0].pixel.module), "");
  EXPECT_LT(operations(fixed.passes[0].pixel), operations(general.passes[0].pixel));
  EXPECT_EQ(fixed.parameters.word_count(), general.parameters.word_count()) << "records stay";
}

TEST_F(Fixed, AVectorOfWhichOneWordIsUnknownIsLoadedWhole) {
  const Effect general = compile(types);
  FixedWords words = all_fixed(general.parameters, {{"on", 1.0f}});
  const size_t tint = general.parameters.word_of(*general.parameters.find("tint"));
  words[tint + 1].reset();
  const auto first = static_cast<uint32_t>(tint);
  EXPECT_EQ(parameter_words(compile(types, words).passes[0].pixel), (std::vector<uint32_t>{first, first + 1, first + 2, first + 3}));
}

TEST_F(Fixed, ASwitchLeavesOneSide) {
  const Effect general = compile(types);
  FixedWords on(general.parameters.word_count());
  on[0] = 1.0f;
  EXPECT_EQ(parameter_words(compile(types, on).passes[0].pixel), (std::vector<uint32_t>{3, 4, 5, 6})) << "tint";
  on[0] = 0.0f;
  EXPECT_EQ(parameter_words(compile(types, on).passes[0].pixel).size(), 6u) << "all but on and tint";
}

TEST_F(Fixed, RepetitionsOfAFixedNumberAreCountedWhenCompiled) {
  const std::string text = R"json({"isoshade": 1, "effect": "shells", "parameters": {"shells": {"type": "float", "value": 4, "min": 1, "max": 9}},
    "nodes": {"n": {"type": "passcount"}, "i": {"type": "passindex"},
              "color": {"type": "expression", "code": "color3(float(i) / float(n))", "i": "i", "n": "n"}},
    "passes": [{"name": "base", "repeat": "shells", "color": "color"}]})json";
  const auto reads_repetition = [](const Program& program) { return program.bindings.size(); };
  EXPECT_EQ(reads_repetition(compile(text).passes[0].pixel), 2u);
  EXPECT_EQ(reads_repetition(compile(text, {4.75f}).passes[0].pixel), 1u) << "the index";
  EXPECT_EQ(reads_repetition(compile(text, {1.0f}).passes[0].pixel), 0u);
}

TEST_F(Fixed, PostsAndCutOutsAndVerticesAreSpecialised) {
  const std::string moving = R"json({"isoshade": 1, "effect": "moving", "parameters": {"by": {"type": "float", "value": 0}, "cut": {"type": "float", "value": 0}},
    "nodes": {"p": {"type": "position"}, "uv": {"type": "texcoord"},
              "away": {"type": "expression", "code": "by > 0 ? p + vector3(by * sin(9 * p.x)) : p", "p": "p", "by": "by"},
              "drawn": {"type": "expression", "code": "cut > 0 ? uv.x > cut : uv.y > 0.5", "uv": "uv", "cut": "cut"}},
    "passes": [{"name": "base", "position": "away", "cutout": "drawn", "color": [1, 1, 1]}]})json";
  const Effect general = compile(moving), still = compile(moving, {0.0f, 0.0f});
  EXPECT_LT(operations(still.passes[0].vertex), operations(general.passes[0].vertex));
  EXPECT_LT(operations(*still.passes[0].cutout), operations(*general.passes[0].cutout));
  const std::string gain = R"json({"isoshade": 1, "post": "gain", "parameters": {"gain": {"type": "float", "value": 1}},
    "nodes": {"c": {"type": "scenecolor"}, "out": {"type": "expression", "code": "gain > 0 ? c * gain : c", "c": "c", "gain": "gain"}},
    "outputs": {"color": "out"}})json";
  CompileOptions of_post = options();
  const auto any = compile_post(source_of(gain), of_post, diagnostics_);
  of_post.fixed = {0.0f};
  const auto off = compile_post(source_of(gain), of_post, diagnostics_);
  ASSERT_TRUE(any && off) << diagnostics_.text();
  EXPECT_LT(operations(off->program), operations(any->program));
  EXPECT_TRUE(off->is_pointwise);
}

/// The 34 parameters of a surface with many layers, of which a scene uses three.
TEST_F(Fixed, LayersThatAreOffCostNothing) {
  const std::string folder = ISOSHADE_DOCUMENTS;
  const Effect general = compile_file(folder + "/layers.json");
  ASSERT_GE(general.parameters.fields.size(), 30u);
  const FixedWords three = all_fixed(general.parameters, {{"detail", 0.3f}, {"pattern", 0.5f}, {"rim", 1.5f}});
  const Effect fixed = compile_file(folder + "/layers.json", three);
  const Effect by_hand = compile_file(folder + "/layers_trimmed.json");
  const uint64_t all = operations(general.passes[0].pixel), left = operations(fixed.passes[0].pixel),
                 trimmed = operations(by_hand.passes[0].pixel);
  EXPECT_LE(left, all * 4 / 10) << all << " -> " << left;
  EXPECT_LE(left, trimmed * 11 / 10) << trimmed << " by hand";
  RecordProperty("operations", std::to_string(all) + " -> " + std::to_string(left) + ", by hand " + std::to_string(trimmed));
}

TEST_F(Fixed, PureShadersKeepTheStructAndLoseTheCode) {
  const support::Source source = graph::read_source(std::string(ISOSHADE_DOCUMENTS) + "/layers.json", diagnostics_);
  const auto text_for = [&](const FixedWords& fixed) {
    CompileOptions of_shader = options();
    of_shader.fixed = fixed;
    const auto shader = compile_shader(source, of_shader, {}, diagnostics_);
    return shader ? text(*shader, *targets::find("glsl")) : "";
  };
  const Effect general = compile(source);
  const std::string all = text_for({});
  const std::string few = text_for(all_fixed(general.parameters, {{"rim", 1.0f}}));
  ASSERT_NE(few, "") << diagnostics_.text();
  for (const char* field : {"float rim;", "float dissolve;", "vec3 edge_color;"}) {
    EXPECT_NE(all.find(field), std::string::npos) << field;
    EXPECT_NE(few.find(field), std::string::npos) << field << " is a field still";
  }
  for (const char* gone : {"iso_fractal3d", "iso_worleynoise2d", "parameters.", "texcoord"}) {
    EXPECT_NE(all.find(gone), std::string::npos) << gone;
    EXPECT_EQ(few.find(gone), std::string::npos) << gone;
  }
  EXPECT_LT(2 * few.size(), all.size());
}

TEST_F(Fixed, ExplainTellsWhatIsComputedWhatIsConstantAndWhatFellAway) {
  const std::string text = R"json({"isoshade": 1, "effect": "rimmed", "parameters": {
      "rim": {"type": "float", "value": 1, "min": 0, "max": 1}, "tint": {"type": "color3", "value": [1, 1, 1]}},
    "nodes": {"n": {"type": "normal"}, "v": {"type": "viewdirection"}, "facing": {"type": "dotproduct", "in1": "n", "in2": "v"},
      "edge": {"type": "power", "in1": "facing", "in2": 3.5}, "half": {"type": "multiply", "in1": "rim", "in2": 0.5},
      "lit": {"type": "expression", "code": "rim > 0 ? tint * (facing + edge * half) : tint * (facing + half)",
              "rim": "rim", "tint": "tint", "facing": "facing", "edge": "edge", "half": "half"}},
    "passes": [{"name": "base", "color": "lit"}]})json";
  const auto general = compile_shader(source_of(text), options(), {}, diagnostics_);
  CompileOptions of_off = options();
  of_off.fixed = {0.0f, std::nullopt, std::nullopt, std::nullopt};
  const auto off = compile_shader(source_of(text), of_off, {}, diagnostics_);
  ASSERT_TRUE(general && off) << diagnostics_.text();
  const Explanation explanation = explain(*general, *off);
  EXPECT_LT(explanation.after, explanation.before);
  EXPECT_EQ(explanation.left_out(), (std::set<std::string>{"edge", "half"}));
  const auto fate = [&](const std::string& id) { return *std::ranges::find(explanation.nodes, id, &NodeFate::id); };
  EXPECT_GT(fate("facing").after, 0u);
  EXPECT_GT(fate("edge").before, 20u) << "a power";
  EXPECT_TRUE(explain(*general, *general).left_out().empty());
  const std::string lines = driver::text(explanation, *off);
  EXPECT_EQ(lines.find("effect rimmed for fixed rim: "), 0u) << lines;
  EXPECT_LT(lines.find("computed:"), lines.find("left out:")) << lines;
  const std::string diagram = draw(*general->typed, 0, explanation.left_out());
  const std::string_view grey = "fontcolor=\"#9ca3af\"";
  EXPECT_NE(diagram.find(grey), diagram.rfind(grey)) << "both of them";
  EXPECT_EQ(draw(*general->typed, 0).find(grey), std::string::npos);
}

}  // namespace
}  // namespace isoshade::driver
