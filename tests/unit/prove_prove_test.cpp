// SPDX-License-Identifier: Apache-2.0
// What is proved of small documents, and that what is refuted breaks when it is run.
#include <cmath>
#include <gtest/gtest.h>

#include "compiler/prove/document.h"
#include "compiler/prove/prove.h"
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

using prove::Breach;
using prove::Proof;
using prove::Subject;

struct Checked {
  std::shared_ptr<const check::TypedGraph> graph;
  Subject subject;
  Proof proof;
  std::string messages;
};

Checked checked(const std::string& text) {
  FrontEnd front_end(ISOSHADE_GRAPHS "/library");
  Checked checked;
  checked.graph = front_end.check(text);
  EXPECT_NE(checked.graph, nullptr) << front_end.diagnostics.text();
  if (checked.graph == nullptr) return checked;
  auto subjects = prove::subjects_of(*checked.graph, front_end.diagnostics);
  EXPECT_TRUE(subjects && !subjects->empty());
  checked.subject = std::move(subjects->back());
  checked.proof = prove::prove(checked.subject.tape);
  prove::report(*checked.graph, checked.subject, checked.proof, front_end.diagnostics);
  checked.messages = front_end.diagnostics.text();
  return checked;
}

std::string function_of(const std::string& inputs, const std::string& nodes) {
  return R"({"isoshade": 1, "function": "f", "inputs": {)" + inputs + R"(}, "nodes": {)" + nodes +
         R"(}, "outputs": {"out": "r"}})";
}

const std::string x_and_y =
    R"("x": {"type": "float", "min": -1, "max": 1}, "y": {"type": "float", "min": 0, "max": 1})";
/// `ports`: the inputs that it reads.
std::string code(const std::string& text, const std::string& ports = "xy") {
  std::string node = R"("r": {"type": "expression", "code": ")" + text + "\"";
  for (const char port : ports) node += std::string(", \"") + port + "\": \"" + port + "\"";
  return node + "}";
}

/// Whether the function gives no finite number for the counterexample, by the interpreter.
bool breaks(const Checked& c) {
  std::vector<float> arguments;
  for (const uint32_t word : c.proof.unproved.at(0).counterexample)
    arguments.push_back(std::bit_cast<float>(word));
  Program program(lower::lower(*c.graph).module);
  bool finite = true;
  for (const float result : program(arguments)) finite = finite && std::isfinite(result);
  return !finite;
}

TEST(Proof, SucceedsForFiniteExpressions) {
  const Checked c = checked(function_of(x_and_y, code("sqrt(1 - x * x) / (2 + x * y)")));
  EXPECT_TRUE(c.proof.unproved.empty()) << c.messages;
  ASSERT_EQ(c.proof.outputs.size(), 1u);
  EXPECT_GE(c.proof.outputs[0].lo, 0);
  EXPECT_LE(c.proof.outputs[0].hi, 1);
}

TEST(Proof, RefutesWithCounterexamples) {
  struct Case {
    const char* code;
    const char* ports;
    Breach breach;
  };
  for (const Case& wrong :
       {Case{"1 / x", "x", Breach::division_by_zero}, Case{"1 / (x - y)", "xy", Breach::division_by_zero},
        Case{"sqrt(x)", "x", Breach::root_of_negative}, Case{"log(y)", "y", Breach::logarithm},
        Case{"pow(x, 2.5)", "x", Breach::power}, Case{"acos(x + y)", "xy", Breach::arc},
        Case{"exp(x * 100)", "x", Breach::overflow}}) {
    const Checked c = checked(function_of(x_and_y, code(wrong.code, wrong.ports)));
    ASSERT_EQ(c.proof.unproved.size(), 1u) << wrong.code;
    EXPECT_EQ(c.proof.unproved[0].breach, wrong.breach) << wrong.code;
    ASSERT_FALSE(c.proof.unproved[0].counterexample.empty()) << wrong.code;
    EXPECT_TRUE(breaks(c)) << wrong.code;
    EXPECT_NE(c.messages.find("error[refuted]: in node \"r\""), std::string::npos) << c.messages;
  }
}

TEST(Proof, NamesThePortAndTheCounterexample) {
  const Checked c = checked(R"({"isoshade": 1, "function": "f",
      "inputs": {"c": {"type": "float", "min": 0, "max": 1}},
      "nodes": {"q": {"type": "divide", "in1": 1, "in2": "c"}}, "outputs": {"out": "q"}})");
  EXPECT_NE(c.messages.find("in node \"q\", port \"in2\": division by zero"), std::string::npos)
      << c.messages;
  EXPECT_NE(c.messages.find("where c = 0.0"), std::string::npos) << c.messages;
}

size_t count_of(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Proof, RefutesEveryFailingOperation) {
  // Three that do not depend on each other, and one that reads another's result and breaks where that is finite.
  const std::string nodes = R"("q": {"type": "divide", "in1": 1, "in2": "x"},
      "l": {"type": "ln", "in": "q"}, "s": {"type": "sqrt", "in": "x"}, "p": {"type": "divide", "in1": "x", "in2": "y"},
      "r": {"type": "expression", "code": "l + s + p", "l": "l", "s": "s", "p": "p"})";
  const Checked c = checked(function_of(x_and_y, nodes));
  for (const char* message :
       {"refuted]: in node \"q\", port \"in2\": division by zero",
        "refuted]: in node \"l\", port \"in\": logarithm", "refuted]: in node \"s\", port \"in\": root",
        "refuted]: in node \"p\", port \"in2\": division by zero"})
    EXPECT_EQ(count_of(c.messages, message), 1u) << message << "\n" << c.messages;
}

TEST(Proof, ReportsComponentsOfOneOperationOnce) {
  const std::string inputs = R"("v": {"type": "vector4", "min": -1, "max": 1})";
  const Checked c =
      checked(function_of(inputs, R"("r": {"type": "divide", "in1": [1, 2, 3, 4], "in2": "v"})"));
  EXPECT_EQ(c.proof.unproved.size(), 4u);
  EXPECT_EQ(count_of(c.messages, "error[refuted]"), 1u) << c.messages;
}

TEST(Proof, ReportsEachOperatorOfAnExpressionSeparately) {
  const Checked c = checked(function_of(x_and_y, code("(1 / x) * 0.5 + (2 / y) * 0.5")));
  EXPECT_EQ(count_of(c.messages, "in node \"r\": division by zero"), 2u) << c.messages;
  const size_t first = c.messages.find("test.json:"), second = c.messages.find("test.json:", first + 1);
  ASSERT_NE(second, std::string::npos);
  EXPECT_NE(c.messages.substr(first, c.messages.find(" error", first) - first),
            c.messages.substr(second, c.messages.find(" error", second) - second));
}

TEST(Proof, ReportsAtMost20ErrorsAndCountsTheRest) {
  std::string nodes, sum;
  for (int i = 0; i < 30; ++i) {
    const std::string name = "q" + std::to_string(i);
    nodes += "\"" + name + R"(": {"type": "divide", "in1": )" + std::to_string(i + 1) + R"(, "in2": "x"},)";
    nodes += "\"s" + name + R"(": {"type": "add", "in1": ")" + name + R"(", "in2": )" +
             (i == 0 ? "0" : "\"sq" + std::to_string(i - 1) + "\"") + "},";
  }
  const Checked c =
      checked(function_of(x_and_y, nodes + R"("r": {"type": "multiply", "in1": "sq29", "in2": 0.5})"));
  EXPECT_EQ(count_of(c.messages, "error[refuted]"), 20u);
  support::Diagnostics all(1000);
  const prove::NotProved counts =
      prove::report(*c.graph, c.subject, c.proof, all, prove::Detail::all);
  EXPECT_GE(counts.refuted, 30u);
  EXPECT_EQ(counts.shown, counts.refuted + counts.undecided);
  EXPECT_EQ(all.all().size(), counts.shown + counts.later);
}

TEST(Proof, SmoothstepWithEqualEdgesIsAStep) {
  const Checked c = checked(function_of(x_and_y, code("smoothstep(x, x + y, 0.5)")));
  EXPECT_TRUE(c.proof.unproved.empty()) << c.messages;
  EXPECT_EQ(c.proof.outputs.at(0).lo, 0);
  EXPECT_EQ(c.proof.outputs.at(0).hi, 1);
}

TEST(Proof, ConditionsNarrowTheSidesOfASelection) {
  // Only where y > 0 is the quotient looked at.
  const std::string guarded = R"("q": {"type": "divide", "in1": "x", "in2": "y"},
      "r": {"type": "ifgreater", "value1": "y", "value2": 0.5, "in1": "q", "in2": 0})";
  EXPECT_TRUE(checked(function_of(x_and_y, guarded)).proof.unproved.empty());
  const std::string wrong_side = R"("q": {"type": "divide", "in1": "x", "in2": "y"},
      "r": {"type": "ifgreater", "value1": "y", "value2": 0.5, "in1": 0, "in2": "q"})";
  EXPECT_FALSE(checked(function_of(x_and_y, wrong_side)).proof.unproved.empty());
  const std::string looked_at_elsewhere = R"("q": {"type": "divide", "in1": "x", "in2": "y"},
      "c": {"type": "ifgreater", "value1": "y", "value2": 0.5, "in1": "q", "in2": 0},
      "r": {"type": "add", "in1": "c", "in2": "q"})";
  EXPECT_FALSE(checked(function_of(x_and_y, looked_at_elsewhere)).proof.unproved.empty());
}

TEST(Proof, MinAboveXImpliesBothOperandsAboveX) {
  const std::string inputs =
      R"("x": {"type": "float", "min": -1, "max": 1}, "y": {"type": "float", "min": -1})";
  const std::string both = R"("least": {"type": "min", "in1": "x", "in2": "y"},
      "q": {"type": "expression", "code": "log(x) + log(y) + 0", "x": "x", "y": "y"},
      "r": {"type": "ifgreater", "value1": "least", "value2": 0, "in1": "q", "in2": 0})";
  EXPECT_TRUE(checked(function_of(inputs, both)).proof.unproved.empty());
}

TEST(Proof, UsesThatInputsAreUnitVectors) {
  const auto inputs = [](const std::string& key) {
    return R"("x": {"type": "vector3")" + key + R"(}, "y": {"type": "vector3")" + key + "}";
  };
  const std::string unit = R"(, "unit": true)";
  const std::string cosine = code("1 / (1.001 - dot(x, y))");
  EXPECT_TRUE(checked(function_of(inputs(unit), cosine)).proof.unproved.empty());
  EXPECT_FALSE(checked(function_of(inputs(""), cosine)).proof.unproved.empty());
  // The cosine may round to 1 and above.
  const Checked c = checked(function_of(inputs(unit), code("1 / (1 - dot(x, y))")));
  ASSERT_EQ(c.proof.unproved.size(), 1u);
  EXPECT_TRUE(breaks(c));
  // The half vector is as long as 2.
  EXPECT_TRUE(
      checked(function_of(inputs(unit), code("sqrt(4.001 - dot(x + y, x + y))"))).proof.unproved.empty());
}

TEST(Proof, UnitVectorsStayThatWhenTurnedRoundOrChosen) {
  const std::string inputs = R"("x": {"type": "vector3", "unit": true}, "y": {"type": "vector3", "unit": true},
      "z": {"type": "vector3", "min": -1, "max": 1}, "f": {"type": "boolean"})";
  const auto is_proved = [&](const std::string& text, const std::string& ports) {
    return checked(function_of(inputs, code(text, ports))).proof.unproved.empty();
  };
  EXPECT_TRUE(is_proved("1 / (1.001 - dot(-y, x))", "xy"));
  EXPECT_TRUE(is_proved("1 / (1.001 - dot(f ? y : -y, x))", "xyf"));
  EXPECT_FALSE(is_proved("1 / (1.001 - dot(f ? y : z, x))", "xyzf"));
}

TEST(Proof, SquaresAreNotNegative) {
  const std::string inputs = R"("x": {"type": "vector3"}, "y": {"type": "float"})";
  EXPECT_TRUE(checked(function_of(inputs, code("1 / (dot(x, x) + y * y + 1)"))).proof.unproved.empty());
}

TEST(Proof, BoundsSumsOverAnyNumberOfLights) {
  const auto effect = [](const std::string& lit) {
    return R"({"isoshade": 1, "effect": "e", "parameters": {}, "nodes": {"n": {"type": "normal"},
        "l": {"type": "lightdirection"}, "c": {"type": "lightcolor"},
        "lit": {"type": "expression", "code": ")" +
           lit + R"(", "n": "n", "l": "l", "c": "c"}, "all": {"type": "sum_lights", "in": "lit"}},
        "passes": [{"name": "base", "color": "all"}]})";
  };
  const Checked c = checked(effect("c * color3(max(dot(n, l), 0))"));
  EXPECT_TRUE(c.proof.unproved.empty()) << c.messages;
  EXPECT_GE(c.proof.outputs[0].hi, 1024e6);
  EXPECT_LT(c.proof.outputs[0].hi, 1025e6);
  EXPECT_FALSE(checked(effect("c / color3(dot(n, l))")).proof.unproved.empty());
}

TEST(Proof, StandardMaterialIsFiniteForBaseColorsOutsideOfTheirRange) {
  const Checked c = checked(R"({"isoshade": 1, "effect": "e",
    "parameters": {"metallic": {"type": "float", "value": 1, "min": 0, "max": 1}},
    "nodes": {"n": {"type": "normal"}, "spots": {"type": "noise3d"},
      "base": {"type": "mix", "bg": [0.8, 0.8, 0.8], "fg": [0.3, 0.1, 0.05], "mix": "spots"},
      "lit": {"type": "material/standard", "normal": "n", "base_color": "base", "metallic": "metallic"}},
    "passes": [{"name": "p", "color": "lit"}]})");
  EXPECT_TRUE(c.proof.unproved.empty()) << c.messages;
}

TEST(Proof, SeparatesErrorsOfBranchesTippedByRounding) {
  const Checked c = checked(function_of(x_and_y, code("x * 0.1 > y * 0.3 ? 1 + y : 0")));
  ASSERT_EQ(c.proof.tipped.size(), 1u);
  EXPECT_GE(c.proof.outputs[0].absolute, 1);
  EXPECT_LE(c.proof.followed[0].absolute, 0x1.1p-23);
  const Checked exact = checked(function_of(x_and_y, code("x > y ? 1 + y : 0")));
  EXPECT_TRUE(exact.proof.tipped.empty()) << "inputs are what they are";
  EXPECT_LE(exact.proof.outputs[0].absolute, 0x1.1p-23);
}

TEST(Proof, NamesTheOperationThatLosesTheErrorBound) {
  // Where t is above 0 it is known to be a float, but exactly it may be nothing.
  const std::string nodes = R"=("t": {"type": "expression", "code": "x * 0.1 - y * 0.3", "x": "x", "y": "y"},
      "q": {"type": "divide", "in1": 0.5, "in2": "t"}, "half": {"type": "multiply", "in1": "q", "in2": 0.5},
      "r": {"type": "ifgreater", "value1": "t", "value2": 0, "in1": "half", "in2": 0})=";
  const Checked c = checked(function_of(x_and_y, nodes));
  ASSERT_TRUE(c.proof.unproved.empty()) << c.messages;
  const prove::Tape& tape = c.subject.tape;
  ASSERT_NE(c.proof.lost.at(0), prove::none);
  EXPECT_EQ(tape.places[tape.operations[c.proof.lost[0]].place].node, "q");
}

TEST(Proof, CoversOnlyTheRestrictedInputs) {
  const Checked c = checked(function_of(x_and_y, code("1 / x", "x")));
  EXPECT_FALSE(c.proof.unproved.empty());
  const Proof part = prove::prove(c.subject.tape, {}, {{"x", {0.5, 2}}});
  EXPECT_TRUE(part.unproved.empty());
  EXPECT_EQ(part.outputs[0].lo, 1);
  EXPECT_EQ(part.outputs[0].hi, 2);
}

TEST(Proof, IsVacuousIfNoInputIsAllowed) {
  const Checked c = checked(function_of(x_and_y, code("x + y")));
  EXPECT_FALSE(c.proof.vacuous);
  EXPECT_TRUE(prove::prove(c.subject.tape, {}, {{"x", {2, 3}}}).vacuous);
  EXPECT_FALSE(prove::prove(c.subject.tape, {}, {{"x", {1, 3}}}).vacuous);
  const Checked whole = checked(function_of(R"("i": {"type": "integer", "min": 0, "max": 9})",
                                            R"("r": {"type": "convert", "in": "i", "to": "float"})"));
  EXPECT_TRUE(prove::prove(whole.subject.tape, {}, {{"i", {0.3, 0.6}}}).vacuous);
  EXPECT_EQ(prove::prove(whole.subject.tape, {}, {{"i", {0.3, 4.6}}}).outputs[0].lo, 1);
  const std::string too_long = R"("v": {"type": "vector3", "unit": true, "min": 0.9})";
  const std::string sum = R"("r": {"type": "dotproduct", "in1": "v", "in2": [1, 2, 3]})";
  EXPECT_TRUE(checked(function_of(too_long, sum)).proof.vacuous);
}

TEST(Proof, IsDeterministic) {
  const std::string text = function_of(x_and_y, code("1 / (x * x - y * y * y + 0.149)"));
  EXPECT_EQ(checked(text).messages, checked(text).messages);
}

TEST(Proof, ReportsWhereItIsUndecided) {
  // It is never 0, but so near to it that no box shows it: x^2 + y^2 - 2 x y + 2^-40.
  const Checked c = checked(function_of(x_and_y, code("1 / (x * x + y * y - 2 * x * y + 1e-5)")));
  if (c.proof.unproved.empty()) return;  // it may become provable
  EXPECT_NE(c.messages.find("is not ruled out"), std::string::npos) << c.messages;
  EXPECT_NE(c.messages.find("x in ["), std::string::npos) << c.messages;
}

}  // namespace
}  // namespace isoshade
