// SPDX-License-Identifier: Apache-2.0
// What a reflection says of a document. That it suffices to bind a shader is the promise of reflect_binding_test.cpp.
#include "compiler/reflect/reflect.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <iterator>

#include "compiler/driver/fixed_settings.h"

namespace isoshade::reflect {
namespace {

/// `fixed`: as `compile --set` takes them.
Reflection reflection_of(const std::string& text, const ReflectOptions& options = {},
                         const driver::ShaderOptions& shader_options = {}, const std::vector<std::string>& fixed = {}) {
  support::Diagnostics diagnostics;
  check::Library library;
  driver::CompileOptions compile_options;
  compile_options.library = &library;
  const auto source = std::make_shared<support::SourceFile>("fur.json", text);
  const driver::Checked document = driver::check_document(source, compile_options, diagnostics);
  auto words = document ? driver::fixed_words(*document, fixed, diagnostics) : std::nullopt;
  compile_options.fixed = words.value_or(driver::FixedWords());
  const auto shader =
      words ? driver::compile_shader(document, compile_options, shader_options, diagnostics) : std::nullopt;
  EXPECT_TRUE(shader) << diagnostics.text();
  if (!shader) return {};
  auto made = reflect(*shader, options, diagnostics);
  EXPECT_TRUE(made) << diagnostics.text();
  return made.value_or(Reflection{});
}

const Struct& struct_of(const Reflection& reflection, StructRole role) {
  static const Struct none;
  const auto found = std::ranges::find(reflection.structs, role, &Struct::role);
  EXPECT_NE(found, reflection.structs.end());
  return found == reflection.structs.end() ? none : *found;
}

const Function& function_of(const Reflection& reflection, FunctionRole role, const Text& pass) {
  static const Function none;
  for (const Function& function : reflection.functions)
    if (function.role == role && function.pass == pass) return function;
  ADD_FAILURE() << "no function of pass " << pass;
  return none;
}

List<Text> names(const List<StructField>& fields) {
  List<Text> all;
  for (const StructField& field : fields) all.push_back(field.name);
  return all;
}
List<Text> texts(const List<HostName>& words) {
  List<Text> all;
  for (const HostName& word : words) all.push_back(word.text);
  return all;
}

const char* const fur = R"({"isoshade": 1, "effect": "fur", "doc": "Hair.",
  "parameters": {
    "tint": {"type": "color3", "value": [0.1, 0.2, 0.3], "min": 0, "max": 1, "doc": "linear"},
    "hairs": {"type": "boolean", "value": true},
    "mode": {"type": "integer", "value": "hard", "enum": ["soft", "hard"]},
    "map": {"type": "filename", "value": "fur.png"}},
  "nodes": {
    "uv": {"type": "texcoord"},
    "width": {"type": "fwidth", "in": "uv"},
    "smooth": {"type": "image", "file": {"link": "map"}, "to": "color3"},
    "rough": {"type": "image", "file": {"link": "map"}, "filtertype": "closest", "uaddressmode": "clamp", "to": "color3"},
    "facing": {"type": "normal", "space": "view"},
    "turned": {"type": "convert", "in": "facing", "to": "color3"},
    "hardness": {"type": "convert", "in": "mode", "to": "float"},
    "light": {"type": "lightcolor"},
    "lit": {"type": "sum_lights", "in": "light"},
    "color": {"type": "expression", "code": "(smooth + rough) * tint * lit * turned * width.x * hardness", "smooth": "smooth",
              "rough": "rough", "tint": "tint", "lit": "lit", "turned": "turned", "width": "width", "hardness": "hardness"},
    "p": {"type": "position", "space": "view"},
    "moved": {"type": "add", "in1": "p", "in2": 1}},
  "passes": [
    {"name": "skin", "color": "color"},
    {"name": "hair", "cull": "front", "position": "moved", "position_space": "view", "enabled": "hairs", "color": "tint"}]})";

TEST(Reflect, NamesTheParameterOfEveryFieldAndItsComponent) {
  const Reflection made = reflection_of(fur);
  const Struct& parameters = struct_of(made, StructRole::parameters);
  ASSERT_EQ(names(parameters.fields), (List<Text>{"tint", "hairs", "mode", "map"}));
  EXPECT_EQ(parameters.fields[1].parameter, "hairs");
  EXPECT_EQ(parameters.fields[1].first, 0);
  EXPECT_EQ(parameters.fields[1].image, std::nullopt);
  EXPECT_EQ(parameters.fields[3].parameter, std::nullopt);
  EXPECT_EQ(parameters.fields[3].image, "map");
  ASSERT_EQ(made.parameters.size(), 4u);
  EXPECT_EQ(made.parameters[0].fields, List<Text>{"tint"});
  EXPECT_EQ(made.parameters[3].fields, List<Text>()) << "a file name is no field";
  EXPECT_EQ(made.parameters[2].names, (List<Text>{"soft", "hard"}));
  EXPECT_EQ(made.parameters[0].doc, "linear");
  EXPECT_EQ(made.parameters[0].max, 1.0f);
}

TEST(Reflect, SaysWhatEveryFieldOfASurfaceHolds) {
  const Reflection made = reflection_of(fur);
  for (const StructField& field : struct_of(made, StructRole::surface).fields) {
    ASSERT_TRUE(field.attribute) << field.name;
    EXPECT_TRUE(field.doc) << field.name;
    const bool has_space = field.attribute->text != "texcoord";
    EXPECT_EQ(field.space.has_value(), has_space) << field.name;
    if (!has_space) continue;
    EXPECT_EQ(field.space->text, field.attribute->text == "normal" ? "view" : "world") << field.name;
  }
  for (const Direction direction : {Direction::x, Direction::y})
    EXPECT_TRUE(std::ranges::any_of(struct_of(made, StructRole::surface).fields,
                                    [&](const StructField& field) {
                                      return field.attribute->text == "texcoord" && field.change == direction;
                                    }))
        << "fwidth asks for the change of texcoord";
  EXPECT_EQ(struct_of(made, StructRole::vertex).fields[0].attribute->text, "position");
}

TEST(Reflect, ListsTheWaysInWhichAnImageIsRead) {
  const Reflection made = reflection_of(fur);
  ASSERT_EQ(made.images.size(), 1u);
  const Image& map = made.images[0];
  EXPECT_EQ(map.file, "fur.png");
  EXPECT_EQ(map.parameter, "map");
  EXPECT_EQ(map.field, "map");
  EXPECT_EQ(map.decoding, Decoding::srgb_if_8_bits);
  ASSERT_EQ(map.samplings.size(), 2u);
  EXPECT_EQ(map.samplings[1].filter.text, "closest");
  EXPECT_EQ(map.samplings[1].u.text, "clamp");
  EXPECT_EQ(map.samplings[1].v.text, "periodic");
}

TEST(Reflect, NamesTheParametersThatChooseHowAnImageIsRead) {
  const Reflection made = reflection_of(R"({"isoshade": 1, "effect": "e", "parameters": {
    "wrap": {"type": "integer", "enum": ["periodic", "clamp"], "value": "clamp"},
    "filter": {"type": "integer", "enum": ["closest", "linear"], "value": "closest"}},
    "nodes": {"map": {"type": "image", "file": "a.png", "vaddressmode": {"link": "wrap"}, "filtertype": {"link": "filter"}}},
    "passes": [{"name": "base", "color": "map"}]})");
  ASSERT_EQ(made.images.size(), 1u);
  ASSERT_EQ(made.images[0].samplings.size(), 1u);
  const Sampling& sampling = made.images[0].samplings[0];
  EXPECT_EQ(sampling.filter.text, "closest");
  EXPECT_EQ(sampling.u.text, "periodic");
  EXPECT_EQ(sampling.v.text, "clamp");
  EXPECT_EQ(sampling.filter_parameter, "filter");
  EXPECT_EQ(sampling.u_parameter, std::nullopt);
  EXPECT_EQ(sampling.v_parameter, "wrap");
}

TEST(Reflect, SaysOfEveryPassWhatItsFunctionsReadAndAsk) {
  const Reflection made = reflection_of(fur);
  EXPECT_TRUE(made.lights);
  ASSERT_EQ(made.passes.size(), 2u);
  EXPECT_EQ(made.passes[1].enabled, "hairs");
  EXPECT_EQ(made.passes[1].position_space, SpaceName{"view"});
  EXPECT_FALSE(made.passes[0].moves_vertices);
  EXPECT_EQ(made.functions.size(), 3u);
  const List<Text> asked = texts(function_of(made, FunctionRole::shade, "skin").host);
  for (const char* name : {"light_count", "light", "texel", "image_size"})
    EXPECT_EQ(std::ranges::count(asked, name), 1) << name;
  const Function& plain = function_of(made, FunctionRole::shade, "hair");
  EXPECT_EQ(plain.host, List<HostName>());
  EXPECT_EQ(plain.reads, List<Text>());
  EXPECT_EQ(plain.parameters, List<Text>{"tint"});
  EXPECT_EQ(plain.returns, "vec4");
  const Function& moving = function_of(made, FunctionRole::move_vertex, "hair");
  EXPECT_EQ(moving.returns, "vec3");
  EXPECT_EQ(moving.reads.size(), 1u);
  for (const HostFunction& function : made.host) EXPECT_FALSE(function.doc.empty()) << function.name.text;
}

TEST(Reflect, GivesTheInputsAndOutputsOfAFunction) {
  const Reflection made = reflection_of(R"({"isoshade": 1, "function": "split", "inputs": {
      "n": {"type": "vector3", "unit": true}, "m": {"type": "matrix33"}, "k": {"type": "integer", "value": 2, "min": 0}},
    "nodes": {"a": {"type": "transformmatrix", "in": "n", "mat": "m"}, "l": {"type": "convert", "in": "k", "to": "float"},
      "b": {"type": "multiply", "in1": "n", "in2": "l"}},
    "outputs": {"turned": "a", "scaled": "b"}})");
  EXPECT_EQ(made.kind.text, "function");
  ASSERT_EQ(made.functions.size(), 1u);
  List<Text> types;
  for (const Argument& argument : made.functions[0].arguments) types.push_back(argument.type);
  EXPECT_EQ(types, (List<Text>{"vec3", "vec3", "vec3", "vec3", "int"}));
  EXPECT_EQ(made.functions[0].arguments[3].parameter, "m");
  EXPECT_EQ(made.functions[0].arguments[3].first, 6);
  EXPECT_EQ(made.parameters[0].unit, true);
  ASSERT_EQ(made.outputs.size(), 2u);
  EXPECT_EQ(made.outputs[0].type.text, "vector3");
  const Struct& results = struct_of(made, StructRole::results);
  EXPECT_EQ(results.glsl, made.functions[0].returns);
  EXPECT_EQ(names(results.fields), (List<Text>{"turned", "scaled"}));
}

TEST(Reflect, SaysWhichPicturesAPostReads) {
  const Reflection made = reflection_of(R"({"isoshade": 1, "post": "glow", "images": ["bright", "unused"],
    "parameters": {"on": {"type": "boolean", "value": true}}, "enabled": "on",
    "nodes": {"a": {"type": "scenecolor"}, "b": {"type": "scenecolor", "image": "bright"}, "c": {"type": "add", "in1": "a", "in2": "b"}},
    "outputs": {"color": "c"}})");
  ASSERT_EQ(made.pictures.size(), 3u);
  EXPECT_EQ(made.pictures[0].name, "color");
  EXPECT_TRUE(made.pictures[0].read);
  EXPECT_TRUE(made.pictures[1].read);
  EXPECT_FALSE(made.pictures[2].read);
  EXPECT_EQ(made.pictures[2].number, 2);
  EXPECT_FALSE(made.depth);
  EXPECT_EQ(made.enabled, "on");
}

TEST(Reflect, ProvesOnlyIfAsked) {
  const std::string quotient =
      R"({"isoshade": 1, "function": "q", "inputs": {"x": {"type": "float", "min": LEAST, "max": 2}},
    "nodes": {"d": {"type": "divide", "in1": 1, "in2": "x"}}, "outputs": {"out": "d"}})";
  const auto with = [&](const std::string& least) {
    std::string text = quotient;
    return text.replace(text.find("LEAST"), 5, least);
  };
  EXPECT_FALSE(reflection_of(with("1")).proofs);
  ReflectOptions prove;
  prove.prove = true;
  const Reflection proved = reflection_of(with("1"), prove);
  ASSERT_TRUE(proved.proofs);
  ASSERT_EQ(proved.proofs->size(), 1u);
  const Proof& proof = proved.proofs->front();
  EXPECT_EQ(proof.outcome, Outcome::proved);
  ASSERT_EQ(proof.results.size(), 1u);
  EXPECT_EQ(proof.results[0].low, 0.5);
  EXPECT_EQ(proof.results[0].high, 1.0);
  ASSERT_TRUE(proof.results[0].ulps);
  EXPECT_NEAR(*proof.results[0].ulps, 1, 0.01) << "one division, correctly rounded";
  const Reflection refuted = reflection_of(with("0"), prove);
  ASSERT_TRUE(refuted.proofs);
  EXPECT_EQ(refuted.proofs->front().outcome, Outcome::refuted);
  EXPECT_EQ(refuted.proofs->front().refuted, 1);
  EXPECT_TRUE(refuted.proofs->front().results.empty());
}

TEST(Reflect, ProvesTheFunctionsForTheValuesForWhichTheyAreCompiled) {
  const std::string effect = R"json({"isoshade": 1, "effect": "e", "parameters": {
      "by": {"type": "float", "value": 1, "min": 0, "max": 4}, "tint": {"type": "color3", "value": [1, 1, 1], "min": 0, "max": 1},
      "times": {"type": "integer", "value": 1, "min": 1, "max": 8}, "on": {"type": "boolean", "value": true}},
    "nodes": {"i": {"type": "passindex"}, "share": {"type": "convert", "in": "i", "to": "float"},
      "q": {"type": "divide", "in1": "tint", "in2": "by"},
      "color": {"type": "expression", "code": "on ? q + color3(share) : color3(1 / share)", "on": "on", "q": "q", "share": "share"}},
    "passes": [{"name": "base", "repeat": "times", "color": "color"}]})json";
  ReflectOptions prove;
  prove.prove = true;
  const auto proof_for = [&](const std::vector<std::string>& fixed) { return reflection_of(effect, prove, {}, fixed).proofs->front(); };
  EXPECT_EQ(proof_for({}).refuted, 2) << "by `by`, and by `share` in the first repetition";
  EXPECT_EQ(proof_for({"by=2"}).refuted, 1);
  EXPECT_EQ(proof_for({"by=0", "on=true"}).refuted, 1) << "a value that breaks it";
  const Proof proof = proof_for({"by=2", "on=true", "tint=0.25,0.5,1", "times=3"});
  EXPECT_EQ(proof.outcome, Outcome::proved);
  ASSERT_GE(proof.results.size(), 3u);
  const double least[] = {0.125, 0.25, 0.5};
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(proof.results[c].low, least[c]);
    EXPECT_EQ(proof.results[c].high, least[c] + 2) << "the last of three repetitions";
  }
}

/// What is left out, by skip, node and number of operations; of no node: by what it is.
struct Left {
  Text skip, node;
  Integer operations;
  bool operator==(const Left&) const = default;
};
void PrintTo(const Left& left, std::ostream* out) { *out << left.skip << " of " << left.node << ": " << left.operations; }

std::vector<Left> left_out(const Reflection& made) {
  std::vector<Left> all;
  for (const SkippedPart& part : made.skipped) {
    EXPECT_FALSE(part.why.empty()) << part.what;
    all.push_back({part.skip.text, part.node.value_or(part.what), part.operations.value_or(0)});
  }
  return all;
}

/// An effect of which ranges decide a clamp, a choice needs expensive noise on one side, and a switch chooses.
const char* const skipping = R"json({"isoshade": 1, "effect": "e", "parameters": {
    "k": {"type": "float", "value": 0.5, "min": 0, "max": 1}, "mode": {"type": "integer", "enum": ["plain", "noisy"], "value": "noisy"},
    "gain": {"type": "float", "value": 1, "min": -4, "max": 4}},
  "nodes": {"uv": {"type": "texcoord"},
    "held": {"type": "clamp", "in": "k", "low": 0, "high": 1},
    "noise": {"type": "fractal3d", "to": "float"},
    "rough": {"type": "expression", "code": "uv.x > 0.5 ? noise : 0", "uv": "uv", "noise": "noise"},
    "twice": {"type": "multiply", "in1": "gain", "in2": 2},
    "chosen": {"type": "ifequal", "value1": "mode", "value2": 1, "in1": "rough", "in2": "twice"},
    "color": {"type": "expression", "code": "color3(chosen + held)", "chosen": "chosen", "held": "held"}},
  "passes": [{"name": "base", "color": "color"}]})json";

TEST(Reflect, TellsWhatRangesAndBranchesLeaveOutNodeByNode) {
  const std::vector<Left> left = left_out(reflection_of(skipping));
  const auto of = [&](const Text& skip) {
    std::vector<Left> some;
    std::ranges::copy_if(left, std::back_inserter(some), [&](const Left& one) { return one.skip == skip; });
    return some;
  };
  EXPECT_EQ(of("parameters"), std::vector<Left>{});
  ASSERT_EQ(of("ranges").size(), 1u) << testing::PrintToString(left);
  EXPECT_EQ(of("ranges")[0].node, "held");
  EXPECT_GT(of("ranges")[0].operations, 0);
  ASSERT_EQ(of("branches").size(), 3u) << testing::PrintToString(left);
  EXPECT_EQ(of("branches")[0].node, "noise");
  EXPECT_GT(of("branches")[0].operations, 100);
  EXPECT_EQ(of("branches")[1], (Left{"branches", "rough", 1}));
  EXPECT_EQ(of("branches")[2], (Left{"branches", "twice", 1}));
  EXPECT_EQ(of("ranges").size() + of("branches").size(), left.size());
}

TEST(Reflect, TellsWhatFixedValuesLeaveOutNodeByNode) {
  const Reflection plain = reflection_of(skipping, {}, {}, {"mode=plain", "gain=0.75"});
  std::vector<Left> of_values;
  for (const Left& left : left_out(plain))
    if (left.skip == "parameters") of_values.push_back(left);
  ASSERT_EQ(of_values.size(), 5u) << testing::PrintToString(of_values);
  EXPECT_EQ(of_values[0], (Left{"parameters", "parameters mode, gain of the effect e", 0}));
  EXPECT_EQ(of_values[1].node, "noise");
  EXPECT_GT(of_values[1].operations, 100);
  EXPECT_EQ(of_values[2].node, "rough");
  EXPECT_EQ(of_values[3], (Left{"parameters", "twice", 1}));
  EXPECT_EQ(of_values[4].node, "chosen");
  const auto twice = std::ranges::find(plain.skipped, Optional<Text>("twice"), &SkippedPart::node);
  EXPECT_EQ(twice->what, "all operations of twice");
  EXPECT_EQ(twice->why, "the fixed values decide it, and it is 1.5");
}

TEST(Reflect, TellsOfLargeFunctionsWithoutTheirNodes) {
  const auto with_noises = [](int count) {
    std::string nodes = R"("place": {"type": "position"}, "held": {"type": "clamp", "in": "k", "low": 0, "high": 1},
      "sum0": {"type": "add", "in1": "held", "in2": "gain"})";
    for (int i = 1; i <= count; ++i) {
      const std::string number = std::to_string(i);
      nodes += R"(, "at)" + number + R"(": {"type": "multiply", "in1": "place", "in2": )" + number + R"(}, "noise)" + number +
               R"(": {"type": "noise3d", "position": "at)" + number + R"(", "to": "float"}, "sum)" + number +
               R"(": {"type": "add", "in1": "sum)" + std::to_string(i - 1) + R"(", "in2": "noise)" + number + R"("})";
    }
    return R"({"isoshade": 1, "effect": "e", "parameters": {"k": {"type": "float", "value": 0.5, "min": 0, "max": 1},
      "gain": {"type": "float", "value": 1}}, "nodes": {)" + nodes + R"(, "color": {"type": "convert", "in": "sum)" +
           std::to_string(count) + R"(", "to": "color3"}}, "passes": [{"name": "base", "color": "color"}]})";
  };
  const auto told = [&](int count) { return left_out(reflection_of(with_noises(count), {}, {}, {"gain=2"})); };
  EXPECT_GT(told(1).size(), 1u);
  EXPECT_EQ(told(260), (std::vector<Left>{{"parameters", "parameter gain of the effect e", 0}}));
}

TEST(Reflect, TellsOfNothingWhereNothingIsLeftOut) {
  EXPECT_EQ(left_out(reflection_of(R"json({"isoshade": 1, "effect": "e", "parameters": {"gain": {"type": "float", "value": 1}},
    "nodes": {"uv": {"type": "texcoord"}, "color": {"type": "expression", "code": "color3(uv.x * gain)", "uv": "uv", "gain": "gain"}},
    "passes": [{"name": "base", "color": "color"}]})json")),
            std::vector<Left>{});
}

TEST(Reflect, SaysWhetherBlackLightsMayBeLeftOut) {
  const auto of = [](const std::string& term) {
    return reflection_of(R"({"isoshade": 1, "effect": "e", "nodes": {"light": {"type": "lightcolor"}, "way": {"type": "lightdirection"},
        "half": {"type": "multiply", "in1": "light", "in2": 0.5}, "toward": {"type": "convert", "in": "way", "to": "color3"},
        "sum": {"type": "sum_lights", "in": ")" + term + R"("}},
      "passes": [{"name": "base", "color": "sum"}]})").black_lights;
  };
  ASSERT_TRUE(of("half"));
  EXPECT_TRUE(of("half")->left_out);
  EXPECT_FALSE(of("half")->why.empty());
  ASSERT_TRUE(of("toward"));
  EXPECT_FALSE(of("toward")->left_out);
  EXPECT_EQ(of("toward")->why, "\"sum\" sums up what does not depend on the colors of lights");
  EXPECT_FALSE(reflection_of(R"({"isoshade": 1, "effect": "e", "passes": [{"name": "base", "color": [1, 0, 0]}]})").black_lights)
      << "it asks for no lights";
}

}  // namespace
}  // namespace isoshade::reflect
