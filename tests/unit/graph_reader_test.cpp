// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "compiler/graph/reader.h"

namespace isoshade::graph {
namespace {

using support::Diagnostics;
using Need = ObjectReader::Need;

class Reader : public testing::Test {
 protected:
  ObjectReader read(std::string text) {
    document_ =
        *parse_document(std::make_shared<support::SourceFile>("a.json", std::move(text)), diagnostics_);
    return ObjectReader(document_, document_.root, "a camera", diagnostics_);
  }
  std::string said() const { return diagnostics_.text(); }

  Document document_;
  Diagnostics diagnostics_;
};

TEST_F(Reader, ReturnsValuesAndDefaults) {
  ObjectReader reader = read(
      R"({"b": true, "s": "x", "n": 0.5, "i": 7, "v": [1, 2], "c": "two", "o": {}, "a": [], "extras": 1})");
  EXPECT_TRUE(reader.boolean("b"));
  EXPECT_EQ(reader.string("s"), "x");
  EXPECT_EQ(reader.number("n", {0, 1}), 0.5f);
  EXPECT_EQ(reader.optional_number("n"), 0.5f);
  EXPECT_EQ(reader.integer("i", {0, 9}), 7);
  EXPECT_EQ(reader.numbers<2>("v"), (std::array{1.0f, 2.0f}));
  EXPECT_EQ(reader.choice("c", {"one", "two"}), 1u);
  EXPECT_NE(reader.object("o"), nullptr);
  EXPECT_NE(reader.array("a"), nullptr);

  EXPECT_TRUE(reader.boolean("x", true));
  EXPECT_EQ(reader.string("x", "y"), "y");
  EXPECT_EQ(reader.number("x", {}, 3.0f), 3.0f);
  EXPECT_EQ(reader.optional_number("x"), std::nullopt);
  EXPECT_EQ(reader.integer("x", {}, 3), 3);
  EXPECT_EQ(reader.numbers<2>("x", {}, std::array{3.0f, 4.0f}), (std::array{3.0f, 4.0f}));
  EXPECT_EQ(reader.choice("x", {"one", "two"}, 1), 1u);
  EXPECT_EQ(reader.object("x", Need::optional), nullptr);
  EXPECT_TRUE(reader.finish());
  EXPECT_EQ(said(), "");
}

TEST_F(Reader, ReportsMissingKeys) {
  ObjectReader reader = read("{}");
  EXPECT_EQ(reader.number("fov"), 0.0f);
  EXPECT_FALSE(reader.finish());
  EXPECT_EQ(said(), "a.json:1:1: error[missing-key]: a camera needs the key \"fov\"\n  1 | {}\n    | ^\n");
}

TEST_F(Reader, ReportsUnknownKeysWithSuggestions) {
  ObjectReader reader = read(R"({"fov": 1, "fvo": 2, "elephant": 3})");
  reader.number("fov");
  reader.numbers<3>("eye", {}, std::array{0.0f, 0.0f, 0.0f});
  EXPECT_FALSE(reader.finish());
  EXPECT_EQ(said(), R"(a.json:1:12: error[unknown-key]: a camera has no key "fvo"
  1 | {"fov": 1, "fvo": 2, "elephant": 3}
    |            ^^^^^ did you mean "fov"?
a.json:1:22: error[unknown-key]: a camera has no key "elephant"
  1 | {"fov": 1, "fvo": 2, "elephant": 3}
    |                      ^^^^^^^^^^
  note: its keys are fov, eye
)");
}

TEST_F(Reader, ReportsWrongTypes) {
  ObjectReader reader =
      read(R"({"b": 1, "s": null, "n": "1", "i": 1.5, "v": [1, 2], "w": [1, true], "c": 1})");
  reader.boolean("b");
  reader.string("s");
  reader.number("n");
  reader.integer("i", {});
  reader.numbers<3>("v");
  reader.numbers<2>("w");
  reader.choice("c", {"one"});
  EXPECT_FALSE(reader.finish());
  std::string messages;
  for (const support::Diagnostic& diagnostic : diagnostics_.all()) {
    messages += std::string(id_text(diagnostic.id)) + " " +
                std::string(document_.source->text().substr(diagnostic.where.begin,
                                                            diagnostic.where.end - diagnostic.where.begin)) +
                ": " + diagnostic.message + "\n";
  }
  EXPECT_EQ(messages, R"(wrong-type 1: "b" of a camera must be a boolean, not a number
wrong-type null: "s" of a camera must be a string, not null
wrong-type "1": "n" of a camera must be a number, not a string
wrong-type 1.5: "i" of a camera must be an integer
wrong-type [1, 2]: "v" of a camera must be an array of 3 numbers, not of 2
wrong-type true: "w[1]" of a camera must be a number, not a boolean
wrong-type 1: "c" of a camera must be a string, not a number
)");
}

TEST_F(Reader, ReportsNumbersOutOfRange) {
  ObjectReader reader = read(R"({"a": 2, "b": -1, "c": 1e39, "d": [0, 3], "e": 5, "f": 0.1})");
  EXPECT_EQ(reader.number("a", {-0.5, 1}, 0.5f), 0.5f);
  reader.number("b", {.low = 0});
  reader.number("c");
  reader.numbers<2>("d", {.high = 1});
  reader.integer("e", {1, 4});
  EXPECT_EQ(reader.number("f", {0, 0.1}), 0.1f);  // that it rounds up does not matter
  EXPECT_FALSE(reader.finish());
  std::string messages;
  for (const support::Diagnostic& diagnostic : diagnostics_.all()) messages += diagnostic.message + "\n";
  EXPECT_EQ(messages, R"("a" of a camera must be from -0.5 to 1
"b" of a camera must be at least 0
"c" of a camera must be in the range of float
"d[1]" of a camera must be at most 1
"e" of a camera must be from 1 to 4
)");
}

TEST_F(Reader, ReportsUnknownChoices) {
  ObjectReader reader = read(R"({"cull": "bakc"})");
  reader.choice("cull", {"none", "back", "front"});
  EXPECT_FALSE(reader.finish());
  EXPECT_EQ(said(),
            R"(a.json:1:10: error[unknown-choice]: "cull" of a camera must be one of none, back, front, not "bakc"
  1 | {"cull": "bakc"}
    |          ^^^^^^ did you mean "back"?
)");
}

TEST_F(Reader, ReportsANonObjectOnce) {
  ObjectReader reader = read("[1]");
  EXPECT_EQ(reader.string("name"), "");
  EXPECT_FALSE(reader.finish());
  EXPECT_EQ(said(),
            "a.json:1:1: error[wrong-type]: a camera must be an object, not an array\n  1 | [1]\n    | ^^^\n");
}

TEST_F(Reader, AcceptsExtrasAndIgnoredKeys) {
  ObjectReader reader = read(R"({"extras": {"any": "thing"}, "$schema": "x"})");
  reader.ignore("$schema");
  EXPECT_TRUE(reader.finish());
}

}  // namespace
}  // namespace isoshade::graph
