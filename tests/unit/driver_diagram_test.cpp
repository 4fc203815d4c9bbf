// SPDX-License-Identifier: Apache-2.0
// Graphs as pictures: what is in the text that Graphviz gets.
#include "compiler/driver/diagram.h"
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

size_t count(const std::string& text, const std::string& part) {
  size_t found = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

class Diagram : public testing::Test {
 protected:
  std::string draw(const std::string& document, int depth = 1) {
    const auto graph = front_end.check(document);
    EXPECT_NE(graph, nullptr) << front_end.diagnostics.text();
    return graph != nullptr ? driver::draw(*graph, depth) : "";
  }
  FrontEnd front_end;
};

constexpr const char* squares = R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}},
  "nodes": {"a": {"type": "square", "in": "x"}, "b": {"type": "square", "in": "a"}},
  "outputs": {"out": "b"}})";
constexpr const char* square = R"({"isoshade": 1, "function": "square", "inputs": {"in": {"type": "float"}},
  "nodes": {"p": {"type": "multiply", "in1": "in", "in2": "in"}}, "outputs": {"out": "p"}})";

TEST_F(Diagram, HasABoxForEachNodeAndAnEdgeForEachLink) {
  const std::string text = draw(R"({"isoshade": 1, "function": "f", "inputs": {"v": {"type": "vector3"}},
    "nodes": {"m": {"type": "multiply", "in1": "v.zyx", "in2": 0.5}}, "outputs": {"out": "m"}})");
  EXPECT_EQ(count(text, "[label=<"), 3u) << text;
  EXPECT_EQ(count(text, " -> "), 2u);
  EXPECT_NE(text.find("<b>m</b>  multiply"), std::string::npos);
  EXPECT_NE(text.find("in2 = 0.5"), std::string::npos);
  EXPECT_NE(text.find("label=\".zyx\""), std::string::npos);
  EXPECT_NE(text.find("out  vector3"), std::string::npos);
}

TEST_F(Diagram, CalledDocumentsAreClustersUpToADepth) {
  front_end.library.add("library/square.json", square);
  const std::string open = draw(squares), closed = draw(squares, 0);
  EXPECT_EQ(count(open, "subgraph cluster_"), 2u);
  EXPECT_EQ(count(open, "<b>p</b>  multiply"), 2u);
  EXPECT_EQ(count(closed, "subgraph"), 0u);
  EXPECT_NE(closed.find("<b>a</b>  square"), std::string::npos);
}

TEST_F(Diagram, ExpressionIsOneBoxWithItsCode) {
  const std::string text = draw(R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}},
    "nodes": {"e": {"type": "expression", "code": "a < 2 && b > a ? a : b", "a": "x", "b": 3}},
    "outputs": {"out": "e"}})");
  EXPECT_EQ(count(text, "[label=<"), 3u) << text;
  EXPECT_NE(text.find("a &lt; 2 &amp;&amp; b &gt; a ? a : b"), std::string::npos);
  EXPECT_EQ(count(text, " -> "), 2u);
  EXPECT_NE(text.find("b = 3.0"), std::string::npos);
}

TEST_F(Diagram, VeryLargeGraphsAreTruncatedWithANote) {
  std::string nodes = R"("n0": {"type": "add", "in1": "x", "in2": 1})";
  for (int i = 1; i < 3000; ++i)
    nodes += ", \"n" + std::to_string(i) + R"(": {"type": "add", "in1": "n)" + std::to_string(i - 1) +
             R"(", "in2": 1})";
  const std::string text =
      draw(R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}}, "nodes": {)" + nodes +
           R"(}, "outputs": {"out": "n2999"}})");
  EXPECT_NE(text.find("more than 2000 nodes"), std::string::npos);
  EXPECT_LT(count(text, "[label=<"), 2100u);
}

/// A chain of `count` sums, each of the one before and the first.
std::string chain(int count) {
  std::string nodes = R"("n0": {"type": "add", "in1": "x", "in2": 1})";
  for (int i = 1; i < count; ++i)
    nodes += ", \"n" + std::to_string(i) + R"(": {"type": "add", "in1": "n)" + std::to_string(i - 1) +
             R"(", "in2": "n0"})";
  return R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}}, "nodes": {)" + nodes +
         R"(}, "outputs": {"out": "n)" + std::to_string(count - 1) + "\"}}";
}

// Graphviz takes minutes to find places for some hundred boxes, so it is told them.
TEST_F(Diagram, LargeGraphsPlaceEachBoxRightOfItsInputs) {
  const std::string text = draw(chain(500));
  EXPECT_NE(text.find("layout=nop"), std::string::npos);
  const size_t boxes = count(text, "[label=<");
  EXPECT_EQ(boxes, 502u);
  EXPECT_EQ(count(text, " [pos=\""), boxes);
  const auto column = [&](const std::string& box) {
    const std::string head = "  " + box + " [pos=\"";
    const size_t at = text.find(head);
    return at == std::string::npos ? -1 : std::stoi(text.substr(at + head.size()));
  };
  size_t links = 0;
  for (size_t at = 0; (at = text.find(" -> ", at)) != std::string::npos; ++at, ++links) {
    const size_t begin = text.rfind('n', text.rfind(':', at));
    const std::string from = text.substr(begin, text.find(':', begin) - begin);
    const std::string to = text.substr(at + 4, text.find(':', at) - at - 4);
    EXPECT_LT(column(from), column(to)) << from << " " << to;
  }
  EXPECT_EQ(links, 1000u);
}

TEST_F(Diagram, SmallGraphsAreLaidOutByGraphviz) {
  EXPECT_EQ(draw(chain(100)).find("layout="), std::string::npos);
}

TEST_F(Diagram, ManyInputsAreTruncated) {
  std::string inputs = R"("x": {"type": "float"})";
  for (int i = 0; i < 5000; ++i) inputs += ", \"x" + std::to_string(i) + R"(": {"type": "float"})";
  const std::string text = draw(R"({"isoshade": 1, "function": "f", "inputs": {)" + inputs +
                                R"(}, "nodes": {}, "outputs": {"out": "x"}})");
  EXPECT_NE(text.find("more than 2000 nodes"), std::string::npos);
  EXPECT_LT(count(text, "[label=<"), 2100u);
}

TEST_F(Diagram, DocumentTextIsEscaped) {
  const std::string evil = R"(</b><img src=\"/etc/passwd\"/>\" ] } \\n &amp; -> \u202e)";
  const std::string text = draw(R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}},
    "nodes": {"c": {"type": "combine3", "in1": "x", "to": "color3", "doc": ")" +
                                evil + R"("},
              "e": {"type": "expression", "code": "c.x < 1 ? c : c", "c": "c", "doc": ")" +
                                evil + R"("}},
    "outputs": {"out": "e"}})");
  EXPECT_EQ(text.find("<img"), std::string::npos);
  EXPECT_EQ(text.find("passwd"), std::string::npos);
}

}  // namespace
}  // namespace isoshade
