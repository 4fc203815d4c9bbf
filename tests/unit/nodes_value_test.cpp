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

TEST(NodeValues, MatricesAreBuiltFromColumns) {
  EXPECT_EQ(value_of(R"("type": "creatematrix", "in1": [1, 2, 3], "in2": [4, 5, 6], "in3": [7, 8, 9])"),
            (Floats{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(value_of(R"("type": "creatematrix", "to": "matrix44", "in1": [1, 2, 3], "in2": [4, 5, 6],
                        "in3": [7, 8, 9])"),
            (Floats{1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0, 0, 0, 0, 1}));
  EXPECT_EQ(value_of(R"("type": "creatematrix", "to": "matrix44", "in1": [1, 2, 3], "in2": [4, 5, 6],
                        "in3": [7, 8, 9], "in4": [10, 11, 12])"),
            (Floats{1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0, 10, 11, 12, 1}));
  EXPECT_EQ(value_of(R"("type": "creatematrix", "to": "matrix44", "in1": [1, 2, 3, 4], "in2": [5, 6, 7, 8],
                        "in3": [9, 10, 11, 12], "in4": [13, 14, 15, 16])"),
            (Floats{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}));
}

TEST(NodeValues, Combine2AppendsANumber) {
  EXPECT_EQ(value_of(R"("type": "combine2", "in1": 1, "in2": 2)"), (Floats{1, 2}));
  EXPECT_EQ(value_of(R"("type": "combine2", "in1": [1, 2], "in2": 3, "to": "vector3")"), (Floats{1, 2, 3}));
  EXPECT_EQ(value_of(R"("type": "combine2", "in1": [1, 2, 3], "in2": 4, "to": "color4")"), (Floats{1, 2, 3, 4}));
}

TEST(NodeValues, ArithmeticUsesItsPortsInOrder) {
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
  EXPECT_EQ(value_of(R"("type": "ceil", "in": [-1.5, 1.25])"), (Floats{-1, 2}));
  EXPECT_EQ(value_of(R"("type": "round", "in": [-1.75, 1.5, 2.5, 0.25])"), (Floats{-2, 2, 2, 0}));
  EXPECT_EQ(value_of(R"("type": "add", "in1": [1, 2], "in2": [10, 20])"), (Floats{11, 22}));
  EXPECT_EQ(value_of(R"("type": "subtract", "in1": [1, 2, 3, 4, 5, 6, 7, 8, 9],
                        "in2": [1, 1, 1, 1, 1, 1, 1, 1, 1])"),
            (Floats{0, 1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(value_of(R"("type": "multiply", "in1": [1, 2, 3, 4, 5, 6, 7, 8, 9])"),
            (Floats{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(value_of(R"("type": "remap", "in": 3, "inlow": 1, "inhigh": 5, "outlow": 10, "outhigh": 30)"),
            Floats{20});
  EXPECT_EQ(value_of(R"("type": "remap", "in": 0.25)"), Floats{0.25f});
  EXPECT_EQ(value_of(R"("type": "invert", "in": 0.25)"), Floats{0.75f});
  EXPECT_EQ(value_of(R"("type": "invert", "in": 1, "amount": 3)"), Floats{2});
}

TEST(NodeValues, FunctionNodesComputeTheirFunctions) {
  EXPECT_EQ(value_of(R"("type": "sqrt", "in": 9)"), Floats{3});
  EXPECT_NEAR(value_of(R"("type": "exp", "in": 1)")[0], 2.7182818, 1e-6);
  EXPECT_EQ(value_of(R"("type": "exp2", "in": 3)"), Floats{8});
  EXPECT_NEAR(value_of(R"("type": "ln", "in": 10)")[0], 2.3025851, 1e-6);
  EXPECT_EQ(value_of(R"("type": "log2", "in": 8)"), Floats{3});
  EXPECT_NEAR(value_of(R"("type": "sin", "in": 1)")[0], std::sin(1.0), 1e-6);
  EXPECT_NEAR(value_of(R"("type": "cos", "in": 1)")[0], std::cos(1.0), 1e-6);
  EXPECT_NEAR(value_of(R"("type": "tan", "in": 1)")[0], std::tan(1.0), 1e-6);
  EXPECT_NEAR(value_of(R"("type": "asin", "in": 0.5)")[0], std::asin(0.5), 1e-6);
  EXPECT_NEAR(value_of(R"("type": "acos", "in": 0.25)")[0], std::acos(0.25), 1e-6);
  EXPECT_NEAR(value_of(R"("type": "atan2", "iny": 2, "inx": -1)")[0], std::atan2(2.0, -1.0), 1e-6);
  EXPECT_NEAR(value_of(R"("type": "atan2", "iny": 2)")[0], std::atan2(2.0, 1.0), 1e-6);
  EXPECT_NEAR(value_of(R"("type": "safepower", "in1": -2, "in2": 3)")[0], -8, 1e-5);
  EXPECT_EQ(value_of(R"("type": "mix", "fg": 10, "bg": 20, "mix": 0)"), Floats{20});
  EXPECT_EQ(value_of(R"("type": "mix", "fg": [10, 8], "bg": 20, "mix": 0.25)"), (Floats{17.5f, 17}));
  EXPECT_EQ(value_of(R"("type": "mix", "fg": [10, 8], "bg": 20, "mix": [0, 1])"), (Floats{20, 8}));
  EXPECT_EQ(value_of(R"("type": "smoothstep", "in": 0.5)"), Floats{0.5f});
  EXPECT_EQ(value_of(R"("type": "smoothstep", "in": 3, "low": 2, "high": 6)"), Floats{0.15625f});
  EXPECT_EQ(value_of(R"("type": "step", "in": 0.5)"), Floats{1});
  EXPECT_EQ(value_of(R"("type": "step", "in": 0.5, "edge": 0.6)"), Floats{0});
}

TEST(NodeValues, VectorNodesComputeGeometry) {
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
  EXPECT_EQ(value_of(R"("type": "transpose", "in": [1, 2, 3, 4, 5, 6, 7, 8, 9])"),
            (Floats{1, 4, 7, 2, 5, 8, 3, 6, 9}));
  EXPECT_EQ(value_of(R"("type": "determinant", "in": [2, 0, 0, 0, 3, 0, 0, 0, 4])"), Floats{24});
  EXPECT_EQ(value_of(R"("type": "invertmatrix", "in": [2, 0, 0, 0, 4, 0, 0, 0, 8])"),
            (Floats{0.5f, 0, 0, 0, 0.25f, 0, 0, 0, 0.125f}));
  EXPECT_EQ(value_of(R"("type": "divide", "in1": [2, 4, 8, 2, 4, 8, 2, 4, 8],
                        "in2": [2, 0, 0, 0, 4, 0, 0, 0, 8])"),
            (Floats{1, 2, 4, 0.5f, 1, 2, 0.25f, 0.5f, 1}));
  EXPECT_EQ(value_of(R"("type": "transformmatrix", "in": [1, 10], "mat": [1, 2, 3, 4, 5, 6, 7, 8, 9])"),
            (Floats{48, 60}));
  EXPECT_EQ(value_of(R"("type": "transformmatrix", "in": [1, 10, 100],
                        "mat": [1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0, 0.5, 0.25, 0.125, 1])"),
            (Floats{741.5f, 852.25f, 963.125f}));
}

TEST(NodeValues, ColourNodesKeepAlpha) {
  EXPECT_EQ(value_of(R"("type": "luminance", "in": [0, 1, 0, 0.5])"),
            (Floats{0.7152f, 0.7152f, 0.7152f, 0.5f}));
  EXPECT_EQ(value_of(R"("type": "luminance", "in": [2, 3, 4], "lumacoeffs": [1, 10, 100])"),
            (Floats{432, 432, 432}));
  EXPECT_EQ(value_of(R"("type": "rgbtohsv", "in": [0, 0.5, 0, 0.25])"), (Floats{1.0f / 3, 1, 0.5f, 0.25f}));
  EXPECT_EQ(value_of(R"("type": "hsvtorgb", "in": [0.5, 1, 2])"), (Floats{0, 2, 2}));
  EXPECT_EQ(value_of(R"("type": "contrast", "in": [0.5, 1], "amount": 2)"), (Floats{0.5f, 1.5f}));
  EXPECT_EQ(value_of(R"("type": "contrast", "in": 3, "amount": 2, "pivot": 1)"), Floats{5});
}

TEST(NodeValues, RampsRunRightAndDown) {
  const std::string at = R"(, "texcoord": [0.25, 0.75])";
  EXPECT_EQ(value_of(R"("type": "ramplr", "valuel": [10, 0], "valuer": [20, 4])" + at), (Floats{12.5f, 1}));
  EXPECT_EQ(value_of(R"("type": "ramptb", "valuet": 10, "valueb": 20)" + at), Floats{17.5f});
  EXPECT_EQ(value_of(R"("type": "ramptb", "valuet": 10, "valueb": 20, "texcoord": [0, -3])"), Floats{10});
  EXPECT_EQ(value_of(R"("type": "splitlr", "valuel": 1, "valuer": 2)" + at), Floats{1});
  EXPECT_EQ(value_of(R"("type": "splitlr", "valuel": 1, "valuer": 2, "center": 0.25)" + at), Floats{2});
  EXPECT_EQ(value_of(R"("type": "splittb", "valuet": 1, "valueb": 2)" + at), Floats{2});
}

TEST(NodeValues, Place2dScalesRotatesAndOffsets) {
  const auto placed = [](const std::string& ports) {
    return value_of(R"("type": "place2d", "texcoord": [3, 5])" + ports);
  };
  EXPECT_EQ(placed(""), (Floats{3, 5}));
  EXPECT_EQ(placed(R"(, "scale": [2, 4])"), (Floats{1.5f, 1.25f}));
  EXPECT_EQ(placed(R"(, "offset": [1, 2])"), (Floats{2, 3}));
  EXPECT_EQ(placed(R"(, "offset": [1, 1], "scale": 2, "pivot": [1, 1])"), (Floats{1, 2}));
  EXPECT_EQ(placed(R"(, "offset": [1, 1], "scale": 2, "pivot": [1, 1], "operationorder": 1)"),
            (Floats{1.5f, 2.5f}));
  const Floats turned = placed(R"(, "rotate": 90)");
  EXPECT_NEAR(turned[0], 5, 1e-6);
  EXPECT_NEAR(turned[1], -3, 1e-6);
}

TEST(NodeValues, NoiseReturnsTheRequestedComponents) {
  const std::string at = R"(, "texcoord": [1.25, 3.5])";
  const Floats three = value_of(R"("type": "noise2d", "to": "vector3")" + at);
  const Floats four = value_of(R"("type": "noise2d", "to": "color4")" + at);
  const Floats there = value_of(R"("type": "noise2d", "texcoord": [20.25, 76.5])");
  EXPECT_EQ(four, (Floats{three[0], three[1], three[2], there[0]}));
  EXPECT_EQ(value_of(R"("type": "noise2d", "to": "vector2")" + at), (Floats{three[0], three[1]}));
  EXPECT_EQ(value_of(R"("type": "noise2d")" + at), Floats{three[0]});
  EXPECT_EQ(value_of(R"("type": "noise2d", "amplitude": [2, 4], "pivot": 1)" + at),
            (Floats{three[0] * 2 + 1, three[1] * 4 + 1}));
  const Floats distances = value_of(R"("type": "worleynoise2d", "to": "vector3")" + at);
  EXPECT_LT(distances[0], distances[1]);
  EXPECT_LT(distances[1], distances[2]);
  EXPECT_EQ(value_of(R"("type": "worleynoise2d", "to": "vector2")" + at),
            (Floats{distances[0], distances[1]}));
  EXPECT_EQ(value_of(R"("type": "worleynoise2d")" + at), Floats{distances[0]});
  EXPECT_EQ(value_of(R"("type": "cellnoise2d", "texcoord": [1.25, 3.5])"),
            value_of(R"("type": "cellnoise2d", "texcoord": [1.75, 3])"));
}

TEST(NodeValues, FractalsSumOctavesOfNoise) {
  const auto noise_at = [](const std::string& at) {
    return value_of(R"("type": "noise3d", "position": )" + at)[0];
  };
  const float sum = (noise_at("[0.25, 0.5, 0.375]") + noise_at("[0.75, 1.5, 1.125]") * 0.25f) +
                    noise_at("[2.25, 4.5, 3.375]") * 0.0625f;
  EXPECT_EQ(value_of(R"("type": "fractal3d", "amplitude": 8, "lacunarity": 3, "diminish": 0.25,
                        "position": [0.25, 0.5, 0.375])"),
            Floats{sum * 8});
  EXPECT_EQ(value_of(R"("type": "fractal3d", "octaves": 1, "position": [0.25, 0.5, 0.375])")[0],
            noise_at("[0.25, 0.5, 0.375]"));
}

TEST(NodeValues, FacingRatioFacesForwardByDefault) {
  const std::string ports = R"("type": "facingratio", "viewdirection": [0, 0, 1], "normal": [0, 0.6, -0.8])";
  EXPECT_EQ(value_of(ports), Floats{0.8f});
  EXPECT_EQ(value_of(ports + R"(, "faceforward": false)"), Floats{-0.8f});
  EXPECT_EQ(value_of(ports + R"(, "invert": true)"), Floats{1.0f - 0.8f});
}

TEST(NodeValues, ComparisonsSelectAnInput) {
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

TEST(NodeValues, ComparisonsWithoutInputsReturnBooleans) {
  const auto is = [](const std::string& comparison, const std::string& logic) {
    FrontEnd front_end;
    Program program(front_end.lower(R"({"isoshade": 1, "function": "f", "nodes": {"is": {)" + comparison +
                                    R"(}, "logic": {)" + logic +
                                    R"(}, "one": {"type": "convert", "in": "logic", "to": "float"}},
                                    "outputs": {"result": "one"}})"));
    return program({}) == Floats{1};
  };
  const std::string greater = R"("type": "ifgreater", "value1": 2, "value2": 1)";
  const std::string equal = R"("type": "ifequal", "value1": 2, "value2": 1)";
  EXPECT_TRUE(is(greater, R"("type": "and", "in1": "is", "in2": true)"));
  EXPECT_FALSE(is(greater, R"("type": "and", "in1": "is", "in2": false)"));
  EXPECT_TRUE(is(equal, R"("type": "or", "in1": "is", "in2": true)"));
  EXPECT_FALSE(is(equal, R"("type": "or", "in1": "is", "in2": false)"));
  EXPECT_FALSE(is(greater, R"("type": "xor", "in1": "is", "in2": true)"));
  EXPECT_TRUE(is(equal, R"("type": "xor", "in1": "is", "in2": true)"));
  EXPECT_TRUE(is(equal, R"("type": "not", "in": "is")"));
  EXPECT_EQ(value_of(R"("type": "ifgreater", "value1": 2, "value2": 1, "in2": [5, 6])"), (Floats{0, 0}));
  EXPECT_EQ(value_of(R"("type": "ifgreater", "value1": 1, "value2": 2, "in1": [5, 6])"), (Floats{0, 0}));
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

TEST(NodeValues, FloatToIntegerTruncatesAndSaturates) {
  FrontEnd front_end;
  Program program(front_end.lower(R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}},
    "nodes": {"i": {"type": "convert", "in": "x", "to": "integer"},
              "f": {"type": "convert", "in": "i", "to": "float"},
              "b": {"type": "convert", "in": "i", "to": "boolean"},
              "t": {"type": "convert", "in": "b", "to": "float"},
              "bx": {"type": "convert", "in": "x", "to": "boolean"},
              "tx": {"type": "convert", "in": "bx", "to": "float"}},
    "outputs": {"a": "f", "b": "t", "c": "tx"}})"));
  EXPECT_EQ(program({-2.75f}), (Floats{-2, 1, 1}));
  EXPECT_EQ(program({0.5f}), (Floats{0, 0, 1}));
  EXPECT_EQ(program({0}), (Floats{0, 0, 0}));
  for (const float above : {0x1p31f, 3e9f, 1e30f, infinity})
    EXPECT_EQ(program({above}), (Floats{0x1p31f, 1, 1})) << above;  // 2147483647, of which 2^31 is the nearest float
  EXPECT_EQ(program({2147483520.0f}), (Floats{2147483520.0f, 1, 1}));
  EXPECT_EQ(program({-infinity}), (Floats{-2147483648.0f, 1, 1}));
  EXPECT_EQ(program({std::numeric_limits<float>::quiet_NaN()}), (Floats{0, 0, 1}));
}

TEST(NodeValues, SeparateNamesEveryComponent) {
  FrontEnd front_end;
  Program program(front_end.lower(R"({"isoshade": 1, "function": "f",
    "inputs": {"v": {"type": "vector2"}, "c": {"type": "color3"}, "d": {"type": "vector4"}},
    "nodes": {"s2": {"type": "separate2", "in": "v"}, "s3": {"type": "separate3", "in": "c"},
              "s4": {"type": "separate4", "in": "d"}},
    "outputs": {"a": "s2.outy", "b": "s2.outx", "c_": "s3.outb", "d_": "s3.outx", "e": "s4.outw",
                "f": "s4.outa", "g": "s4.outg"}})"));
  EXPECT_EQ(program({1, 2, 3, 4, 5, 6, 7, 8, 9}), (Floats{2, 1, 5, 3, 9, 9, 7}));
}

TEST(NodeValues, SwizzlesAcceptXyzwAndRgba) {
  FrontEnd front_end;
  Program program(front_end.lower(R"({"isoshade": 1, "function": "f",
    "inputs": {"v": {"type": "vector4"}, "c": {"type": "color3"}},
    "nodes": {"twice": {"type": "multiply", "in1": "v.wzyx", "in2": 2}},
    "outputs": {"a": "twice.xy", "b": "twice.out.rrrr", "c_": "c.bgr", "d": "c.g"}})"));
  EXPECT_EQ(program({1, 2, 3, 4, 5, 6, 7}), (Floats{8, 6, 8, 8, 8, 8, 7, 6, 5, 6}));
}

}  // namespace
}  // namespace isoshade
