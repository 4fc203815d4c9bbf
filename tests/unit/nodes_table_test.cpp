// SPDX-License-Identifier: Apache-2.0
// What the node table promises of every row.
#include <set>

#include "compiler/nodes/example.h"
#include "compiler/nodes/manual.h"
#include "compiler/nodes/site.h"
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

using nodes::Row;

TEST(NodeTable, EveryRowAndPortIsDocumentedAndUniquelyNamed) {
  std::set<std::string_view> names;
  for (const Row& row : nodes::table()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(graph::is_id(row.name)) << row.name;
    EXPECT_EQ(row.doc.substr(row.doc.size() - 1), ".") << row.name;
    EXPECT_EQ(nodes::find(row.name), &row);
    std::set<std::string_view> ports{"type", "doc", "extras"};
    for (const nodes::Port& port : row.ports) {
      EXPECT_TRUE(ports.insert(port.name).second) << row.name << "." << port.name;
      EXPECT_FALSE(port.doc.empty()) << row.name << "." << port.name;
    }
  }
  EXPECT_EQ(nodes::find("no such node"), nullptr);
}

TEST(NodeTable, EveryNodeWithValuePortsStatesItsDomain) {
  for (const Row& row : nodes::table()) {
    const bool takes_values = std::ranges::any_of(
        row.ports, [](const nodes::Port& port) { return port.type.kind == nodes::PortType::Kind::value; });
    EXPECT_EQ(!nodes::domain_of(row).empty(), takes_values) << row.name;
    if (!takes_values) continue;
    EXPECT_TRUE(nodes::domain_of(row).ends_with('.')) << row.name;
    EXPECT_NE(nodes::row_text(row).find("domain " + std::string(nodes::domain_of(row))), std::string::npos);
    EXPECT_NE(nodes::table_markdown({}).find(nodes::domain_of(row)), std::string::npos) << row.name;
  }
  for (const Row& row : nodes::function_table()) {
    if (!row.is<nodes::Function>()) continue;
    for (const functions::Tier tier : functions::tiers)
      EXPECT_FALSE(nodes::domain_of(row, tier).empty()) << row.name;
  }
}

TEST(NodeTable, StatesTheDomainsOfTiersThatDiffer) {
  const std::string text = nodes::row_text(*nodes::find("exp2"));
  EXPECT_NE(text.find("with --precision fast: [-126, 127.9999]"), std::string::npos) << text;
  EXPECT_EQ(nodes::row_text(*nodes::find("sqrt")).find("--precision"), std::string::npos);
}

TEST(NodeTable, EveryNodeLowersForEveryAcceptedType) {
  size_t lowered = 0;
  for (const Row& row : nodes::table()) {
    if (row.availability() != nodes::Availability::anywhere) continue;
    const std::vector<nodes::Example> examples = nodes::examples_of(row);
    EXPECT_FALSE(examples.empty()) << row.name;
    for (const nodes::Example& example : examples) {
      const std::string text = nodes::function_document(std::span(&example, 1));
      FrontEnd front_end;
      const auto graph = front_end.check(text);
      ASSERT_NE(graph, nullptr) << front_end.diagnostics.text() << text;
      const ir::Module module = lower::lower(*graph).module;
      EXPECT_EQ(ir::validate(module), "") << text;
      const ir::Function& function = module.functions.at(module.find("example"));
      EXPECT_EQ(function.results[0].type, nodes::ir_type(example.type_of(row.outputs[0].type))) << text;
    }
    lowered += examples.size();
  }
  EXPECT_GT(lowered, 300u);
}

TEST(NodeTable, EffectNodesLowerInAnEffect) {
  FrontEnd front_end;
  const ir::Module module = front_end.lower(R"({"isoshade": 1, "effect": "e", "nodes": {
    "p": {"type": "position"}, "n": {"type": "normal", "space": "world"}, "v": {"type": "viewdirection"},
    "t": {"type": "texcoord"}, "l": {"type": "lightdirection"}, "c": {"type": "lightcolor"},
    "a": {"type": "dotproduct", "in1": "p", "in2": "n"}, "b": {"type": "dotproduct", "in1": "v", "in2": "l"},
    "ab": {"type": "multiply", "in1": "a", "in2": "b"}, "abt": {"type": "multiply", "in1": "ab", "in2": "t.x"},
    "lit": {"type": "multiply", "in1": "c", "in2": "abt"}, "sum": {"type": "sum_lights", "in": "lit"}},
    "passes": [{"name": "base", "color": "sum"}]})");
  const ir::Function& shade = module.functions.at(module.find("shade"));
  std::string parameters;
  for (const ir::Parameter& parameter : shade.parameters)
    parameters += parameter.group + "." + parameter.name + (parameter.uniform ? "! " : " ");
  EXPECT_EQ(parameters,
            "surface.position surface.normal surface.texcoord surface.view_direction .light_count! ");
}

std::string effect_of(const std::string& node, const std::string& color) {
  return R"({"isoshade": 1, "effect": "e", "nodes": {"n": {)" + node +
         R"(}}, "passes": [{"name": "base", "color": ")" + color + R"("}]})";
}

std::string parameters_of(const ir::Module& module) {
  std::string names;
  for (const ir::Parameter& parameter : module.functions.at(module.find("shade")).parameters)
    names += (names.empty() ? "" : " ") + parameter.group + "." + parameter.name;
  return names;
}

std::string asked_by(const std::string& node, const std::string& color = "n.x") {
  return parameters_of(FrontEnd().lower(effect_of(node, color)));
}

TEST(NodeTable, EachSpaceOfAnAttributeIsASeparateField) {
  for (const std::string name : {"position", "normal", "tangent", "bitangent", "viewdirection"}) {
    const std::string field = "surface." + (name == "viewdirection" ? "view_direction" : name);
    EXPECT_EQ(asked_by(R"("type": ")" + name + R"(")"), field);
    EXPECT_EQ(asked_by(R"("type": ")" + name + R"(", "space": "world")"), field);
    EXPECT_EQ(asked_by(R"("type": ")" + name + R"(", "space": "view")"), field + "_view");
    EXPECT_EQ(asked_by(R"("type": ")" + name + R"(", "space": "object")"), field + "_object");
    EXPECT_EQ(asked_by(R"("type": ")" + name + R"(", "space": "model")"), field + "_object");
  }
  EXPECT_EQ(asked_by(R"("type": "vertexcolor")"), "surface.color");
  EXPECT_EQ(asked_by(R"("type": "texcoord", "index": 0)"), "surface.texcoord");
  EXPECT_EQ(asked_by(R"("type": "texcoord", "index": 1)"), "surface.texcoord1");
  EXPECT_NE(FrontEnd().messages(effect_of(R"("type": "texcoord", "index": 2)", "n.x")).find("only the sets 0 and 1"),
            std::string::npos);
  EXPECT_EQ(asked_by(R"("type": "time")", "n"), "frame.time");
}

TEST(NodeTable, TransformsRequestOnlyTheColumnsTheyNeed) {
  const auto node = [](const std::string& type, const std::string& from, const std::string& to) {
    return R"("type": "transform)" + type + R"(", "in": [1, 2, 3], "fromspace": ")" + from +
           R"(", "tospace": ")" + to + "\"";
  };
  const auto columns = [](const std::string& name, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += (i > 0 ? " spaces." : "spaces.") + name + "_" + std::to_string(i);
    return text;
  };
  EXPECT_EQ(asked_by(node("point", "view", "view")), "");
  EXPECT_EQ(asked_by(node("point", "object", "world")), columns("world_from_object", 4));
  EXPECT_EQ(asked_by(node("vector", "model", "world")), columns("world_from_object", 3));
  EXPECT_EQ(asked_by(node("vector", "world", "object")), columns("object_from_world", 3));
  EXPECT_EQ(asked_by(node("normal", "world", "object")), columns("world_from_object", 3));
  EXPECT_EQ(asked_by(node("normal", "object", "world")), columns("object_from_world", 3));
  EXPECT_EQ(asked_by(node("point", "object", "view")),
            columns("world_from_object", 4) + " " + columns("view_from_world", 4));
  EXPECT_EQ(asked_by(node("point", "view", "object")),
            columns("object_from_world", 4) + " " + columns("world_from_view", 4));
}

TEST(NodeTable, PortsThatDefaultToTheSurfaceReadItInFunctionsToo) {
  EXPECT_EQ(asked_by(R"("type": "facingratio")", "n"), "surface.normal surface.view_direction");
  EXPECT_EQ(asked_by(R"("type": "ramplr", "valuel": 1, "valuer": 2)", "n"), "surface.texcoord");
  EXPECT_EQ(FrontEnd().messages(R"({"isoshade": 1, "function": "f", "nodes": {
                    "n": {"type": "ramplr", "valuel": 1, "valuer": 2}}, "outputs": {"out": "n"}})"),
            "");
}

}  // namespace
}  // namespace isoshade
