// SPDX-License-Identifier: Apache-2.0
// Effects that extend others.
#include <gtest/gtest.h>
#include <memory>

#include "compiler/graph/extend.h"
#include "compiler/graph/graph.h"

namespace isoshade::graph {
namespace {

/// The effect that the others change; it lies in a folder of its own.
constexpr const char* base = R"({
  "isoshade": 1,
  "effect": "base",
  "parameters": {
    "a": {"type": "float", "value": 0.5, "min": 0, "max": 1, "doc": "first"},
    "map": {"type": "filename", "value": "a.png"}
  },
  "nodes": {
    "n": {"type": "multiply", "in1": "a", "in2": 2},
    "e": {"type": "expression", "code": "x * 3 + y", "x": "n", "y": "a"}
  },
  "passes": [{"name": "p", "color": "e"}]
})";

class ExtendEffect : public ::testing::Test {
 protected:
  ExtendEffect() { add("mine/base/base.json", base); }

  void add(const std::string& path, const std::string& text) {
    files_.memory[canonical_path(path)] = std::make_shared<support::SourceFile>(path, text);
  }
  std::optional<Graph> build(const std::string& members) {
    diagnostics_ = support::Diagnostics();
    const auto source = std::make_shared<support::SourceFile>("mine/top.json",
                                                              R"({"isoshade": 1, "effect": "top", )" + members + "}");
    files_.memory[canonical_path("mine/top.json")] = source;
    const auto document = load_document(source, files_, diagnostics_);
    return document ? build_graph(*document, diagnostics_) : std::nullopt;
  }
  /// "id: message" of the first error.
  std::string error(const std::string& members) {
    if (build(members)) return "";
    const support::Diagnostic& first = diagnostics_.all().front();
    return std::string(support::id_text(first.id)) + ": " + first.message;
  }

  FileRule files_;
  support::Diagnostics diagnostics_;
};

TEST_F(ExtendEffect, ChangesParametersNodesAndPasses) {
  const auto graph = build(R"("extends": "base/base.json",
"parameters": {"a": {"value": 3, "max": 4}, "b": {"type": "float", "value": 1}, "map": null},
"nodes": {"n": {"in2": "b"}, "m": {"type": "add", "in1": "n", "in2": 1}},
"passes": [{"name": "q", "color": "m"}])");
  ASSERT_TRUE(graph) << diagnostics_.text();
  EXPECT_EQ(graph->name, "top");
  ASSERT_EQ(graph->inputs.size(), 2u);
  EXPECT_EQ(graph->inputs[0].value->number, 3.0f);
  EXPECT_EQ(graph->inputs[0].min, 0.0f);
  EXPECT_EQ(graph->inputs[0].max, 4.0f);
  EXPECT_EQ(graph->inputs[0].doc, "first");
  EXPECT_EQ(graph->inputs[1].name, "b");
  EXPECT_EQ(graph->nodes[0].ports[1].name, "in2");
  EXPECT_EQ(std::get<Literal>(graph->nodes[0].ports[1].value).string, "b");
  ASSERT_EQ(graph->passes.size(), 1u);
  EXPECT_EQ(graph->passes[0].name, "q");
}

TEST_F(ExtendEffect, PlacesLieInTheFileThatContainsThem) {
  const auto graph = build(R"("extends": "base/base.json", "parameters": {"map": {"value": "b.png"}})");
  ASSERT_TRUE(graph) << diagnostics_.text();
  const auto path = [&](TextRange place) { return graph->span(place).file->path(); };
  EXPECT_EQ(path(graph->name_place), "mine/top.json");
  EXPECT_EQ(path(graph->inputs[0].value_place), "mine/base/base.json");
  EXPECT_EQ(path(graph->inputs[1].value_place), "mine/top.json");
  EXPECT_EQ(path(graph->nodes[0].type_place), "mine/base/base.json");
  EXPECT_EQ(path(graph->nodes[0].ports[0].place), "mine/base/base.json");
  for (const Node& node : graph->nodes) {
    const support::Span span = graph->span(node.type_place);
    EXPECT_EQ(span.file->path(), "mine/base/base.json") << node.label();
    EXPECT_GE(span.line(), 9u) << "of an operation of an expression, in its code";
  }
}

TEST_F(ExtendEffect, ErrorsPointIntoTheirFile) {
  EXPECT_EQ(error(R"("extends": "base/base.json", "parameters": {"a": {"value": 2}})"),
            "out-of-range: the value of \"a\" is greater than its max 1.0");
  EXPECT_EQ(diagnostics_.all()[0].where.file->path(), "mine/top.json");
  EXPECT_EQ(error(R"("extends": "base/base.json", "parameters": {"a": {"max": 0.25}})"),
            "out-of-range: the value of \"a\" is greater than its max 0.25");
  EXPECT_EQ(diagnostics_.all()[0].where.file->path(), "mine/base/base.json");
  EXPECT_EQ(diagnostics_.all()[0].where.line(), 5u);
  EXPECT_EQ(error(R"("extends": "base/base.json", "nodes": {"e": {"y": null}})"),
            "unknown-port: the expression has no port \"y\"");
  EXPECT_EQ(diagnostics_.all()[0].where.file->path(), "mine/base/base.json");
  EXPECT_EQ(diagnostics_.all()[0].where.line(), 10u);
  EXPECT_EQ(error(R"("extends": "base/base.json", "nodes": {"x": null})"),
            "unknown-key: there is no \"x\" to remove");
  EXPECT_EQ(error(R"("extends": "base/base.json", "nodes": {"e": {"x": "2 3"}})"), "") << "checked with the types";
}

TEST_F(ExtendEffect, ExtendsAnEffectThatExtendsAnother) {
  add("mine/middle.json", R"({"isoshade": 1, "effect": "m", "extends": "base/base.json",
    "parameters": {"a": {"value": 0.25}}})");
  const auto graph = build(R"("extends": "middle.json", "parameters": {"a": {"doc": "last"}})");
  ASSERT_TRUE(graph) << diagnostics_.text();
  EXPECT_EQ(graph->inputs[0].value->number, 0.25f);
  EXPECT_EQ(graph->inputs[0].doc, "last");
  ASSERT_EQ(graph->bases.size(), 2u);
  EXPECT_EQ(graph->bases[0]->path(), "mine/middle.json");
  EXPECT_EQ(graph->bases[1]->path(), "mine/base/base.json");
}

TEST_F(ExtendEffect, RejectsWhatIsNoBase) {
  add("mine/scene.json", R"({"isoshade": 1, "scene": "s"})");
  add("mine/self.json", R"({"isoshade": 1, "effect": "s", "extends": "top.json"})");
  add("outside.json", base);
  EXPECT_EQ(error(R"("extends": 1)"), "wrong-type: \"extends\" must be the path of an effect, not a number");
  EXPECT_EQ(error(R"("extends": null)"), "wrong-type: \"extends\" must be the path of an effect, not null");
  EXPECT_EQ(error(R"("extends": "")"), "missing-file: \"extends\" must be the path of an effect, but is empty");
  EXPECT_EQ(error(R"("extends": "scene.json")"),
            "wrong-kind: \"mine/scene.json\" is not an effect, but a document of the kind scene");
  EXPECT_NE(error(R"("extends": "none.json")").find("missing-file: "), std::string::npos);
  EXPECT_EQ(error(R"("extends": "self.json")"), "recursion: the effect extends itself through \"mine/top.json\"");
  EXPECT_EQ(error(R"("extends": "top.json")"), "recursion: the effect extends itself through \"mine/top.json\"");
  EXPECT_NE(error(R"("extends": "../outside.json")").find("outside-reference: "), std::string::npos);
}

TEST_F(ExtendEffect, AllowsChainsOfSixteenEffects) {
  // The effect of each number ends a chain of so many.
  add("mine/e1.json", base);
  for (size_t i = 2; i <= max_chain; ++i)
    add("mine/e" + std::to_string(i) + ".json",
        R"({"isoshade": 1, "effect": "e", "extends": "e)" + std::to_string(i - 1) + R"(.json"})");
  const auto on = [](size_t last) { return R"("extends": "e)" + std::to_string(last) + R"(.json")"; };
  EXPECT_EQ(error(on(max_chain - 1)), "");
  EXPECT_EQ(error(on(max_chain)), "too-large: more than 16 effects extend each other");
}

TEST_F(ExtendEffect, PostsAndFunctionsDoNotExtend) {
  for (const char* kind : {"post", "function"}) {
    const auto source = std::make_shared<support::SourceFile>(
        "mine/other.json", R"({"isoshade": 1, ")" + std::string(kind) + R"(": "f", "extends": "base/base.json",
          "outputs": {"out": "x"}})");
    diagnostics_ = support::Diagnostics();
    const auto document = load_document(source, files_, diagnostics_);
    ASSERT_TRUE(document);
    EXPECT_FALSE(build_graph(*document, diagnostics_));
    EXPECT_NE(diagnostics_.text().find("has no key \"extends\""), std::string::npos) << diagnostics_.text();
  }
}

}  // namespace
}  // namespace isoshade::graph
