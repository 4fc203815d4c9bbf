// SPDX-License-Identifier: Apache-2.0
// What the node table promises of every row.
#include <set>

#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

using graph::Type;
using nodes::PortType;
using nodes::Row;
using nodes::Variable;

std::vector<Type> types_in(nodes::TypeSet set) {
  std::vector<Type> types;
  for (const std::string_view name : graph::all_type_names())
    if (set.has(*graph::find_type(name))) types.push_back(*graph::find_type(name));
  return types;
}

/// The types that a variable of the row can have, or one that is never looked at.
std::vector<Type> choices_of(const Row& row, Variable variable) {
  for (const nodes::Port& port : row.ports)
    if (port.type.variable == variable) return types_in(port.type.accepts);
  return {Type::floating};
}

/// A function document with one node of the row, all ports linked to inputs; the document's name tells
/// nothing. `t` and `u` are the types of the row's variables.
std::string document_of(const Row& row, Type t, Type u) {
  std::string inputs, ports;
  for (const nodes::Port& port : row.ports) {
    const std::string name(port.name);
    const Type variable = port.type.variable == Variable::u ? u : t;
    if (port.type.kind == PortType::Kind::type_name) {
      ports += ", \"" + name + "\": \"" + std::string(graph::type_name(variable)) + "\"";
      continue;
    }
    if (port.type.kind != PortType::Kind::value) continue;
    const Type type = port.type.variable == Variable::none ? types_in(port.type.accepts).front() : variable;
    inputs += (inputs.empty() ? "" : ", ") + ("\"" + name + "\": {\"type\": \"") +
              std::string(graph::type_name(type)) + "\"}";
    ports += ", \"" + name + "\": \"" + name + "\"";
  }
  return "{\"isoshade\": 1, \"function\": \"f\", \"inputs\": {" + inputs +
         "}, \"nodes\": {\"node\": {\"type\": \"" + std::string(row.name) + "\"" + ports +
         "}}, \"outputs\": {\"result\": \"node\"}}";
}

bool belongs_to_effects(const Row& row) {
  return row.is<nodes::Surface>() || row.is<nodes::Light>() || row.is<nodes::SumLights>();
}

TEST(NodeTable, EveryRowAndPortIsDocumentedAndHasItsOwnName) {
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

TEST(NodeTable, EveryNodeLowersForEveryTypeThatItAccepts) {
  int lowered = 0;
  for (const Row& row : nodes::table()) {
    if (belongs_to_effects(row)) continue;
    int of_row = 0;
    for (const Type t : choices_of(row, Variable::t)) {
      for (const Type u : choices_of(row, Variable::u)) {
        const std::string text = document_of(row, t, u);
        FrontEnd front_end;
        const auto graph = front_end.check(text);
        if (graph == nullptr) {
          // Only a row's own condition may refuse what its ports accept.
          EXPECT_NE(row.condition, nullptr) << front_end.diagnostics.text() << text;
          continue;
        }
        const ir::Module module = lower::lower(*graph);
        EXPECT_EQ(ir::validate(module), "") << text;
        EXPECT_EQ(module.functions.at(module.find("f")).results[0].type,
                  nodes::ir_type(graph->outputs[0].needed));
        ++of_row;
      }
    }
    EXPECT_GT(of_row, 0) << row.name;
    lowered += of_row;
  }
  EXPECT_GT(lowered, 200);
}

TEST(NodeTable, NodesOfEffectsLowerInAnEffect) {
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

}  // namespace
}  // namespace isoshade
