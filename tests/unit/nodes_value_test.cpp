// SPDX-License-Identifier: Apache-2.0
// What nodes compute: that their ports reach the right operands.
#include <cmath>
#include <limits>

#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

using Floats = std::vector<float>;
constexpr float infinity = std::numeric_limits<float>::infinity();

/// What a node with these ports, in JSON, gives.
Floats value_of(const std::string& node) {
  FrontEnd front_end;
  Program program(front_end.lower(R"({"isoshade": 1, "function": "f", "nodes": {"node": {)" + node +
                                  R"(}}, "outputs": {"result": "node"}})"));
  return program({});
}

TEST(NodeValues, ArithmeticTakesItsPortsInOrder) {
  EXPECT_EQ(value_of(R"("type": "add", "in1": 5, "in2": 3)"), Floats{8});
  EXPECT_EQ(value_of(R"("type": "subtract", "in1": 5, "in2": 3)"), Floats{2});
  EXPECT_EQ(value_of(R"("type": "multiply", "in1": [1, 2, 3], "in2": 2)"), (Floats{2, 4, 6}));
  EXPECT_EQ(value_of(R"("type": "divide", "in1": 1, "in2": [2, 4])"), (Floats{0.5f, 0.25f}));
  EXPECT_EQ(value_of(R"("type": "divide", "in1": 1, "in2": 0)"), Floats{infinity});
  EXPECT_EQ(value_of(R"("type": "modulo", "in1": -1, "in2": 3)"), Floats{2});
  EXPECT_EQ(value_of(R"("type": "modulo", "in1": 2.75)"), Floats{0.75f});
  EXPECT_NEAR(value_of(R"("type": "power", "in1": 2, "in2": 10)")[0], 1024, 1e-3);
  EXPECT_EQ(value_of(R"("type": "min", "in1": 2, "in2": [1, 3])"), (Floats{1, 2}));
  EXPECT_EQ(value_of(R"("type": "max", "in1": 2, "in2": [1, 3])"), (Floats{2, 3}));
  EXPECT_EQ(value_of(R"("type": "clamp", "in": [-1, 0.5, 4])"), (Floats{0, 0.5f, 1}));
  EXPECT_EQ(value_of(R"("type": "clamp", "in": 7, "low": 2, "high": 5)"), Floats{5});
  EXPECT_EQ(value_of(R"("type": "saturate", "in": [-1, 0.5, 4])"), (Floats{0, 0.5f, 1}));
  EXPECT_EQ(value_of(R"("type": "absval", "in": -2)"), Floats{2});
  EXPECT_EQ(value_of(R"("type": "sign", "in": [-2, 0, 9])"), (Floats{-1, 0, 1}));
  EXPECT_EQ(value_of(R"("type": "floor", "in": -1.5)"), Floats{-2});
  EXPECT_EQ(value_of(R"("type": "fract", "in": -1.25)"), Floats{0.75f});
  EXPECT_EQ(value_of(R"("type": "invert", "in": 0.25)"), Floats{0.75f});
  EXPECT_EQ(value_of(R"("type": "invert", "in": 1, "amount": 3)"), Floats{2});
}

TEST(NodeValues, FunctionsAreTheOnesTheyAreNamedAfter) {
  EXPECT_EQ(value_of(R"("type": "sqrt", "in": 9)"), Floats{3});
  EXPECT_NEAR(value_of(R"("type": "exp", "in": 1)")[0], 2.7182818, 1e-6);
  EXPECT_EQ(value_of(R"("type": "exp2", "in": 3)"), Floats{8});
  EXPECT_NEAR(value_of(R"("type": "ln", "in": 10)")[0], 2.3025851, 1e-6);
  EXPECT_EQ(value_of(R"("type": "log2", "in": 8)"), Floats{3});
  EXPECT_NEAR(value_of(R"("type": "sin", "in": 1)")[0], std::sin(1.0), 1e-6);
  EXPECT_NEAR(value_of(R"("type": "cos", "in": 1)")[0], std::cos(1.0), 1e-6);
  EXPECT_NEAR(value_of(R"("type": "tan", "in": 1)")[0], std::tan(1.0), 1e-6);
  EXPECT_EQ(value_of(R"("type": "mix", "fg": 10, "bg": 20, "mix": 0)"), Floats{20});
  EXPECT_EQ(value_of(R"("type": "mix", "fg": [10, 8], "bg": 20, "mix": 0.25)"), (Floats{17.5f, 17}));
  EXPECT_EQ(value_of(R"("type": "mix", "fg": [10, 8], "bg": 20, "mix": [0, 1])"), (Floats{20, 8}));
  EXPECT_EQ(value_of(R"("type": "smoothstep", "in": 0.5)"), Floats{0.5f});
  EXPECT_EQ(value_of(R"("type": "smoothstep", "in": 3, "low": 2, "high": 6)"), Floats{0.15625f});
  EXPECT_EQ(value_of(R"("type": "step", "in": 0.5)"), Floats{1});
  EXPECT_EQ(value_of(R"("type": "step", "in": 0.5, "edge": 0.6)"), Floats{0});
}

TEST(NodeValues, VectorsAreGeometry) {
  EXPECT_EQ(value_of(R"("type": "dotproduct", "in1": [1, 2, 3], "in2": [4, 5, 6])"), Floats{32});
  EXPECT_EQ(value_of(R"("type": "crossproduct", "in1": [1, 0, 0], "in2": [0, 1, 0])"), (Floats{0, 0, 1}));
  EXPECT_EQ(value_of(R"("type": "normalize", "in": [0, 4, 0])"), (Floats{0, 1, 0}));
  EXPECT_EQ(value_of(R"("type": "magnitude", "in": [3, 4])"), Floats{5});
  EXPECT_EQ(value_of(R"("type": "distance", "in1": [1, 1], "in2": [4, 5])"), Floats{5});
  EXPECT_EQ(value_of(R"("type": "reflect", "in": [1, -1], "normal": [0, 1])"), (Floats{1, 1}));
  EXPECT_EQ(value_of(R"("type": "refract", "in": [0, -1], "normal": [0, 1])"), (Floats{0, -1}));
  EXPECT_EQ(value_of(R"("type": "transformmatrix", "in": [1, 10, 100], "mat": [1, 2, 3, 4, 5, 6, 7, 8, 9])"),
            (Floats{741, 852, 963}));
  EXPECT_EQ(value_of(R"("type": "multiply", "in1": [0, 1, 0, 0, 0, 1, 1, 0, 0],
                        "in2": [1, 2, 3, 4, 5, 6, 7, 8, 9])"),
            (Floats{3, 1, 2, 6, 4, 5, 9, 7, 8}));
}

TEST(NodeValues, ComparisonsChoose) {
  const std::string ports = R"(, "in1": [1, 2], "in2": 7)";
  EXPECT_EQ(value_of(R"("type": "ifgreater", "value1": 2, "value2": 1)" + ports), (Floats{1, 2}));
  EXPECT_EQ(value_of(R"("type": "ifgreater", "value1": 2, "value2": 2)" + ports), (Floats{7, 7}));
  EXPECT_EQ(value_of(R"("type": "ifgreatereq", "value1": 2, "value2": 2)" + ports), (Floats{1, 2}));
  EXPECT_EQ(value_of(R"("type": "ifgreatereq", "value1": 1, "value2": 2)" + ports), (Floats{7, 7}));
  EXPECT_EQ(value_of(R"("type": "ifequal", "value1": 2, "value2": 2)" + ports), (Floats{1, 2}));
  EXPECT_EQ(value_of(R"("type": "ifequal", "value1": 2, "value2": 3)" + ports), (Floats{7, 7}));
  EXPECT_EQ(value_of(R"("type": "ifequal", "value1": true, "value2": true)" + ports), (Floats{1, 2}));
  EXPECT_EQ(value_of(R"("type": "ifequal", "value1": true, "value2": false)" + ports), (Floats{7, 7}));
}

TEST(NodeValues, StructureNodesKeepComponentsInOrder) {
  EXPECT_EQ(value_of(R"("type": "constant", "value": [1, 2, 3, 4])"), (Floats{1, 2, 3, 4}));
  EXPECT_EQ(value_of(R"("type": "constant", "value": 2, "to": "color3")"), (Floats{2, 2, 2}));
  EXPECT_EQ(value_of(R"("type": "combine2", "in1": 1, "in2": 2)"), (Floats{1, 2}));
  EXPECT_EQ(value_of(R"("type": "combine3", "in2": 2, "in3": 3)"), (Floats{0, 2, 3}));
  EXPECT_EQ(value_of(R"("type": "combine4", "in1": 1, "in2": 2, "in3": 3, "in4": 4, "to": "color4")"),
            (Floats{1, 2, 3, 4}));
  EXPECT_EQ(value_of(R"("type": "extract", "in": [5, 6, 7], "index": 2)"), Floats{7});
  EXPECT_EQ(value_of(R"("type": "extract", "in": [5, 6, 7])"), Floats{5});
  EXPECT_EQ(value_of(R"("type": "convert", "in": [5, 6], "to": "vector4")"), (Floats{5, 6, 0, 1}));
  EXPECT_EQ(value_of(R"("type": "convert", "in": [5, 6, 7], "to": "color3")"), (Floats{5, 6, 7}));
  EXPECT_EQ(value_of(R"("type": "convert", "in": [5, 6, 7, 8], "to": "color3")"), (Floats{5, 6, 7}));
  EXPECT_EQ(value_of(R"("type": "convert", "in": 5, "to": "vector2")"), (Floats{5, 5}));
  EXPECT_EQ(value_of(R"("type": "convert", "in": true, "to": "vector2")"), (Floats{1, 1}));
}

TEST(NodeValues, SwizzlesTakeComponentsByEitherAlphabet) {
  FrontEnd front_end;
  Program program(front_end.lower(R"({"isoshade": 1, "function": "f",
    "inputs": {"v": {"type": "vector4"}, "c": {"type": "color3"}},
    "nodes": {"twice": {"type": "multiply", "in1": "v.wzyx", "in2": 2}},
    "outputs": {"a": "twice.xy", "b": "twice.out.rrrr", "c_": "c.bgr", "d": "c.g"}})"));
  EXPECT_EQ(program({1, 2, 3, 4, 5, 6, 7}), (Floats{8, 6, 8, 8, 8, 8, 7, 6, 5, 6}));
}

}  // namespace
}  // namespace isoshade
