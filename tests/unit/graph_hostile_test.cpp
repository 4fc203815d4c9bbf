// SPDX-License-Identifier: Apache-2.0
// Documents that mean harm: each ends in a diagnostic with a place, soon, and in little memory.
#include <ctime>
#include <gtest/gtest.h>
#include <random>

#include "compiler/graph/graph.h"

namespace isoshade::graph {
namespace {

using support::Diagnostics;
using support::Id;

/// The diagnostics of a text through parse_document and build_graph; every one that is shown has a place.
Diagnostics run(std::string text) {
  Diagnostics diagnostics;
  const auto source = std::make_shared<support::SourceFile>("a.json", std::move(text));
  const std::optional<Document> document = parse_document(source, diagnostics);
  const std::optional<Graph> graph = document ? build_graph(*document, diagnostics) : std::nullopt;
  EXPECT_EQ(graph.has_value(), !diagnostics.has_errors());
  for (const support::Diagnostic& diagnostic : diagnostics.all()) {
    EXPECT_EQ(diagnostic.where.file, source);
    EXPECT_LE(diagnostic.where.begin, diagnostic.where.end);
    EXPECT_LE(diagnostic.where.end, source->text().size());
  }
  EXPECT_LT(diagnostics.text().size(), 1u << 20);
  return diagnostics;
}

Id first_error(std::string text) {
  const Diagnostics diagnostics = run(std::move(text));
  EXPECT_TRUE(diagnostics.has_errors());
  return diagnostics.has_errors() ? diagnostics.all()[0].id : Id{};
}

std::string repeat(std::string_view text, size_t count) {
  std::string out;
  out.reserve(text.size() * count);
  for (size_t i = 0; i < count; ++i) out += text;
  return out;
}

TEST(Hostile, DeepNestingIsReported) {
  EXPECT_EQ(first_error(repeat("[", 100'000)), Id::too_deep);
  EXPECT_EQ(first_error(repeat("{\"a\":", 100'000)), Id::too_deep);
  EXPECT_EQ(first_error(repeat("[", 100'000) + repeat("]", 100'000)), Id::too_deep);
  Diagnostics diagnostics;
  const std::string deepest = repeat("[", max_depth) + repeat("]", max_depth);
  EXPECT_TRUE(
      parse_document(std::make_shared<support::SourceFile>("a.json", deepest), diagnostics).has_value());
}

TEST(Hostile, HugeArraysAreReported) {
  EXPECT_EQ(first_error("[" + repeat("0,", 1'100'000) + "0]"), Id::too_large);
  EXPECT_EQ(first_error("[" + repeat("[],", 1'100'000) + "0]"), Id::too_large);
}

TEST(Hostile, HugeTextsAreReported) {
  EXPECT_EQ(first_error(std::string(max_document_bytes + 1, ' ')), Id::too_large);
  EXPECT_EQ(first_error(std::string(max_document_bytes, '\n')), Id::too_large);
  EXPECT_EQ(first_error("[" + repeat(std::string(60'000, '\n') + ",", 100)), Id::syntax);
  EXPECT_EQ(first_error("\"" + std::string(10'000'000, 'x')), Id::syntax);
  EXPECT_EQ(first_error(std::string(10'000'000, '9')), Id::bad_number);
}

TEST(Hostile, ManyErrorsAreReportedQuickly) {
  const std::clock_t begin = std::clock();
  std::string inputs, nodes;
  for (int i = 0; i < 50'000; ++i) {
    const std::string name = std::to_string(i);
    inputs += ",\"" + name + "\":{\"type\":\"flaot\",\"maxx\":1}";
    nodes += ",\"" + name + "\":{\"a b\":null,\"c\":[\"x\"]}";
  }
  const Diagnostics diagnostics = run(R"({"isoshade":1,"function":"f","inputs":{)" + inputs.substr(1) +
                                      "},\"nodes\":{" + nodes.substr(1) + "},\"outputs\":{}}");
  EXPECT_GT(diagnostics.error_count(), 200'000u);
  // Of the processor, so that other work on the machine does not count; what is quadratic takes minutes.
  EXPECT_LT((std::clock() - begin) / CLOCKS_PER_SEC, 10);
}

TEST(Hostile, LongNamesAreReported) {
  const std::string name(1'000'000, 'x');
  EXPECT_EQ(first_error(R"({"isoshade":1,"function":")" + name + R"(","outputs":{"out":"a"}})"), Id::bad_id);
  EXPECT_EQ(first_error(R"({"isoshade":1,"function":"f","outputs":{"out":")" + name + R"("}})"),
            Id::bad_link);
  EXPECT_EQ(first_error(R"({"isoshade":1,"function":"f","outputs":{"out":"a"},")" + name + "\":1}"),
            Id::unknown_key);
}

TEST(Hostile, MutatedDocumentsYieldAGraphOrADiagnostic) {
  const std::string good = R"({"$schema": "x", "isoshade": 1, "effect": "toon", "doc": "\u00e9",
  "parameters": {"scale": {"type": "float", "value": 0.5, "min": 0, "max": 1e0}, "map": {"type": "filename", "value": "a.png"}},
  "nodes": {"n": {"type": "multiply", "in1": "scale", "in2": [1, 2.5, -3]}, "m": {"type": "image", "file": {"link": "map"}}},
  "passes": [{"name": "base", "cull": "back", "depth": "nearer", "position": "n.xyz", "color": "m.out.xyz"}], "extras": null})";
  ASSERT_EQ(run(good).text(), "");
  constexpr std::string_view tokens[] = {"{",  "}",    "[",     "]", ",",      ":",    "\"",
                                         "\\", "null", "1e400", "-", "\"a\":", "\xff", "\\ud800"};
  std::mt19937 random(7);
  const auto below = [&](size_t n) { return random() % n; };
  for (int i = 0; i < 3000; ++i) {
    std::string text = good;
    for (size_t edits = 1 + below(3); edits > 0; --edits) {
      const size_t at = below(text.size());
      switch (below(5)) {
        case 0: text[at] = static_cast<char>(below(256)); break;
        case 1: text.erase(at, 1 + below(20)); break;
        case 2: text.insert(at, tokens[below(std::size(tokens))]); break;
        case 3: text.insert(at, text.substr(below(text.size()), below(60))); break;
        case 4: text.resize(at + 1); break;
      }
    }
    SCOPED_TRACE(text);
    run(text);
    if (HasFailure()) break;
  }
}

}  // namespace
}  // namespace isoshade::graph
