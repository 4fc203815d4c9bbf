// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <gtest/gtest.h>

#include "compiler/graph/graph.h"

namespace isoshade::graph {
namespace {

using support::Diagnostics;

std::optional<Graph> build(std::string text, Diagnostics& diagnostics) {
  const std::optional<Document> document =
      parse_document(std::make_shared<support::SourceFile>("a.json", std::move(text)), diagnostics);
  return document ? build_graph(*document, diagnostics) : std::nullopt;
}

Graph graph_of(std::string text) {
  Diagnostics diagnostics;
  std::optional<Graph> graph = build(std::move(text), diagnostics);
  EXPECT_EQ(diagnostics.text(), "");
  return graph ? std::move(*graph) : Graph{};
}

std::string said(std::string text) {
  Diagnostics diagnostics;
  EXPECT_FALSE(build(std::move(text), diagnostics).has_value());
  return diagnostics.text();
}

/// The first complaint: "error[id]: message | what is underlined | fix".
std::string first(std::string text) {
  Diagnostics diagnostics;
  EXPECT_FALSE(build(text, diagnostics).has_value());
  if (diagnostics.all().empty()) return "nothing";
  const support::Diagnostic& diagnostic = diagnostics.all()[0];
  std::string out = std::string(id_text(diagnostic.id)) + ": " + diagnostic.message + " | " +
                    text.substr(diagnostic.where.begin, diagnostic.where.end - diagnostic.where.begin);
  return diagnostic.fix.empty() ? out : out + " | " + diagnostic.fix;
}

/// A function document with these nodes.
std::string with_nodes(std::string_view nodes) {
  return R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}}, "nodes": {)" +
         std::string(nodes) + R"(}, "outputs": {"out": "x"}})";
}
std::string with_inputs(std::string_view inputs) {
  return R"({"isoshade": 1, "function": "f", "inputs": {)" + std::string(inputs) +
         R"(}, "outputs": {"out": "x"}})";
}
std::string with_pass(std::string_view pass) {
  return R"({"isoshade": 1, "effect": "e", "passes": [)" + std::string(pass) + "]}";
}

TEST(Build, ReadsEveryPartOfAFunction) {
  const Graph graph = graph_of(R"({
  "$schema": "../schema/isoshade.schema.json", "isoshade": 1,
  "function": "ggx_d", "doc": "GGX.",
  "inputs": {"alpha": {"type": "float", "min": 1e-4, "max": 1, "doc": "roughness"},
             "n_dot_h": {"type": "float", "value": 0.5}},
  "nodes": {"a": {"type": "multiply", "in1": "n_dot_h", "in2": "alpha", "doc": "d", "extras": {"pos": [1, 2]}},
            "b": {"type": "constant", "value": [1, 2.5, -3]}},
  "outputs": {"out": "a", "color": {"link": "b.out.xyz"}}
})");
  EXPECT_EQ(graph.kind, DocumentKind::function);
  EXPECT_EQ(graph.name, "ggx_d");
  EXPECT_EQ(graph.doc, "GGX.");
  ASSERT_EQ(graph.inputs.size(), 2u);
  EXPECT_EQ(graph.inputs[0].name, "alpha");
  EXPECT_EQ(graph.inputs[0].type, Type::floating);
  EXPECT_EQ(graph.inputs[0].min, 1e-4f);
  EXPECT_EQ(graph.inputs[0].max, 1.0f);
  EXPECT_EQ(graph.inputs[0].doc, "roughness");
  EXPECT_FALSE(graph.inputs[0].value.has_value());
  EXPECT_EQ(graph.inputs[1].value->number, 0.5f);
  ASSERT_EQ(graph.nodes.size(), 2u);
  const Node& a = graph.nodes[0];
  EXPECT_EQ(a.id, "a");
  EXPECT_EQ(a.type, "multiply");
  EXPECT_EQ(a.doc, "d");
  ASSERT_EQ(a.ports.size(), 2u);
  EXPECT_EQ(a.ports[0].name, "in1");
  EXPECT_EQ(std::get<Literal>(a.ports[0].value).string, "n_dot_h");
  EXPECT_EQ(std::get<Literal>(graph.nodes[1].ports[0].value).numbers, (std::vector{1.0f, 2.5f, -3.0f}));
  ASSERT_EQ(graph.outputs.size(), 2u);
  EXPECT_EQ(graph.outputs[0].link.name, "a");
  EXPECT_EQ(graph.outputs[1].name, "color");
  EXPECT_EQ(graph.outputs[1].link.selectors, (std::vector<std::string>{"out", "xyz"}));
  EXPECT_TRUE(graph.names.at("alpha").is_input);
  EXPECT_FALSE(graph.names.at("b").is_input);
  EXPECT_EQ(graph.names.at("b").index, 1u);
}

TEST(Build, ReadsParametersAndPassesOfAnEffect) {
  const Graph graph = graph_of(R"({"isoshade": 1, "effect": "toon",
  "parameters": {"outline": {"type": "float", "value": 1e-2, "min": 0, "max": 1},
                 "tint": {"type": "color3", "value": [1, 0, 0.5], "min": 0, "dynamic": true},
                 "map": {"type": "filename", "value": "a.png"},
                 "count": {"type": "integer", "value": 3, "max": 4},
                 "on": {"type": "boolean", "value": true}},
  "nodes": {"lit": {"type": "image", "file": {"link": "map"}}},
  "passes": [{"name": "base", "color": "lit"},
             {"name": "shell", "cull": "front", "depth": "always", "position": "lit.xyz", "color": "tint",
              "position_space": "view", "enabled": "outline", "double_sided": "on", "cutout": "lit.a", "cutoff": 0.25}]})");
  ASSERT_EQ(graph.inputs.size(), 5u);
  EXPECT_EQ(graph.inputs[1].value->numbers.size(), 3u);
  EXPECT_TRUE(graph.inputs[1].dynamic);
  EXPECT_FALSE(graph.inputs[0].dynamic);
  EXPECT_EQ(graph.inputs[2].value->string, "a.png");
  EXPECT_EQ(graph.inputs[3].value->integer, 3);
  EXPECT_TRUE(graph.inputs[4].value->boolean);
  EXPECT_EQ(std::get<Link>(graph.nodes[0].ports[0].value).name, "map");
  ASSERT_EQ(graph.passes.size(), 2u);
  EXPECT_EQ(graph.passes[0].name, "base");
  EXPECT_EQ(graph.passes[0].state.cull, interface::Cull::back);
  EXPECT_EQ(graph.passes[0].state.depth, interface::DepthTest::nearer);
  EXPECT_FALSE(graph.passes[0].position.has_value());
  EXPECT_EQ(graph.passes[0].color.name, "lit");
  EXPECT_EQ(graph.passes[1].state.cull, interface::Cull::front);
  EXPECT_EQ(graph.passes[1].state.depth, interface::DepthTest::always);
  EXPECT_EQ(graph.passes[1].position->selectors, std::vector<std::string>{"xyz"});
  EXPECT_EQ(graph.passes[1].position_space, PositionSpace::view);
  EXPECT_EQ(graph.passes[1].enabled, 0u);
  EXPECT_EQ(graph.passes[1].double_sided, 4u);
  EXPECT_FALSE(graph.passes[0].cutout.has_value());
  EXPECT_EQ(graph.passes[1].cutout->selectors, std::vector<std::string>{"a"});
  EXPECT_EQ(std::get<Literal>(graph.nodes.at(graph.passes[1].cutoff->node).ports[0].value).number, 0.25f);
}

TEST(Build, ReadsOutputsOfAPost) {
  const Graph graph =
      graph_of(R"({"isoshade": 1, "post": "fog", "parameters": {"d": {"type": "float", "value": 0}},
                                   "nodes": {}, "outputs": {"color": "d"}})");
  EXPECT_EQ(graph.kind, DocumentKind::post);
  EXPECT_EQ(graph.outputs[0].name, "color");
}

TEST(Build, TextRangesMatchTheSource) {
  const std::string text = with_nodes(R"("a": {"type": "add", "in1": 1, "in2": "x"})");
  const Graph graph = graph_of(text);
  const auto at = [&](TextRange place) { return text.substr(place.begin, place.end - place.begin); };
  EXPECT_EQ(at(graph.name_place), "\"f\"");
  EXPECT_EQ(at(graph.inputs[0].name_place), "\"x\"");
  EXPECT_EQ(at(graph.inputs[0].place), R"({"type": "float"})");
  EXPECT_EQ(at(graph.nodes[0].id_place), "\"a\"");
  EXPECT_EQ(at(graph.nodes[0].type_place), "\"add\"");
  EXPECT_EQ(at(graph.nodes[0].place), R"({"type": "add", "in1": 1, "in2": "x"})");
  EXPECT_EQ(at(graph.nodes[0].ports[0].name_place), "\"in1\"");
  EXPECT_EQ(at(graph.nodes[0].ports[0].place), "1");
  EXPECT_EQ(at(graph.outputs[0].link.place), "\"x\"");
}

TEST(Build, LiteralsAreRoundedOnceAndNeverDenormal) {
  const Graph graph =
      graph_of(with_nodes(R"("a": {"type": "add", "in1": 1.00000005960464477540, "in2": [-1e-40, 7]})"));
  EXPECT_EQ(std::bit_cast<uint32_t>(std::get<Literal>(graph.nodes[0].ports[0].value).number), 0x3f800001u);
  EXPECT_EQ(std::bit_cast<uint32_t>(std::get<Literal>(graph.nodes[0].ports[1].value).numbers[0]),
            0x80000000u);
  const Graph integers = graph_of(with_nodes(R"("a": {"type": "add", "in1": 16777217, "in2": 2.0})"));
  const Literal& integer = std::get<Literal>(integers.nodes[0].ports[0].value);
  EXPECT_TRUE(integer.integral);
  EXPECT_EQ(integer.integer, 16777217);
  EXPECT_EQ(integer.number, 16777216.0f);
  EXPECT_FALSE(std::get<Literal>(integers.nodes[0].ports[1].value).integral);
}

TEST(Build, ReportsSeveralErrorsInOneRun) {
  EXPECT_EQ(said(R"({
  "isoshade": 1,
  "function": "ggx",
  "inputs": {"alpha": {"type": "flaot"}},
  "nodes": {"2d": {"type": "add", "in1": null}},
  "outputs": {"out": "a..b"},
  "noeds": {}
})"),
            R"(a.json:4:32: error[unknown-type]: there is no type "flaot"
  4 |   "inputs": {"alpha": {"type": "flaot"}},
    |                                ^^^^^^^ did you mean "float"?
  note: the types are boolean integer float vector2 vector3 vector4 color3 color4 matrix33 matrix44
a.json:5:13: error[bad-id]: "2d" is not a valid name of a node
  5 |   "nodes": {"2d": {"type": "add", "in1": null}},
    |             ^^^^
  note: names consist of letters, digits and '_', and do not begin with a digit
a.json:5:42: error[wrong-type]: "in1" cannot be null
  5 |   "nodes": {"2d": {"type": "add", "in1": null}},
    |                                          ^^^^
a.json:6:22: error[bad-link]: "a..b" is not a link
  6 |   "outputs": {"out": "a..b"},
    |                      ^^^^^^
  note: a link is "node", "node.port", "node.xyz" or "node.port.xyz"
a.json:7:3: error[unknown-key]: a function document has no key "noeds"
  7 |   "noeds": {}
    |   ^^^^^^^ did you mean "nodes"?
)");
}

TEST(Build, RequiresTheVersion) {
  EXPECT_EQ(first(R"({"function": "f", "outputs": {"out": "x"}})"),
            "missing-key: the document has no version | { | add \"isoshade\": 1");
  for (const std::string version : {"2", "1.5", "\"1\"", "null"}) {
    EXPECT_EQ(first(R"({"isoshade": )" + version + R"(, "function": "f"})"),
              "wrong-version: this version of isoshade reads documents of version 1 only | " + version);
  }
  EXPECT_EQ(first(R"({"isoshade": 1.0})"), first(R"({"isoshade": 1})"));
}

TEST(Build, RequiresExactlyOneKind) {
  EXPECT_EQ(first(R"({"isoshade": 1})"),
            "wrong-kind: a document must be a function, effect, post, scene or image | { | add \"effect\": \"its_name\", "
            "or another of these keys");
  EXPECT_EQ(first(R"({"isoshade": 1, "function": "f", "effect": "e"})"),
            "wrong-kind: a document has only one kind | \"effect\"");
  EXPECT_EQ(first(R"({"isoshade": 1, "scene": "s"})"),
            "wrong-kind: a scene is not a graph; use a function, effect or post here | \"s\"");
  EXPECT_EQ(first("[1]"), "wrong-type: a document must be an object, not an array | [1]");
  EXPECT_EQ(first(R"({"isoshade": 1, "function": 3, "outputs": {"out": "x"}})"),
            "wrong-type: \"function\" of a function document must be a string, not a number | 3");
}

TEST(Build, FindsTheKindWithoutBuilding) {
  Diagnostics diagnostics;
  const auto kind = [&](std::string text) {
    return document_kind(*parse_document(std::make_shared<support::SourceFile>("a.json", text), diagnostics),
                         diagnostics);
  };
  EXPECT_EQ(kind(R"({"isoshade": 1, "scene": "s"})"), DocumentKind::scene);
  EXPECT_EQ(kind(R"({"post": "p", "isoshade": 1})"), DocumentKind::post);
  EXPECT_FALSE(diagnostics.has_errors());
  EXPECT_EQ(kind(R"({"post": "p"})"), std::nullopt);
}

TEST(Build, RejectsInvalidInputs) {
  EXPECT_EQ(first(with_inputs(R"("x": 1)")), "wrong-type: input \"x\" must be an object, not a number | 1");
  EXPECT_EQ(first(with_inputs(R"("x": {})")), "missing-key: input \"x\" needs the key \"type\" | {");
  EXPECT_EQ(first(with_inputs(R"("x y": {"type": "float"})")),
            "bad-id: \"x y\" is not a valid name of an input | \"x y\"");
  EXPECT_EQ(first(with_inputs(R"("x": {"type": "float", "min": 1, "max": 0})")),
            "out-of-range: the max of input \"x\" is less than its min | 0");
  EXPECT_EQ(first(with_inputs(R"("x": {"type": "float", "value": 2, "max": 1})")),
            "out-of-range: the value of \"x\" is greater than its max 1.0 | 2");
  EXPECT_EQ(first(with_inputs(R"("x": {"type": "vector2", "value": [1, -1], "min": 0})")),
            "out-of-range: the value of \"x\" is less than its min 0.0 | -1");
  EXPECT_EQ(first(with_inputs(R"("x": {"type": "vector3", "value": [1, 2]})")),
            "wrong-type: the value of \"x\" must be vector3 | [1, 2]");
  EXPECT_EQ(first(with_inputs(R"("x": {"type": "integer", "value": 3000000000})")),
            "wrong-type: the value of \"x\" must be integer | 3000000000");
  EXPECT_EQ(first(with_inputs(R"("x": {"type": "string", "value": "a", "min": 0})")),
            "unknown-key: input \"x\" has no key \"min\" | \"min\"");
  EXPECT_EQ(
      first(
          R"({"isoshade": 1, "effect": "e", "parameters": {"x": {"type": "float"}}, "passes": [{"name": "b", "color": "x"}]})"),
      "missing-key: parameter \"x\" needs the key \"value\" | {");
}

TEST(Build, IntegerValuesMayBeEnumNames) {
  const Graph graph = graph_of(R"({"isoshade": 1, "effect": "e", "parameters": {
    "mode": {"type": "integer", "enum": ["one", "two", "three"], "value": "two"},
    "other": {"type": "integer", "enum": ["one", "two"], "value": 0}},
    "passes": [{"name": "b", "color": "mode"}]})");
  EXPECT_EQ(graph.inputs[0].value->kind, Literal::Kind::number);
  EXPECT_EQ(graph.inputs[0].value->integer, 1);
  EXPECT_EQ(graph.inputs[0].value->number, 1.0f);
  EXPECT_EQ(graph.inputs[0].max, 2.0f);
  EXPECT_EQ(graph.inputs[1].value->integer, 0);
  EXPECT_EQ(
      first(with_inputs(R"("x": {"type": "integer", "enum": ["smooth", "shading"], "value": "smoth"})")),
      "unknown-choice: \"x\" has no value named \"smoth\" | \"smoth\" | did you mean \"smooth\"?");
  EXPECT_EQ(first(with_inputs(R"("x": {"type": "integer", "enum": ["a", "b"], "value": 2})")),
            "out-of-range: \"x\" has no value 2 | 2");
  EXPECT_EQ(first(with_inputs(R"("x": {"type": "integer", "value": 7, "max": 5})")),
            "out-of-range: the value of \"x\" is greater than its max 5 | 7");
  EXPECT_EQ(first(with_inputs(R"("x": {"type": "float", "enum": ["a", "b"]})")),
            "wrong-type: \"enum\" is only for integers, not for float | [\"a\", \"b\"]");
  EXPECT_EQ(first(with_inputs(R"("x": {"type": "integer", "enum": []})")),
            "wrong-type: \"enum\" must be an array of 1 to 64 names, not of 0 | []");
  EXPECT_EQ(first(with_inputs(R"("x": {"type": "integer", "enum": ["a", 1]})")),
            "wrong-type: \"enum\" must be an array of names, but contains a number | 1");
  EXPECT_EQ(first(with_inputs(R"("x": {"type": "integer", "enum": ["a", "b c"]})")),
            "bad-id: \"b c\" is not a valid name of a value | \"b c\"");
  EXPECT_EQ(first(with_inputs(R"("x": {"type": "integer", "enum": ["a", "a"]})")),
            "duplicate-name: two values of \"x\" have the name \"a\" | \"a\"");
}

TEST(Build, RejectsInvalidNodes) {
  EXPECT_EQ(first(with_nodes(R"("a": "add")")),
            "wrong-type: node \"a\" must be an object, not a string | \"add\"");
  EXPECT_EQ(first(with_nodes(R"("a": {"in1": 1})")), "missing-key: node \"a\" needs the key \"type\" | {");
  EXPECT_EQ(first(with_nodes(R"("a": {"type": 1})")),
            "wrong-type: \"type\" of node \"a\" must be a string, not a number | 1");
  EXPECT_EQ(first(with_nodes(R"("a": {"type": "add", "in 1": 1})")),
            "bad-id: \"in 1\" is not a valid name of a port | \"in 1\"");
  EXPECT_EQ(first(with_nodes(R"("a": {"type": "add", "in1": []})")),
            "wrong-type: \"in1\" must be an array of 1 to 16 numbers, not of 0 | []");
  EXPECT_EQ(first(with_nodes(R"("a": {"type": "add", "in1": [[1]]})")),
            "wrong-type: \"in1\" must be an array of numbers, but contains an array | [1]");
  EXPECT_EQ(first(with_nodes(R"("a": {"type": "add", "in1": 1e39})")),
            "out-of-range: \"in1\" is beyond the range of float | 1e39");
  EXPECT_EQ(first(with_nodes(R"("a": {"type": "add", "in1": {"lnik": "x"}})")),
            "missing-key: a link needs the key \"link\" | {");
  EXPECT_EQ(first(with_nodes(R"("a": {"type": "add", "in1": {"link": 1}})")),
            "wrong-type: \"link\" of a link must be a string, not a number | 1");
  EXPECT_EQ(first(with_nodes(R"("x": {"type": "add"})")),
            "duplicate-name: a node has the name \"x\" of an input or parameter | \"x\"");
}

TEST(Build, RejectsInvalidPasses) {
  EXPECT_EQ(first(with_pass("")), "missing-key: an effect needs at least one pass | []");
  EXPECT_EQ(first(with_pass(R"({"name": "base"})")), "missing-key: a pass needs the key \"color\" | {");
  EXPECT_EQ(first(with_pass(R"({"name": "b c", "color": "x"})")),
            "bad-id: \"b c\" is not a valid name of a pass | \"b c\"");
  EXPECT_EQ(first(with_pass(R"({"name": "b", "color": "x", "cull": "bak"})")),
            "unknown-choice: \"cull\" of a pass must be one of none, back, front, not \"bak\" | \"bak\" | did you "
            "mean \"back\"?");
  EXPECT_EQ(first(with_pass(R"({"name": "b", "color": true})")),
            "wrong-type: \"color\" must be a link, not a boolean | true");
  EXPECT_EQ(first(with_pass(R"({"name": "b", "color": "x"}, {"name": "b", "color": "y"})")),
            "duplicate-name: two passes have the name \"b\" | \"b\"");
  EXPECT_EQ(
      first(with_pass(R"({"name": "b", "color": "x", "position_space": "view"})")),
      "missing-key: \"position_space\" has no effect without \"position\" | \"view\" | add \"position\", or "
      "remove this key");
  EXPECT_EQ(
      first(with_pass(R"({"name": "b", "color": "x", "position": "x", "position_space": "clip"})")),
      "unknown-choice: \"position_space\" of a pass must be one of world, object, view, not \"clip\" | \"clip\"");
  EXPECT_EQ(first(with_pass(R"({"name": "b", "color": "x", "cutoff": 0.5})")),
            "missing-key: \"cutoff\" has no effect without \"cutout\" | 0.5 | add \"cutout\", or remove this key");
  EXPECT_EQ(first(with_pass(R"({"name": "b", "color": "x", "cutout": "x", "cutoff": true})")),
            "wrong-type: \"cutoff\" must be a number or a link, not a boolean | true");
  EXPECT_EQ(first(with_pass(R"({"name": "b", "color": "x", "cutout": 0.5})")),
            "wrong-type: \"cutout\" must be a link, not a number | 0.5");
  EXPECT_EQ(first(with_pass(R"({"name": "b", "color": "x", "double_sided": true})")),
            "wrong-type: \"double_sided\" must be the name of a parameter, not a boolean | true");
  EXPECT_EQ(first(with_pass(R"({"name": "b", "color": "x", "enabled": true})")),
            "wrong-type: \"enabled\" must be the name of a parameter, not a boolean | true");
  EXPECT_EQ(first(with_pass(R"({"name": "b", "color": "x", "enabled": "hull"})")),
            "unknown-parameter: the effect has no parameter \"hull\" | \"hull\"");
  EXPECT_EQ(
      first(R"({"isoshade": 1, "effect": "e", "parameters": {"tint": {"type": "color3", "value": [1, 1, 1]}},
              "passes": [{"name": "b", "color": "tint", "enabled": "tint"}]})"),
      "type-mismatch: \"enabled\" of a pass must name a boolean, integer or float parameter, not a color3 | \"tint\"");
  EXPECT_EQ(first(R"({"isoshade": 1, "effect": "e", "outputs": {}})"),
            "missing-key: an effect document needs the key \"passes\" | {");
}

TEST(Build, RejectsFunctionsWithoutOutputs) {
  EXPECT_EQ(first(R"({"isoshade": 1, "function": "f", "outputs": {}})"),
            "missing-key: a document needs at least one output | {}");
}

TEST(Links, AreSplitAtDots) {
  Diagnostics diagnostics;
  const auto link = [&](std::string_view text) { return parse_link(text, {}, {}, diagnostics); };
  EXPECT_EQ(link("a")->name, "a");
  EXPECT_TRUE(link("a")->selectors.empty());
  EXPECT_EQ(link("a.xyz")->selectors, std::vector<std::string>{"xyz"});
  EXPECT_EQ(link("a.out.x")->selectors, (std::vector<std::string>{"out", "x"}));
  EXPECT_FALSE(diagnostics.has_errors());
  for (const std::string_view text : {"", ".", "a.", ".a", "a..b", "a.b.c.d", "a b", "a.1", "1", "a/b"}) {
    EXPECT_FALSE(link(text).has_value()) << text;
  }
}

TEST(Ids, AreIdentifiersOfBoundedLength) {
  for (const std::string_view id : {"a", "_", "A9_z"}) EXPECT_TRUE(is_id(id)) << id;
  for (const std::string_view id : {"", "9", "a-b", "a.b", " a", "\xc3\xa9"}) EXPECT_FALSE(is_id(id)) << id;
  EXPECT_TRUE(is_id(std::string(128, 'a')));
  EXPECT_FALSE(is_id(std::string(129, 'a')));
  EXPECT_FALSE(is_id(std::string_view("a\0", 2)));
}

TEST(Types, AreFoundByName) {
  for (const std::string_view name : all_type_names()) EXPECT_EQ(type_name(*find_type(name)), name);
  EXPECT_EQ(find_type("float"), Type::floating);
  EXPECT_EQ(find_type("matrix44"), Type::matrix44);
  EXPECT_EQ(float_count(Type::matrix44), 16);
  EXPECT_EQ(float_count(Type::color4), 4);
  EXPECT_EQ(float_count(Type::string), 0);
  EXPECT_EQ(find_type("half"), std::nullopt);
}

}  // namespace
}  // namespace isoshade::graph
