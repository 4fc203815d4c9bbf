// SPDX-License-Identifier: Apache-2.0
// Expressions: what they compute, and what is said of them, with the place inside of the string.
#include <cmath>

#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

using Floats = std::vector<float>;

constexpr const char* head = R"({"isoshade": 1, "function": "f", "inputs": {
  "x": {"type": "float"}, "y": {"type": "float"}, "v": {"type": "vector3"}},
"nodes": {"e": {"type": "expression", "code": )";

std::string document(const std::string& code, const std::string& ports = R"("x": "x", "y": "y", "v": "v")") {
  return head + ("\"" + code + "\"" + (ports.empty() ? "" : ", ") + ports) +
         "}},\n\"outputs\": {\"out\": \"e\"}}";
}

/// The value for x = 3, y = 4, v = (1, 2, 5). Ports that the code does not read are left out.
Floats value_of(const std::string& code) {
  std::string ports;
  for (const char* name : {"x", "y", "v"}) {
    const bool reads = [&] {
      for (size_t at = code.find(name); at != std::string::npos; at = code.find(name, at + 1)) {
        const auto part = [&](size_t i) {
          return i < code.size() && (std::isalnum(code[i]) || code[i] == '.');
        };
        if (!(at > 0 && part(at - 1)) && !(part(at + 1) && code[at + 1] != '.')) return true;
      }
      return false;
    }();
    if (reads) ports += std::string(ports.empty() ? "" : ", ") + "\"" + name + "\": \"" + name + "\"";
  }
  FrontEnd front_end;
  front_end.library.add("library/folder/twice.json", R"({"isoshade": 1, "function": "twice",
    "inputs": {"in": {"type": "float"}}, "nodes": {"d": {"type": "add", "in1": "in", "in2": "in"}},
    "outputs": {"out": "d"}})");
  Program program(front_end.lower(document(code, ports)));
  return program({3, 4, 1, 2, 5});
}

std::string messages_of(const std::string& code,
                        const std::string& ports = R"("x": "x", "y": "y", "v": "v")") {
  FrontEnd front_end;
  return front_end.messages(document(code, ports));
}

TEST(Expression, OperatorPrecedenceFollowsC) {
  EXPECT_EQ(value_of("x + y * 2"), Floats{11});
  EXPECT_EQ(value_of("(x + y) * 2"), Floats{14});
  EXPECT_EQ(value_of("x - y - 1"), Floats{-2});
  EXPECT_EQ(value_of("12 / x / 2"), Floats{2});
  EXPECT_EQ(value_of("-x * -y"), Floats{12});
  EXPECT_EQ(value_of("- -x"), Floats{3});
  EXPECT_EQ(value_of("x < y ? 1 : 2"), Floats{1});
  EXPECT_EQ(value_of("x >= y ? 1 : y <= 4 ? 5 : 6"), Floats{5});
  EXPECT_EQ(value_of("x == 3 && y != 4 || x > 2 ? 1 : 0"), Floats{1});
  EXPECT_EQ(value_of("!(x == 3) ? 1 : 0"), Floats{0});
  EXPECT_EQ(value_of("x != y == true ? 1 : 0"), Floats{1});
}

TEST(Expression, NanComparisonsFollowC) {
  EXPECT_EQ(value_of("x*0/0 == x ? 1 : 0"), Floats{0});
  EXPECT_EQ(value_of("x*0/0 != x ? 1 : 0"), Floats{1});
  EXPECT_EQ(value_of("x*0/0 <= x ? 1 : 0"), Floats{0});
  EXPECT_EQ(value_of("x < x*0/0 ? 1 : 0"), Floats{0});
}

TEST(Expression, NegationFlipsTheSignOfZero) { EXPECT_TRUE(std::signbit(value_of("-(x - 3)")[0])); }

TEST(Expression, VectorsAreConstructedSwizzledAndBroadcast) {
  EXPECT_EQ(value_of("v * x"), (Floats{3, 6, 15}));
  EXPECT_EQ(value_of("v.zyx"), (Floats{5, 2, 1}));
  EXPECT_EQ(value_of("v.zyx.x + 1"), Floats{6});
  EXPECT_EQ(value_of("(v + v).y"), Floats{4});
  EXPECT_EQ(value_of("vector3(x, y, 1)"), (Floats{3, 4, 1}));
  EXPECT_EQ(value_of("vector2(x)"), (Floats{3, 3}));
  EXPECT_EQ(value_of("color4(v.x, v.y, v.z, 1)"), (Floats{1, 2, 5, 1}));
  EXPECT_EQ(value_of("color3(v) * color3(1, 0, 1)"), (Floats{1, 0, 5}));
  EXPECT_EQ(value_of("boolean(v.x - 1) ? 1 : integer(2.5) / 4"), Floats{0.5f});
}

TEST(Expression, CallsBuiltInAndLibraryFunctions) {
  EXPECT_EQ(value_of("max(x, y)"), Floats{4});
  EXPECT_EQ(value_of("sqrt(x + 6) + abs(-1) + floor(0.5)"), Floats{4});
  EXPECT_EQ(value_of("mix(10, 20, 0.25)"), Floats{12.5f});
  EXPECT_EQ(value_of("clamp(v, 1.5, 3)"), (Floats{1.5f, 2, 3}));
  EXPECT_EQ(value_of("dot(v, v)"), Floats{30});
  EXPECT_EQ(value_of("folder::twice(x) + folder::twice(1) / 2"), Floats{7});
}

TEST(Expression, NumberLiteralsFollowC) {
  EXPECT_EQ(value_of(".5 + 2. + 1e1 + 2.5E-1"), Floats{12.75f});
  EXPECT_EQ(value_of("pi"), Floats{3.14159265f});
}

TEST(Expression, PortsMayBeValuesLinksOrSwizzles) {
  FrontEnd front_end;
  Program program(front_end.lower(document("a * b.x + c", R"("a": 2, "b": [7, 8, 9], "c": "v.z")")));
  EXPECT_EQ(program({3, 4, 1, 2, 5}), Floats{19});
}

TEST(Expression, PortLiteralsTakeTheTypeOfTheOtherOperand) {
  FrontEnd front_end;
  const auto graph = front_end.check(document("color3(v) * tint", R"("v": "v", "tint": [1, 0.5, 0.25])"));
  ASSERT_NE(graph, nullptr) << front_end.diagnostics.text();
  EXPECT_EQ(graph->outputs[0].needed, graph::Type::color3);
}

TEST(Expression, IntermediatesAreNamedAfterTheNode) {
  FrontEnd front_end;
  const ir::Module module = front_end.lower(document("x*x + y*y", R"("x": "x", "y": "y")"));
  const ir::Function& function = module.functions.back();
  for (size_t i = 1; i < function.origins.size(); ++i) EXPECT_EQ(function.origins[i].node, "e");
}

/// Where the first error stands in the code, from 0, and what it is.
std::string error_of(const std::string& code, const std::string& ports = R"("x": "x", "y": "y", "v": "v")") {
  FrontEnd front_end;
  front_end.check(document(code, ports));
  if (front_end.diagnostics.all().empty()) return "";
  const support::Diagnostic& first = front_end.diagnostics.all()[0];
  const auto start = static_cast<int>(std::string(head).size() + 1);
  return std::to_string(static_cast<int>(first.where.begin) - start) + " " +
         std::string(support::id_text(first.id)) + ": " + first.message;
}

/// What the first error says to do.
std::string fix_of(const std::string& code) {
  FrontEnd front_end;
  front_end.check(document(code, R"("x": "x", "v": "v")"));
  return front_end.diagnostics.all().empty() ? "" : front_end.diagnostics.all()[0].fix;
}

TEST(Expression, SuggestsEquivalentsForOtherLanguages) {
  EXPECT_EQ(fix_of("lerp(x, 1, v)"), "its name here is \"mix\"");
  EXPECT_EQ(fix_of("power(x, v)"), "its name here is \"pow\"");
  EXPECT_EQ(fix_of("vec3(x) + v"), "its name here is \"vector3\"");
  EXPECT_EQ(fix_of("v * (x % 2)"), "write mod(x, y)");
  EXPECT_EQ(fix_of("v * x ^ 2"), "write pow(x, y)");
  EXPECT_EQ(fix_of("x = 1 ? v : 2"), "compare with ==");
}

TEST(Expression, SyntaxErrorsPointIntoTheCode) {
  EXPECT_EQ(error_of("x + * y"), "4 bad-expression: expected a value before \"*\"");
  EXPECT_EQ(error_of("x + (y"),
            "6 bad-expression: expected \")\" to close the parenthesis, but found the end of the code");
  EXPECT_EQ(error_of("x y"), "2 bad-expression: expected an operator before \"y\"");
  EXPECT_EQ(error_of(""), "0 bad-expression: the code is empty");
  EXPECT_EQ(error_of("x +"), "3 bad-expression: expected a value, but the code ends");
  EXPECT_EQ(error_of("x # y"), "2 bad-expression: expected an operator before \"#\"");
  EXPECT_EQ(error_of("1e99"), "0 bad-expression: \"1e99\" is beyond the range of float");
  EXPECT_EQ(error_of("x ? y"),
            "5 bad-expression: expected \":\" between the two results of \"?\", but found the end of the code");
  EXPECT_EQ(error_of("x = y"), "2 bad-expression: expected an operator before \"=\"");
  EXPECT_EQ(error_of("vector4(x, y, x)", R"("x": "x", "y": "y")"),
            "0 bad-expression: vector4 takes 1, 2 or 4 arguments, not 3");
  EXPECT_EQ(error_of("vector3(x, y)", R"("x": "x", "y": "y")"),
            "0 type-mismatch: a float and a float have 2 components, but vector3 has 3: set \"to\" to the type of the result");
  EXPECT_EQ(error_of("color4(v.xy, x)", R"("x": "x", "v": "v")"),
            "0 type-mismatch: a vector2 and a float have 3 components, but color4 has 4: set \"to\" to the type of the result");
  EXPECT_EQ(error_of("integer(x, y)"), "0 bad-expression: integer takes 1 argument, not 2");
  EXPECT_EQ(error_of("matrix33(x)"), "0 bad-expression: matrix33 takes 3 arguments, its columns, not 1");
  EXPECT_EQ(error_of("filename(x)"), "0 bad-expression: an expression cannot construct a filename");
  EXPECT_EQ(error_of("x + z"), "4 unknown-port: the expression has no port \"z\"");
  EXPECT_EQ(error_of("x.q", R"("x": "x")"), "0 unknown-output: \"x\" has no output \"q\"");
  EXPECT_EQ(error_of("lenght(v)", R"("v": "v")"),
            "0 unknown-node-type: there is no node type or library function \"lenght\"");
  EXPECT_EQ(error_of("max(x)", R"("x": "x")"), "0 missing-port: \"max\" takes 2 arguments: \"y\" is missing");
  EXPECT_EQ(error_of("max(x, y, 3)", R"("x": "x", "y": "y")"),
            "10 unknown-port: \"max\" takes only 2 arguments");
}

TEST(Expression, TypeMismatchesPointAtTheOperand) {
  const std::string ports = R"("x": "x", "v": "v")";
  EXPECT_EQ(error_of("x + v * v.xy", ports),
            "8 type-mismatch: the right side of \"*\" is vector2, but the left side is vector3");
  EXPECT_EQ(error_of("v > x ? x : 1", ports),
            "0 type-mismatch: the left side of \">\" takes float, not vector3");
  EXPECT_EQ(error_of("x ? v : x", ports),
            "0 type-mismatch: the condition of \"?:\" takes boolean, not float");
  EXPECT_EQ(error_of("dot(v, v.xy)", R"("v": "v")"),
            "7 type-mismatch: argument 2 of \"dot\" is vector2, but argument 1 is vector3");
}

TEST(Expression, ErrorPositionsAccountForEscapes) {
  EXPECT_EQ(error_of("\\u0078 + \\u0078 $"), "16 bad-expression: expected an operator before \"$\"");
}

TEST(Expression, WarnsOfUnreadPorts) {
  const std::string text = messages_of("x", R"("x": "x", "y": "y")");
  EXPECT_NE(text.find("warning[unread-key]: the code does not read \"y\""), std::string::npos) << text;
  EXPECT_EQ(text.find("error"), std::string::npos) << text;
}

TEST(Expression, VectorsAreConstructedFromAVectorAndANumber) {
  EXPECT_EQ(value_of("vector4(v, 7)"), (Floats{1, 2, 5, 7}));
  EXPECT_EQ(value_of("color4(color3(v), x)"), (Floats{1, 2, 5, 3}));
  EXPECT_EQ(value_of("color4(v, x)"), (Floats{1, 2, 5, 3}));
  EXPECT_EQ(value_of("vector3(v.xy, y)"), (Floats{1, 2, 4}));
  EXPECT_EQ(value_of("vector2(x, y)"), (Floats{3, 4}));
}

TEST(Expression, MatricesAreConstructedFromColumns) {
  EXPECT_EQ(value_of("transform(matrix33(v, v * 2, v.zyx), vector3(1, 10, 100))"),
            (Floats{1 + 20 + 500, 2 + 40 + 200, 5 + 100 + 100}));
  EXPECT_EQ(value_of("transform_point(matrix44(v, v, v, vector3(7, 8, 9)), vector3(0, 0, 0))"), (Floats{7, 8, 9}));
}

TEST(Expression, UnknownLinksAreReportedAtThePort) {
  const std::string text = messages_of("a + a + a", R"("a": "nowhere")");
  EXPECT_NE(text.find("there is no node or input \"nowhere\""), std::string::npos) << text;
  EXPECT_EQ(text.find("nowhere", text.find("^")), std::string::npos) << text;
}

TEST(Expression, RejectsHostileCode) {
  const std::string deep(100'000, '(');
  EXPECT_NE(error_of(deep).find("nested more than 100 deep"), std::string::npos);
  EXPECT_NE(error_of(std::string(100'000, '-') + "x").find("nested more than 100 deep"), std::string::npos);
  std::string selectors = "x";
  for (int i = 0; i < 100'000; ++i) selectors += ".x";
  EXPECT_NE(error_of(selectors).find("nested more than 100 deep"), std::string::npos);
  std::string chain = "x";
  for (int i = 0; i < 300'000; ++i) chain += "+x";
  EXPECT_NE(error_of(chain, R"("x": "x")").find("too-large"), std::string::npos);
  EXPECT_NE(error_of("x */ #include <x> \\u0000").find("bad-expression"), std::string::npos);
}

}  // namespace
}  // namespace isoshade
