// SPDX-License-Identifier: Apache-2.0
// Functions with inputs of any type: one document, an instance for each type that calls have.
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

using Floats = std::vector<float>;

constexpr const char* twice = R"({"isoshade": 1, "function": "twice",
  "inputs": {"in": {"type": "any"}, "more": {"type": "any", "value": 0}},
  "nodes": {"sum": {"type": "add", "in1": "in", "in2": "in"}, "d": {"type": "add", "in1": "sum", "in2": "more"}},
  "outputs": {"out": "d"}})";

std::string document(const std::string& nodes) {
  return R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}, "v": {"type": "vector3"},
    "c": {"type": "color3"}, "b": {"type": "boolean"}, "i": {"type": "integer"}},
"nodes": {)" +
         nodes + R"(}, "outputs": {"out": "n"}})";
}

class Generic : public testing::Test {
 protected:
  Generic() { front_end.library.add("library/twice.json", twice); }

  std::string type_of(const std::string& node) {
    const auto graph = front_end.check(document("\"n\": {\"type\": \"twice\", " + node + "}"));
    return graph == nullptr ? "" : std::string(graph::type_name(graph->outputs[0].needed));
  }

  FrontEnd front_end;
};

TEST_F(Generic, TypeComesFromLinksBeforeLiterals) {
  EXPECT_EQ(type_of(R"("in": "x")"), "float");
  EXPECT_EQ(type_of(R"("in": "v")"), "vector3");
  EXPECT_EQ(type_of(R"("in": "c")"), "color3");
  EXPECT_EQ(type_of(R"("in": "i")"), "float");
  EXPECT_EQ(type_of(R"("in": "x", "more": "c")"), "color3");
  EXPECT_EQ(type_of(R"("in": "c", "more": [1, 2, 3])"), "color3");
  EXPECT_EQ(type_of(R"("in": 1)"), "float");
  EXPECT_EQ(type_of(R"("in": [1, 2])"), "vector2");
}

TEST_F(Generic, EachTypeIsInstantiatedOnce) {
  const ir::Module module = front_end.lower(document(
      R"("a": {"type": "twice", "in": "x"}, "b1": {"type": "twice", "in": "v"}, "b2": {"type": "twice", "in": "b1"},
         "n": {"type": "twice", "in": "a", "more": "b2"})"));
  std::vector<std::string> names;
  for (const ir::Function& function : module.functions) names.push_back(function.name);
  EXPECT_EQ(names, (std::vector<std::string>{"twice", "twice_vector3", "f"}));
}

TEST_F(Generic, ComputesComponentwise) {
  Program program(front_end.lower(document(R"("n": {"type": "twice", "in": "v", "more": "x"})")));
  EXPECT_EQ(program({1, 2, 3, 4, 0, 0, 0, 0, 0}), (Floats{5, 7, 9}));
}

TEST_F(Generic, MayCallOtherGenerics) {
  front_end.library.add("library/four.json", R"json({"isoshade": 1, "function": "four",
    "inputs": {"in": {"type": "any"}},
    "nodes": {"a": {"type": "twice", "in": "in"},
              "b": {"type": "expression", "code": "twice(a, 1)", "a": "a"}},
    "outputs": {"out": "b"}})json");
  Program program(front_end.lower(document(R"("n": {"type": "four", "in": "v"})")));
  EXPECT_EQ(program({0, 1, 2, 3, 0, 0, 0, 0, 0}), (Floats{5, 9, 13}));
}

TEST_F(Generic, RejectsUnsupportedTypes) {
  EXPECT_EQ(type_of(R"("in": "b")"), "");
  EXPECT_NE(front_end.diagnostics.text().find(
                "\"in\" of \"twice\" takes float, vector2, vector3, vector4, color3 or color4, not boolean"),
            std::string::npos)
      << front_end.diagnostics.text();
}

TEST_F(Generic, RejectsMismatchedTypes) {
  EXPECT_EQ(type_of(R"("in": "v", "more": "c")"), "");
  EXPECT_NE(front_end.diagnostics.text().find("\"more\" of \"twice\" is color3, but \"in\" is vector3"),
            std::string::npos)
      << front_end.diagnostics.text();
}

TEST_F(Generic, ErrorsInAnInstanceNameTheCall) {
  front_end.library.add("library/high.json", R"({"isoshade": 1, "function": "high",
    "inputs": {"in": {"type": "any"}},
    "nodes": {"n": {"type": "ifgreater", "value1": "in", "value2": 0, "in1": 1, "in2": 0}},
    "outputs": {"out": "n"}})");
  EXPECT_EQ(front_end.check(document(R"("n": {"type": "high", "in": "v"})")), nullptr);
  const std::string text = front_end.diagnostics.text();
  EXPECT_NE(text.find("\"value1\" of \"ifgreater\" takes float, not vector3"), std::string::npos) << text;
  EXPECT_NE(text.find("used here, with type vector3"), std::string::npos) << text;
}

TEST_F(Generic, RejectsGenericEffectParameters) {
  const std::string text = front_end.messages(R"({"isoshade": 1, "effect": "e",
    "parameters": {"p": {"type": "any", "value": 1}}, "passes": [{"name": "a", "color": "p"}]})");
  EXPECT_NE(text.find("unknown-type"), std::string::npos) << text;
}

TEST_F(Generic, UnusedNodesAreReportedOnce) {
  front_end.library.add("library/idle.json", R"({"isoshade": 1, "function": "idle",
    "inputs": {"in": {"type": "any"}}, "nodes": {"lost": {"type": "add", "in1": "in", "in2": 1}},
    "outputs": {"out": "in"}})");
  front_end.check(document(R"("a": {"type": "idle", "in": "v"}, "n": {"type": "idle", "in": "a"})"));
  EXPECT_EQ(front_end.diagnostics.all().size(), 1u) << front_end.diagnostics.text();
}

}  // namespace
}  // namespace isoshade
