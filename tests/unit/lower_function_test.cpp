// SPDX-License-Identifier: Apache-2.0
// Function documents as IR: names, origins, one function a document.
#include "compiler/ir/printer.h"
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

TEST(LowerFunction, NamesFollowTheDocumentAndItsNodes) {
  FrontEnd front_end;
  EXPECT_EQ(
      ir::print(front_end.lower(R"({
  "isoshade": 1,
  "function": "half_lambert",
  "inputs": {"n": {"type": "vector3"}, "color": {"type": "color3"}, "unused": {"type": "boolean"}},
  "nodes": {
    "wrapped": {"type": "multiply", "in1": "n.y", "in2": 0.5},
    "dead": {"type": "sqrt", "in": "wrapped"},
    "lit": {"type": "multiply", "in1": "color", "in2": "wrapped"}
  },
  "outputs": {"out": "lit", "share": "wrapped"}
})")),
      R"(func @half_lambert(%n: vec3, %color: vec3, %unused: bool) -> (out: vec3, share: float) from "test.json" {
  %3 = extract %n, 1  ; wrapped:6
  %4 = constant float 0x3f000000  ; wrapped:6  # 0.5
  %wrapped = fmul %3, %4  ; wrapped:6
  %6: vec3 = construct %wrapped, %wrapped, %wrapped  ; lit:8
  %lit: vec3 = fmul %color, %6  ; lit:8
  return %lit, %wrapped
}
)");
}

TEST(LowerFunction, EachUsedDocumentIsOneFunctionBeforeItsCallers) {
  FrontEnd front_end;
  const char* square = R"({"isoshade": 1, "function": "square", "inputs": {"x": {"type": "float"}},
    "nodes": {"n": {"type": "multiply", "in1": "x", "in2": "x"}}, "outputs": {"out": "n"}})";
  front_end.library.add("library/square.json", square);
  front_end.library.add("library/other/square.json", square);
  const ir::Module module =
      front_end.lower(R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}},
    "nodes": {"a": {"type": "square", "x": "x"}, "b": {"type": "square", "x": "a"},
              "c": {"type": "other/square", "x": "b"}, "dead": {"type": "other/square", "x": 1}},
    "outputs": {"out": "c"}})");
  EXPECT_EQ(ir::validate(module), "");
  ASSERT_EQ(module.functions.size(), 3u);
  EXPECT_EQ(module.functions[0].name, "square");
  EXPECT_EQ(module.functions[0].document, "library/square.json");
  EXPECT_EQ(module.functions[1].name, "square_2");
  EXPECT_EQ(module.functions[1].document, "library/other/square.json");
  EXPECT_EQ(module.functions[2].name, "f");
  EXPECT_EQ(module.functions[2].document, "test.json");
}

TEST(LowerFunction, OmitsDocumentsThatNoUsedNodeCalls) {
  FrontEnd front_end;
  front_end.library.add("library/square.json", R"({"isoshade": 1, "function": "square",
    "inputs": {"x": {"type": "float"}}, "outputs": {"out": "x"}})");
  const ir::Module module = front_end.lower(R"({"isoshade": 1, "function": "f", "nodes": {
    "dead": {"type": "square", "x": 1}, "n": {"type": "constant", "value": 1}}, "outputs": {"out": "n"}})");
  EXPECT_EQ(module.functions.size(), 1u);
}

TEST(LowerFunction, AvoidsNamesOfStagesAndLibraryFunctions) {
  for (const char* name : {"shade", "light_at", "pixel", "iso_dot_v3", "attribute2"}) {
    FrontEnd front_end;
    const auto graph = front_end.check(R"({"isoshade": 1, "function": ")" + std::string(name) +
                                       R"(", "inputs": {"x": {"type": "float"}}, "outputs": {"out": "x"}})");
    ASSERT_NE(graph, nullptr);
    const auto [module, interface] = lower::lower(*graph);
    EXPECT_EQ(module.functions[interface.entry].name, "function_" + std::string(name));
  }
}

TEST(LowerFunction, MatricesBecomeTheirColumns) {
  FrontEnd front_end;
  const ir::Module module = front_end.lower(R"({"isoshade": 1, "function": "f",
    "inputs": {"m_1": {"type": "float"}, "m": {"type": "matrix33"}, "v": {"type": "vector3"}},
    "nodes": {"mm": {"type": "multiply", "in1": "m", "in2": "m"},
              "s": {"type": "ifgreater", "value1": "m_1", "value2": 0, "in1": "mm", "in2": "m"},
              "t": {"type": "transformmatrix", "in": "v", "mat": "s"}},
    "outputs": {"m": "s", "t": "t"}})");
  EXPECT_EQ(ir::validate(module), "");
  const ir::Function& f = module.functions[module.find("f")];
  std::string names;
  for (const ir::Parameter& parameter : f.parameters) names += parameter.name + " ";
  for (const ir::Result& result : f.results) names += result.name + " ";
  EXPECT_EQ(names, "m_1 m_0 m_1_ m_2 v m_0 m_1 m_2 t ");
  Program program(module);
  EXPECT_EQ(program({1, 0, 1, 0, 0, 0, 1, 1, 0, 0, 7, 8, 9}),
            (std::vector<float>{0, 0, 1, 1, 0, 0, 0, 1, 0, 8, 9, 7}));
}

TEST(LowerFunction, WhatItReadsFromTheStageFollowsItsInputs) {
  FrontEnd front_end;
  front_end.library.add("library/lit.json", R"json({"isoshade": 1, "function": "lit",
    "inputs": {"normal": {"type": "float"}, "map": {"type": "filename"}, "x": {"type": "color3"}},
    "nodes": {"n": {"type": "normal"}, "t": {"type": "time"}, "i": {"type": "image", "file": {"link": "map"}},
              "l": {"type": "lightcolor"}, "s": {"type": "sum_lights", "in": "l"},
              "v": {"type": "transformvector", "in": "n", "fromspace": "world", "tospace": "view"},
              "out": {"type": "expression", "code": "s * i + x * color3(v) * color3(t * a)", "s": "s", "i": "i", "x": "x",
                      "v": "v", "t": "t", "a": "normal"}},
    "outputs": {"out": "out"}})json");
  const auto effect = front_end.check(R"({"isoshade": 1, "effect": "e", "nodes": {
    "c": {"type": "lit", "normal": 1, "map": "a.png", "x": [1, 2, 3]}}, "passes": [{"name": "p", "color": "c"}]})");
  ASSERT_NE(effect, nullptr) << front_end.diagnostics.text();
  const auto names = [](const ir::Function& function) {
    std::string text;
    for (const ir::Parameter& parameter : function.parameters)
      text += (parameter.group.empty() ? "" : parameter.group + ".") + parameter.name + " ";
    return text;
  };
  const auto [module, interface] = lower::lower(*effect);
  EXPECT_EQ(ir::validate(module), "");
  EXPECT_EQ(names(module.functions[module.find("lit")]),
            "normal x shown_position surface_normal texcoord view_from_world_0 view_from_world_1 view_from_world_2 time map "
            "light_count ");
  EXPECT_EQ(names(module.functions[interface.entry]),
            "surface.position surface.normal surface.texcoord spaces.view_from_world_0 spaces.view_from_world_1 "
            "spaces.view_from_world_2 frame.time images.c_map light_count ");
}

TEST(LowerFunction, ManyValuesAreGroupedUniformOnesApart) {
  std::string inputs, sum = "\"a0\": {\"type\": \"multiply\", \"in1\": \"x0\", \"in2\": \"t\"}";
  for (int i = 0; i < 120; ++i) {
    const std::string number = std::to_string(i);
    inputs += (i == 0 ? "" : ", ") + std::string("\"x") + number + "\": {\"type\": \"float\"}";
    sum += ", \"a" + std::to_string(i + 1) + "\": {\"type\": \"add\", \"in1\": \"a" + number + "\", \"in2\": \"x" +
           number + "\"}";
  }
  FrontEnd front_end;
  const ir::Module module = front_end.lower(R"({"isoshade": 1, "function": "f", "inputs": {)" + inputs +
                                            R"(}, "nodes": {"t": {"type": "time"}, )" + sum +
                                            R"(}, "outputs": {"out": "a120"}})");
  EXPECT_EQ(ir::validate(module), "");
  const ir::Function& f = module.functions[module.find("f")];
  ASSERT_EQ(f.parameters.size(), 121u);
  EXPECT_EQ(f.parameters[0].group, "inputs_1");
  EXPECT_EQ(f.parameters[119].group, "inputs_2");
  EXPECT_EQ(f.parameters[120].group, "uniform_inputs_1");
}

TEST(LowerFunction, SeveralOutputsAreNamedByNodeAndOutput) {
  FrontEnd front_end;
  front_end.library.add("library/both.json", R"({"isoshade": 1, "function": "both",
    "inputs": {"x": {"type": "vector3"}}, "outputs": {"first": "x.x", "rest": "x.yz"}})");
  const std::string text = ir::print(front_end.lower(R"({"isoshade": 1, "function": "f",
    "nodes": {"a": {"type": "both", "x": [1, 2, 3]}}, "outputs": {"x": "a.first", "y": "a.rest.y"}})"));
  EXPECT_NE(text.find("%a_first:2, %a_rest:2: vec2 = call @both("), std::string::npos) << text;
  EXPECT_NE(text.find("= extract %a_rest, 1"), std::string::npos) << text;
}

TEST(LowerFunction, IsDeterministic) {
  const auto once = [] {
    FrontEnd front_end(ISOSHADE_GRAPHS "/library");
    return front_end.lower_file(ISOSHADE_GRAPHS "/materials/cook_torrance.json");
  };
  EXPECT_EQ(once(), once());
}

}  // namespace
}  // namespace isoshade
