// SPDX-License-Identifier: Apache-2.0
// Function documents as nodes: where they are found, and where they may not be.
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

std::string function(const std::string& name, const std::string& node) {
  return R"({"isoshade": 1, "function": ")" + name +
         R"(", "inputs": {"x": {"type": "float", "min": 0, "max": 1}},
"nodes": {"n": )" +
         node + R"(}, "outputs": {"out": "n"}})";
}
const std::string squared = R"({"type": "multiply", "in1": "x", "in2": "x"})";
std::string calls(const std::string& reference) { return R"({"type": ")" + reference + R"(", "x": "x"})"; }

TEST(CheckLibrary, ResolvesNamesAndRelativePaths) {
  FrontEnd front_end;
  front_end.library.add("library/math/square.json", function("square", squared));
  front_end.library.add("library/math/fourth.json", function("fourth", calls("square.json")));
  front_end.library.add("mine/part/own.json", function("own", calls("math/fourth")));
  const auto graph = front_end.check(function("f", calls("part/own.json")), "mine/f.json");
  ASSERT_NE(graph, nullptr) << front_end.diagnostics.text();
  const auto own = graph->nodes[0].callee;
  EXPECT_EQ(graph->document, "f.json") << "by its path in its collection";
  EXPECT_EQ(own->document, "part/own.json");
  EXPECT_EQ(own->nodes[0].callee->document, "library/math/fourth.json");
  EXPECT_EQ(own->nodes[0].callee->nodes[0].callee->document, "library/math/square.json");
}

TEST(CheckLibrary, AcceptsInputsNamedLikeFreeKeys) {
  FrontEnd front_end;
  front_end.library.add("library/odd.json", R"({"isoshade": 1, "function": "odd",
    "inputs": {"extras": {"type": "float"}, "doc": {"type": "float", "value": 2}},
    "nodes": {"n": {"type": "add", "in1": "extras", "in2": "doc"}}, "outputs": {"out": "n"}})");
  const auto graph = front_end.check(R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}},
    "nodes": {"a": {"type": "odd", "extras": "x", "doc": "x"}, "b": {"type": "odd", "extras": 0.5},
              "c": {"type": "odd", "extras": {"link": "a"}},
              "d": {"type": "add", "in1": "b", "in2": "c", "doc": "a remark", "extras": {"any": [1, "x"]}}},
    "outputs": {"out": "d"}})");
  ASSERT_NE(graph, nullptr) << front_end.diagnostics.text();
  using From = check::Operand::From;
  const auto from = [&](size_t node, size_t port) {
    return graph->operands_of(graph->nodes[node])[port].from;
  };
  EXPECT_EQ(from(0, 0), From::input);
  EXPECT_EQ(from(0, 1), From::input);
  EXPECT_EQ(from(1, 0), From::words);
  EXPECT_EQ(from(1, 1), From::words);
  EXPECT_EQ(from(2, 0), From::node);
  EXPECT_TRUE(front_end.diagnostics.all().empty()) << front_end.diagnostics.text();
}

TEST(CheckLibrary, ExplainsThatAnInputNamedTypeCannotBeSet) {
  FrontEnd front_end;
  front_end.library.add("library/odd.json", R"({"isoshade": 1, "function": "odd",
    "inputs": {"type": {"type": "float"}}, "outputs": {"out": "type"}})");
  const std::string messages = front_end.messages(R"({"isoshade": 1, "function": "f",
    "nodes": {"a": {"type": "odd"}}, "outputs": {"out": "a"}})");
  EXPECT_NE(messages.find("the key \"type\" of a node is its type"), std::string::npos) << messages;
}

TEST(CheckLibrary, EveryDocumentIsCheckedOnce) {
  FrontEnd front_end;
  front_end.library.add("library/square.json", function("square", squared));
  const auto graph = front_end.check(R"({"isoshade": 1, "function": "f", "nodes": {
    "a": {"type": "square", "x": 0.5}, "b": {"type": "square", "x": "a"}}, "outputs": {"out": "b"}})");
  ASSERT_NE(graph, nullptr) << front_end.diagnostics.text();
  EXPECT_EQ(graph->nodes[0].callee, graph->nodes[1].callee);
}

TEST(CheckLibrary, RecursionErrorShowsThePath) {
  FrontEnd front_end;
  front_end.library.add("a.json", function("a", calls("b.json")));
  front_end.library.add("b.json", function("b", calls("c.json")));
  front_end.library.add("c.json", function("c", calls("b.json")));
  EXPECT_EQ(front_end.messages(function("a", calls("b.json")), "a.json"),
            R"(c.json:2:25: error[recursion]: the function is recursive: b.json -> c.json -> b.json
  2 | "nodes": {"n": {"type": "b.json", "x": "x"}}, "outputs": {"out": "n"}}
    |                         ^^^^^^^^
)");
}

TEST(CheckLibrary, RejectsDocumentsThatUseThemselves) {
  FrontEnd front_end;
  EXPECT_NE(front_end.messages(function("a", calls("a.json")), "a.json").find("a.json -> a.json"),
            std::string::npos);
}

TEST(CheckLibrary, RejectsReferencesOutsideTheFolderTree) {
  for (const char* reference : {"../secret.json", "/etc/secret.json", "part/../../secret.json"}) {
    FrontEnd front_end;
    front_end.library.add("secret.json", function("secret", squared));
    EXPECT_NE(
        front_end.messages(function("f", calls(reference)), "mine/f.json").find("error[outside-reference]"),
        std::string::npos)
        << reference;
  }
}

TEST(CheckLibrary, RejectsLibraryNamesThatLeaveTheLibrary) {
  for (const char* reference : {"../secret", "brdf//x", "/secret", "brdf/", ".", ""}) {
    FrontEnd front_end;
    front_end.library.add("secret.json", function("secret", squared));
    EXPECT_NE(front_end.messages(function("f", calls(reference))).find("error[unknown-node-type]"),
              std::string::npos)
        << reference;
  }
}

TEST(CheckLibrary, RejectsReferencesFromTheLibraryToUserDocuments) {
  FrontEnd front_end;
  front_end.library.add("mine/own.json", function("own", squared));
  front_end.library.add("library/bad.json", function("bad", calls("../mine/own.json")));
  EXPECT_NE(front_end.messages(function("f", calls("bad")), "mine/f.json").find("error[outside-reference]"),
            std::string::npos);
}

TEST(CheckLibrary, MissingDocumentsAreReportedAtTheReference) {
  FrontEnd front_end;
  EXPECT_NE(
      front_end.messages(function("f", calls("nowhere.json"))).find("test.json:2:25: error[missing-file]"),
      std::string::npos);
}

TEST(CheckLibrary, RejectsEffectsAsNodes) {
  FrontEnd front_end;
  front_end.library.add("library/material.json", R"({"isoshade": 1, "effect": "material",
    "parameters": {"c": {"type": "color3", "value": [1, 1, 1]}}, "passes": [{"name": "p", "color": "c"}]})");
  EXPECT_NE(front_end.messages(function("f", calls("material"))).find("error[wrong-kind]"),
            std::string::npos);
}

TEST(CheckLibrary, FunctionErrorsAreReportedOnceAtTheirSource) {
  FrontEnd front_end;
  front_end.library.add("library/bad.json", function("bad", R"({"type": "floor", "in": "y"})"));
  EXPECT_EQ(front_end.messages(R"({"isoshade": 1, "function": "f", "nodes": {
    "a": {"type": "bad", "x": 0.5}, "b": {"type": "bad", "x": "a"}}, "outputs": {"out": "b"}})"),
            R"(library/bad.json:2:40: error[unknown-node]: there is no node or input "y"
  2 | "nodes": {"n": {"type": "floor", "in": "y"}}, "outputs": {"out": "n"}}
    |                                        ^^^
)");
  // Whoever asks the same library again is told too.
  support::Diagnostics later;
  const auto source = std::make_shared<support::SourceFile>("test.json", function("f", calls("bad")));
  auto graph = graph::build_graph(*graph::parse_document(source, later), later);
  EXPECT_EQ(check::check(std::move(*graph), front_end.library, later), nullptr);
  EXPECT_NE(later.text().find("error[broken-function]"), std::string::npos);
}

TEST(CheckLibrary, RejectsLiteralsOutsideTheInputRange) {
  FrontEnd front_end;
  front_end.library.add("library/square.json", function("square", squared));
  EXPECT_EQ(front_end.messages(function("f", R"({"type": "square", "x": 1.5})")),
            R"(test.json:2:40: error[out-of-range]: "x" of "square" must be at most 1.0
  2 | "nodes": {"n": {"type": "square", "x": 1.5}}, "outputs": {"out": "n"}}
    |                                        ^^^
library/square.json:1:55: note: declared here
  1 | {"isoshade": 1, "function": "square", "inputs": {"x": {"type": "float", "min": 0, "max": 1}},
    |                                                       ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
)");
}

TEST(CheckLibrary, EnumNamesInPortsSuggestTheirNumber) {
  const auto messages = [](const std::string& mode) {
    FrontEnd front_end;
    front_end.library.add("library/pick.json", R"({"isoshade": 1, "function": "pick",
      "inputs": {"mode": {"type": "integer", "enum": ["first", "second"]}},
      "nodes": {"n": {"type": "convert", "in": "mode", "to": "float"}}, "outputs": {"out": "n"}})");
    return front_end.messages(R"({"isoshade": 1, "function": "f", "nodes": {"p": {"type": "pick", "mode": )" +
                              mode + R"(}}, "outputs": {"out": "p"}})");
  };
  EXPECT_EQ(messages("1"), "");
  EXPECT_NE(messages("\"second\"").find("write 1, the number of that value"), std::string::npos);
  EXPECT_NE(messages("2").find("error[out-of-range]: \"mode\" of \"pick\" has no value 2"),
            std::string::npos);
  EXPECT_NE(messages("-1").find("note: it is 0 (first) or 1 (second)"), std::string::npos);
}

TEST(CheckLibrary, RejectsDeepNesting) {
  FrontEnd front_end;
  for (int i = 0; i < 100; ++i) {
    front_end.library.add("f" + std::to_string(i) + ".json",
                          function("f", calls("f" + std::to_string(i + 1) + ".json")));
  }
  EXPECT_NE(front_end.messages(function("f", calls("f0.json"))).find("error[too-deep]"), std::string::npos);
}

TEST(CheckLibrary, RejectsExponentialCallTrees) {
  FrontEnd front_end;
  const std::string twice = R"(, "m": )";
  front_end.library.add("f0.json", function("f", squared));
  for (int i = 1; i < 40; ++i) {
    const std::string call = calls("f" + std::to_string(i - 1) + ".json");
    front_end.library.add("f" + std::to_string(i) + ".json",
                          R"({"isoshade": 1, "function": "f",
      "inputs": {"x": {"type": "float"}}, "nodes": {"m": )" +
                              call + R"(, "n": )" + call +
                              R"(, "s": {"type": "add", "in1": "m", "in2": "n"}}, "outputs": {"out": "s"}})");
  }
  EXPECT_NE(front_end.messages(function("f", calls("f39.json"))).find("error[too-large]"), std::string::npos);
}

}  // namespace
}  // namespace isoshade
