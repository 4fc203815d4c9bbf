// SPDX-License-Identifier: Apache-2.0
// What an author is told about names: of nodes, ports, outputs, components, and about circles.
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

/// What is said of a function document with two inputs and these nodes and outputs, a line each.
std::string messages_of(const std::string& nodes, const std::string& outputs = R"("out": "a")") {
  FrontEnd front_end;
  return front_end.messages(
      "{\"isoshade\": 1, \"function\": \"f\",\n"
      "\"inputs\": {\"alpha\": {\"type\": \"float\"}, \"normal\": {\"type\": \"vector3\"}},\n"
      "\"nodes\": {\n" +
      nodes + "\n},\n\"outputs\": {" + outputs + "}}");
}

TEST(CheckLinks, UnknownNamesSuggestTheNearestAndItsKind) {
  EXPECT_EQ(messages_of(R"("a": {"type": "add", "in1": "alhpa", "in2": 1})"),
            R"(test.json:4:29: error[unknown-node]: there is no node or input "alhpa"
  4 | "a": {"type": "add", "in1": "alhpa", "in2": 1}
    |                             ^^^^^^^ did you mean "alpha" (input, line 2)?
)");
  EXPECT_EQ(messages_of(R"("a": {"type": "floor", "in": "alpha"})", R"("out": "aa")"),
            R"(test.json:6:20: error[unknown-node]: there is no node or input "aa"
  6 | "outputs": {"out": "aa"}}
    |                    ^^^^ did you mean "a" (node, line 4)?
)");
}

TEST(CheckLinks, UnknownNodeTypesSuggestNodesAndFunctions) {
  EXPECT_EQ(messages_of(R"("a": {"type": "multiplay", "in1": "alpha", "in2": 1})"),
            R"(test.json:4:15: error[unknown-node-type]: there is no node type or library function "multiplay"
  4 | "a": {"type": "multiplay", "in1": "alpha", "in2": 1}
    |               ^^^^^^^^^^^ did you mean "multiply"?
)");
}

TEST(CheckLinks, UnknownPortsListTheExistingPorts) {
  EXPECT_EQ(messages_of(R"("a": {"type": "clamp", "in": "alpha", "hihg": 1})"),
            R"(test.json:4:39: error[unknown-port]: "clamp" has no port "hihg"
  4 | "a": {"type": "clamp", "in": "alpha", "hihg": 1}
    |                                       ^^^^^^ did you mean "high"?
  note: its ports are "in", "low" and "high"
)");
}

TEST(CheckLinks, MissingPortsShowTheirDocumentation) {
  EXPECT_EQ(messages_of(R"("a": {"type": "mix", "bg": "alpha", "mix": 0.5})"),
            R"(test.json:4:1: error[missing-port]: node "a" ("mix") needs "fg"
  4 | "a": {"type": "mix", "bg": "alpha", "mix": 0.5}
    | ^^^
  note: fg: the value at 1
)");
}

TEST(CheckLinks, RejectsSwizzlesOfMissingComponents) {
  EXPECT_EQ(messages_of(R"("a": {"type": "floor", "in": "normal.xyw"})"),
            R"(test.json:4:30: error[bad-swizzle]: "xyw" is not a valid swizzle of vector3
  4 | "a": {"type": "floor", "in": "normal.xyw"}
    |                              ^^^^^^^^^^^^
  note: a vector3 has the components xyz, or rgb
)");
  EXPECT_EQ(messages_of(R"("a": {"type": "floor", "in": "alpha.x"})"),
            R"(test.json:4:30: error[bad-swizzle]: "x" is not a valid swizzle of float
  4 | "a": {"type": "floor", "in": "alpha.x"}
    |                              ^^^^^^^^^
  note: only vectors and colours have components
)");
  EXPECT_NE(messages_of(R"("a": {"type": "floor", "in": "normal.xg"})").find("bad-swizzle"),
            std::string::npos);
  EXPECT_NE(messages_of(R"("a": {"type": "floor", "in": "normal.xyzxy"})").find("bad-swizzle"),
            std::string::npos);
}

TEST(CheckLinks, RejectsUnknownOutputs) {
  EXPECT_EQ(messages_of(R"("a": {"type": "floor", "in": "alpha"})", R"("out": "a.out")"), "");
  EXPECT_EQ(messages_of(R"("a": {"type": "floor", "in": "alpha"})", R"("out": "a.result")"),
            R"(test.json:6:20: error[unknown-output]: "a" has no output "result"
  6 | "outputs": {"out": "a.result"}}
    |                    ^^^^^^^^^^
  note: its output is "out"
)");
}

TEST(CheckLinks, RejectsAmbiguousOutputs) {
  FrontEnd front_end;
  front_end.library.add("library/both.json",
                        R"({"isoshade": 1, "function": "both", "inputs": {"x": {"type": "vector3"}},
                            "outputs": {"first": "x.x", "rest": "x.yz"}})");
  EXPECT_EQ(front_end.messages(R"({"isoshade": 1, "function": "f", "nodes": {
"a": {"type": "both", "x": [1, 2, 3]}}, "outputs": {"out": "a", "y": "a.rest.y"}})"),
            R"(test.json:2:60: error[unknown-output]: "a" has several outputs; the link must name one
  2 | "a": {"type": "both", "x": [1, 2, 3]}}, "outputs": {"out": "a", "y": "a.rest.y"}}
    |                                                            ^^^
  note: its outputs are "first" and "rest"
)");
}

TEST(CheckLinks, CycleErrorsShowThePath) {
  EXPECT_EQ(messages_of("\"a\": {\"type\": \"add\", \"in1\": \"b\", \"in2\": 1},\n"
                        "\"b\": {\"type\": \"floor\", \"in\": \"c\"},\n"
                        "\"c\": {\"type\": \"floor\", \"in\": \"b\"},\n"
                        "\"d\": {\"type\": \"floor\", \"in\": \"d\"},\n"
                        "\"e\": {\"type\": \"expression\", \"code\": \"y + 1\", \"y\": \"e\"}"),
            R"(test.json:6:30: error[cycle]: the nodes form a cycle: b -> c -> b
  6 | "c": {"type": "floor", "in": "b"},
    |                              ^^^
test.json:7:30: error[cycle]: the nodes form a cycle: d -> d
  7 | "d": {"type": "floor", "in": "d"},
    |                              ^^^
test.json:8:51: error[cycle]: the nodes form a cycle: e -> e
  8 | "e": {"type": "expression", "code": "y + 1", "y": "e"}
    |                                                   ^^^
)");
}

TEST(CheckLinks, OneMistakeCausesOneError) {
  FrontEnd front_end;
  front_end.check(R"({"isoshade": 1, "function": "f", "nodes": {
    "a": {"type": "add", "in1": "nowhere", "in2": 1}, "b": {"type": "floor", "in": "a.xyzw"},
    "c": {"type": "dotproduct", "in1": "b", "in2": "a"}}, "outputs": {"out": "c"}})");
  EXPECT_EQ(front_end.diagnostics.all().size(), 1u) << front_end.diagnostics.text();
}

TEST(CheckLinks, WarnsOfUnusedNodes) {
  EXPECT_EQ(messages_of(R"("a": {"type": "floor", "in": "alpha"}, "b": {"type": "floor", "in": "a"})"),
            R"(test.json:4:40: warning[unused-node]: no output depends on node "b"
  4 | "a": {"type": "floor", "in": "alpha"}, "b": {"type": "floor", "in": "a"}
    |                                        ^^^
)");
}

}  // namespace
}  // namespace isoshade
