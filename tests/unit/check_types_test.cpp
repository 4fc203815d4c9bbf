// SPDX-License-Identifier: Apache-2.0
// How types are inferred, and what is said where they do not fit.
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

constexpr const char* head = R"({"isoshade": 1, "function": "f", "inputs": {
  "b": {"type": "boolean"}, "i": {"type": "integer"}, "x": {"type": "float"}, "v2": {"type": "vector2"},
  "v3": {"type": "vector3"}, "c3": {"type": "color3"}, "c4": {"type": "color4"}, "m3": {"type": "matrix33"}},
  "nodes": {
)";

std::string document(const std::string& node) {
  return head + ("\"n\": {" + node) + "}\n}, \"outputs\": {\"out\": \"n\"}}";
}

/// The type of a node, or "" after errors.
std::string type_of(const std::string& node) {
  FrontEnd front_end;
  const auto graph = front_end.check(document(node));
  return graph == nullptr ? "" : std::string(graph::type_name(graph->outputs[0].needed));
}

std::string messages_of(const std::string& node) {
  FrontEnd front_end;
  return front_end.messages(document(node));
}

TEST(CheckTypes, FloatsBroadcastToVectorsAndColours) {
  EXPECT_EQ(type_of(R"("type": "add", "in1": "x", "in2": "x")"), "float");
  EXPECT_EQ(type_of(R"("type": "add", "in1": "x", "in2": "v3")"), "vector3");
  EXPECT_EQ(type_of(R"("type": "add", "in1": "c3", "in2": "x")"), "color3");
  EXPECT_EQ(type_of(R"("type": "clamp", "in": "c4", "low": "x")"), "color4");
  EXPECT_EQ(type_of(R"("type": "ifgreater", "value1": "x", "value2": 0, "in1": "v2", "in2": 1)"), "vector2");
}

TEST(CheckTypes, IntegersConvertToFloatsWhereNeeded) {
  EXPECT_EQ(type_of(R"("type": "add", "in1": "i", "in2": "i")"), "float");
  EXPECT_EQ(type_of(R"("type": "add", "in1": "i", "in2": "x")"), "float");
  EXPECT_EQ(type_of(R"("type": "ifequal", "value1": "i", "value2": 3, "in1": "b", "in2": true)"), "boolean");
  EXPECT_EQ(type_of(R"("type": "ifequal", "value1": "i", "value2": 0.5, "in1": "i", "in2": 1)"), "");
}

TEST(CheckTypes, LiteralsTakeTheTypeOfLinkedOperands) {
  EXPECT_EQ(type_of(R"("type": "add", "in1": [1, 2, 3], "in2": "c3")"), "color3");
  EXPECT_EQ(type_of(R"("type": "add", "in1": [1, 2, 3], "in2": "x")"), "vector3");
  EXPECT_EQ(type_of(R"("type": "add", "in1": [1, 2], "in2": 3)"), "vector2");
  EXPECT_EQ(type_of(R"("type": "constant", "value": [1, 2, 3], "to": "color3")"), "color3");
  EXPECT_EQ(type_of(R"("type": "constant", "value": [1, 2, 3])"), "vector3");
  EXPECT_EQ(type_of(R"("type": "constant", "value": 3)"), "float");
  EXPECT_EQ(type_of(R"("type": "constant", "value": 3, "to": "integer")"), "integer");
  EXPECT_EQ(type_of(R"("type": "constant", "value": true)"), "boolean");
}

TEST(CheckTypes, RgbSwizzlesOfColoursAreColours) {
  EXPECT_EQ(type_of(R"("type": "floor", "in": "c4.rgb")"), "color3");
  EXPECT_EQ(type_of(R"("type": "floor", "in": "c3.xyz")"), "color3");
  EXPECT_EQ(type_of(R"("type": "floor", "in": "c4.rg")"), "vector2");
  EXPECT_EQ(type_of(R"("type": "floor", "in": "v2.xyx")"), "vector3");
  EXPECT_EQ(type_of(R"("type": "floor", "in": "c4.a")"), "float");
}

TEST(CheckTypes, VectorsAndColoursDoNotMix) {
  EXPECT_EQ(messages_of(R"("type": "multiply", "in1": "v3", "in2": "c3")"),
            R"(test.json:5:47: error[type-mismatch]: "in2" of "multiply" is color3, but "in1" is vector3
  5 | "n": {"type": "multiply", "in1": "v3", "in2": "c3"}
    |                                               ^^^^ convert it with a node {"type": "convert", "in": "c3", "to": "vector3"}
)");
}

TEST(CheckTypes, TypeErrorsListTheAcceptedTypes) {
  EXPECT_EQ(
      messages_of(R"("type": "normalize", "in": "x")"),
      R"(test.json:5:34: error[type-mismatch]: "in" of "normalize" takes vector2, vector3 or vector4, not float
  5 | "n": {"type": "normalize", "in": "x"}
    |                                  ^^^
)");
  EXPECT_EQ(messages_of(R"("type": "ifgreater", "value1": "v3", "value2": 0, "in1": 1, "in2": 2)"),
            R"(test.json:5:38: error[type-mismatch]: "value1" of "ifgreater" takes float, not vector3
  5 | "n": {"type": "ifgreater", "value1": "v3", "value2": 0, "in1": 1, "in2": 2}
    |                                      ^^^^ convert it with a node {"type": "convert", "in": "v3", "to": "float"}
)");
  EXPECT_EQ(
      messages_of(R"("type": "add", "in1": true, "in2": 1)"),
      R"(test.json:5:29: error[type-mismatch]: "in1" of "add" takes float, vector2, vector3, vector4, color3, color4, matrix33 or matrix44, not boolean
  5 | "n": {"type": "add", "in1": true, "in2": 1}
    |                             ^^^^
)");
}

TEST(CheckTypes, RejectsArraysOfTheWrongLength) {
  EXPECT_EQ(messages_of(R"("type": "add", "in1": "v3", "in2": [1, 2])"),
            R"(test.json:5:42: error[type-mismatch]: "in2" of "add" is vector2, but "in1" is vector3
  5 | "n": {"type": "add", "in1": "v3", "in2": [1, 2]}
    |                                          ^^^^^^
)");
  EXPECT_EQ(
      messages_of(R"("type": "add", "in1": [1, 2, 3, 4, 5], "in2": 1)"),
      R"(test.json:5:29: error[wrong-type]: "in1" of "add" takes float, vector2, vector3, vector4, color3, color4, matrix33 or matrix44, not an array of 5 numbers
  5 | "n": {"type": "add", "in1": [1, 2, 3, 4, 5], "in2": 1}
    |                             ^^^^^^^^^^^^^^^
)");
  EXPECT_EQ(
      messages_of(R"("type": "crossproduct", "in1": "v3", "in2": [1, 2])"),
      R"(test.json:5:51: error[wrong-type]: "in2" of "crossproduct" must be vector3, not an array of 2 numbers
  5 | "n": {"type": "crossproduct", "in1": "v3", "in2": [1, 2]}
    |                                                   ^^^^^^
)");
}

TEST(CheckTypes, RejectsUnknownAndUnsuitableTargetTypes) {
  EXPECT_EQ(messages_of(R"("type": "convert", "in": "v3", "to": "colour3")"),
            R"(test.json:5:44: error[unknown-type]: there is no type "colour3"
  5 | "n": {"type": "convert", "in": "v3", "to": "colour3"}
    |                                            ^^^^^^^^^ did you mean "color3"?
  note: it can be boolean, integer, float, vector2, vector3, vector4, color3, color4, matrix33 or matrix44
)");
  EXPECT_NE(messages_of(R"("type": "combine3", "in1": 1, "to": "vector4")").find("type-mismatch"),
            std::string::npos);
  EXPECT_NE(messages_of(R"("type": "convert", "in": "m3", "to": "vector3")")
                .find("a matrix33 cannot be converted to vector3"),
            std::string::npos);
  EXPECT_NE(messages_of(R"("type": "convert", "in": "v3")").find("needs \"to\""), std::string::npos);
  EXPECT_NE(messages_of(R"("type": "convert", "in": "v3", "to": {"link": "x"})").find("not-literal"),
            std::string::npos);
}

TEST(CheckTypes, ExtractIndexStartsAtZeroAndIsBounded) {
  EXPECT_EQ(type_of(R"("type": "extract", "in": "v3", "index": 2)"), "float");
  EXPECT_NE(messages_of(R"("type": "extract", "in": "v3", "index": 3)")
                .find("error[out-of-range]: a vector3 has the components 0 to 2"),
            std::string::npos);
  EXPECT_NE(messages_of(R"("type": "extract", "in": "v3", "index": -1)").find("out-of-range"),
            std::string::npos);
  EXPECT_NE(messages_of(R"("type": "extract", "in": "v3", "index": 0.5)").find("wrong-type"),
            std::string::npos);
}

TEST(CheckTypes, RejectsVectorsOfAnotherSizeThanTheMatrix) {
  EXPECT_EQ(type_of(R"("type": "transformmatrix", "in": "v3", "mat": "m3")"), "vector3");
  EXPECT_NE(messages_of(R"("type": "transformmatrix", "in": [1, 2, 3, 4], "mat": "m3")")
                .find("a vector4 needs a matrix44, not a matrix33"),
            std::string::npos);
}

TEST(CheckTypes, RejectsVectorsAsPassColor) {
  const auto messages = [](const std::string& color) {
    FrontEnd front_end;
    return front_end.messages(R"({"isoshade": 1, "effect": "e", "nodes": {"n": {"type": "normal"}},
      "parameters": {"x": {"type": "float", "value": 1}}, "passes": [{"name": "p", "color": ")" +
                              color + "\"}]}");
  };
  EXPECT_EQ(messages("n.x").find("error"), std::string::npos);
  EXPECT_NE(messages("n").find("\"color\" must be color3 or color4, not vector3"), std::string::npos);
}

/// An effect of one pass, with the colour as it is written there.
std::string colored(const std::string& color, const std::string& nodes = "") {
  return R"({"isoshade": 1, "effect": "e", "parameters": {"t": {"type": "float", "value": 0.5},
    "tint": {"type": "color3", "value": [1, 1, 1]}, "axis": {"type": "vector3", "value": [1, 1, 1]}},
"nodes": {)" + nodes +
         R"(}, "passes": [{"name": "p", "color": )" + color + "}]}";
}

TEST(CheckTypes, PassColorMayBeALiteral) {
  for (const char* color : {"[1, 0.5, 0]", "[1, 0.5, 0, 1]", "0.5"})
    EXPECT_EQ(FrontEnd().messages(colored(color)), "") << color;
  EXPECT_NE(FrontEnd().messages(colored("[1, 0.5]")).find("3 or 4 numbers, not 2"), std::string::npos);
  EXPECT_NE(FrontEnd().messages(colored("true")).find("error[wrong-type]"), std::string::npos);
}

TEST(CheckTypes, ArraysBecomeColoursWhereColoursAreExpected) {
  const char* made[] = {
      R"("c": {"type": "constant", "value": [1, 0, 0]})",
      R"("c": {"type": "mix", "fg": [1, 0, 0], "bg": [0, 0, 1], "mix": "t"})",
      R"("c": {"type": "ifgreater", "value1": "t", "value2": 0.5, "in1": [1, 0, 0], "in2": [0, 0, 1]})",
      R"("c": {"type": "expression", "code": "t > 0 ? a : b", "t": "t", "a": [1, 0, 0], "b": [0, 0, 1]})",
      R"("a": {"type": "constant", "value": [1, 0, 0]}, "c": {"type": "multiply", "in1": "a", "in2": "t"})",
      R"("a": {"type": "constant", "value": [1, 0, 0]}, "c": {"type": "add", "in1": "a", "in2": "tint"})",
      R"("a": {"type": "constant", "value": [1, 0, 0]}, "c": {"type": "add", "in1": "tint", "in2": "a"})",
      R"("a": {"type": "constant", "value": [1, 0, 0]}, "c": {"type": "luminance", "in": "a"})"};
  for (const char* nodes : made) EXPECT_EQ(FrontEnd().messages(colored("\"c\"", nodes)), "") << nodes;
  const char* vectors[] = {
      R"("c": {"type": "constant", "value": [1, 0, 0], "to": "vector3"})",
      R"("c": {"type": "add", "in1": [1, 0, 0], "in2": "axis"})",
      R"("a": {"type": "constant", "value": [1, 0, 0]}, "c": {"type": "add", "in1": "a", "in2": "axis"})",
      R"("c": {"type": "combine3", "in1": "t"})"};
  for (const char* nodes : vectors)
    EXPECT_NE(FrontEnd().messages(colored("\"c\"", nodes)).find("error[type-mismatch]"), std::string::npos) << nodes;
}

}  // namespace
}  // namespace isoshade
