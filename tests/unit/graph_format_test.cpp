// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <gtest/gtest.h>
#include <memory>

#include "compiler/graph/document.h"

namespace isoshade::graph {
namespace {

std::string formatted(std::string text) {
  support::Diagnostics diagnostics;
  const auto source = std::make_shared<support::SourceFile>("test.json", std::move(text));
  const auto document = parse_document(source, diagnostics);
  EXPECT_TRUE(document) << diagnostics.text();
  return document ? format(*document) : "";
}

TEST(Format, BreaksObjectsThatDoNotFitOnALine) {
  EXPECT_EQ(formatted(R"({"a":1,"b":[1,2.50 , 3e0],"c":{"x":{"y":[]}, "z" : {}}})"),
            R"({
  "a": 1,
  "b": [1, 2.50, 3e0],
  "c": {
    "x": {"y": []},
    "z": {}
  }
}
)");
}

TEST(Format, FillsLinesUpToTheLastColumn) {
  const std::string word(99, 'x');
  const std::string fits = "{\n  \"a\": [\"" + word + "\", \"123456\"]\n}\n";
  EXPECT_EQ(fits.find('\n', 2) - 2, 120u);
  EXPECT_EQ(formatted(fits), fits);
  const std::string longer = "{\n  \"a\": [\"" + word + "x\", \"123456\"]\n}\n";
  EXPECT_EQ(formatted(longer), "{\n  \"a\": [\n    \"" + word + "x\",\n    \"123456\"\n  ]\n}\n");
}

TEST(Format, KeepsBlankLinesOrderAndSpelling) {
  EXPECT_EQ(
      formatted("{\"nodes\":{\"b\":{\"in\":1.0e+2},\n\n\n\"a\":{\"in\":\"\\u0041\\/\"}\n\n}}"),
      "{\n  \"nodes\": {\n    \"b\": {\"in\": 1.0e+2},\n\n    \"a\": {\"in\": \"\\u0041\\/\"}\n  }\n}\n");
}

TEST(Format, FormatsArraysAndScalars) {
  EXPECT_EQ(formatted(" [ ] "), "[]\n");
  EXPECT_EQ(formatted("3"), "3\n");
}

TEST(Format, ShippedDocumentsAreCanonical) {
  size_t documents = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(ISOSHADE_GRAPHS)) {
    if (entry.path().extension() != ".json") continue;
    if (entry.path().parent_path().filename() == "schema") continue;
    support::Diagnostics diagnostics;
    const auto source = read_source(entry.path().string(), diagnostics);
    const auto document = parse_document(source, diagnostics);
    ASSERT_TRUE(document);
    EXPECT_EQ(format(*document), source->text()) << entry.path() << ": run isoshade fmt";
    ++documents;
  }
  EXPECT_GE(documents, 10u);
}

}  // namespace
}  // namespace isoshade::graph
