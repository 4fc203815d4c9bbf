// SPDX-License-Identifier: Apache-2.0
#include <ctime>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <set>

#include "compiler/support/diagnostics.h"

namespace isoshade::support {
namespace {

Source source(std::string text) { return std::make_shared<SourceFile>("dir/a.json", std::move(text)); }

/// The place of the first `what` in the text.
Span find(const Source& file, std::string_view what) {
  const auto begin = static_cast<uint32_t>(file->text().find(what));
  return {file, begin, begin + static_cast<uint32_t>(what.size())};
}

TEST(Diagnostics, TextShowsPositionLineCaretFixAndNotes) {
  const Source file = source("{\n  \"scale\": 1,\n  \"b\": \"specualr_scale\"\n}\n");
  Diagnostics diagnostics;
  diagnostics
      .report(Id::unknown_key, find(file, "\"specualr_scale\""), "nothing is called \"specualr_scale\"")
      .note(find(file, "\"scale\""), "this is")
      .note("and that is all")
      .suggest("did you mean \"scale\"?");
  EXPECT_EQ(diagnostics.text(), R"(dir/a.json:3:8: error[unknown-key]: nothing is called "specualr_scale"
  3 |   "b": "specualr_scale"
    |        ^^^^^^^^^^^^^^^^ did you mean "scale"?
dir/a.json:2:3: note: this is
  2 |   "scale": 1,
    |   ^^^^^^^
  note: and that is all
)");
}

TEST(Diagnostics, WithoutAPositionShowsOnlyTheMessage) {
  Diagnostics diagnostics;
  diagnostics.report(Id::missing_file, "cannot read \"x\"").suggest("look again");
  EXPECT_EQ(diagnostics.text(), "error[missing-file]: cannot read \"x\"\n  look again\n");
}

TEST(Diagnostics, EmptyRangesAreMarkedByOneCaret) {
  const Source file = source("{\n");
  Diagnostics diagnostics;
  diagnostics.report(Id::syntax, {file, 2, 2}, "end");
  diagnostics.report(Id::syntax, {file, 1, 1}, "end of line");
  EXPECT_EQ(diagnostics.text(),
            "dir/a.json:2:1: error[syntax]: end\n  2 |\n    | ^\n"
            "dir/a.json:1:2: error[syntax]: end of line\n  1 | {\n    |  ^\n");
}

TEST(Diagnostics, MultiLineSpansAreUnderlinedOnTheirFirstLine) {
  const Source file = source("{\"a\": {\n}}");
  Diagnostics diagnostics;
  diagnostics.report(Id::wrong_type, {file, 6, 9}, "m");
  EXPECT_EQ(diagnostics.text(), "dir/a.json:1:7: error[wrong-type]: m\n  1 | {\"a\": {\n    |       ^\n");
}

TEST(Diagnostics, CaretIsAlignedUnderTabsWideAndInvisibleCharacters) {
  const Source file = source("\t\"\xe5\xb1\xb1\": \x01 \"x\"");
  Diagnostics diagnostics;
  diagnostics.report(Id::wrong_type, find(file, "\"x\""), "m");
  EXPECT_EQ(diagnostics.text(),
            "dir/a.json:1:11: error[wrong-type]: m\n"
            "  1 |     \"\xe5\xb1\xb1\": \\x01 \"x\"\n"
            "    |                ^^^\n");
}

TEST(Diagnostics, LongLinesAreTruncatedAroundTheCaret) {
  const Source file = source(std::string(1000, 'a') + "HERE" + std::string(1000, 'b'));
  Diagnostics diagnostics;
  diagnostics.report(Id::wrong_type, find(file, "HERE"), "m");
  EXPECT_EQ(diagnostics.text(), "dir/a.json:1:1001: error[wrong-type]: m\n  1 | ..." + std::string(60, 'a') +
                                    "HERE" + std::string(96, 'b') + "...\n    | " + std::string(63, ' ') +
                                    "^^^^\n");
}

TEST(Diagnostics, LongLinesAreNotCutInsideAUtf8Sequence) {
  std::string text;
  for (int i = 0; i < 500; ++i) text += "\xe5\xb1\xb1";
  for (uint32_t begin : {0u, 200u, 201u, 202u, 1497u, 1500u}) {
    Diagnostics diagnostics;
    diagnostics.report(Id::wrong_type, {source(text), begin, begin + 400}, "m");
    EXPECT_EQ(diagnostics.text().find("\\x"), std::string::npos) << diagnostics.text();
  }
}

TEST(Diagnostics, ControlCharactersOfDocumentsAreEscaped) {
  const std::string evil =
      "\x1b]0;owned\x07\xc2\x9b"
      "2J\r\n\xff\xe2\x80\xae";
  const Source file = std::make_shared<SourceFile>("dir/" + evil, "\"" + evil + "\"");
  Diagnostics diagnostics;
  diagnostics.report(Id::wrong_type, {file, 1, 5}, evil).note({file, 0, 1}, evil).note(evil).suggest(evil);
  diagnostics.report(Id::wrong_type, evil).suggest(evil);
  const std::string text = diagnostics.text();
  for (const std::string_view raw : {"\x1b", "\x07", "\xc2\x9b", "\r", "\xff", "\xe2\x80\xae"}) {
    EXPECT_EQ(text.find(raw), std::string::npos) << raw;
  }
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3 + 3 + 1 + 2);
  for (const char c : diagnostics.json()) EXPECT_TRUE((c >= 0x20 && c < 0x7f) || c == '\n');
}

TEST(Diagnostics, ColoursAreUsedOnlyOnRequest) {
  Diagnostics diagnostics;
  diagnostics.report(Id::syntax, find(source("abc"), "b"), "m").suggest("f");
  EXPECT_EQ(diagnostics.text().find('\x1b'), std::string::npos);
  std::string text = diagnostics.text(true);
  EXPECT_NE(text.find("\x1b[1;31merror[syntax]:\x1b[0m"), std::string::npos);
  for (size_t at; (at = text.find('\x1b')) != std::string::npos;) text.erase(at, text.find('m', at) + 1 - at);
  EXPECT_EQ(text, diagnostics.text());
}

TEST(Diagnostics, ErrorsPastTheLimitAreCounted) {
  Diagnostics diagnostics(2);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(diagnostics.full(), i >= 2);
    diagnostics.report(Id::missing_file, "m" + std::to_string(i)).note("n");
  }
  EXPECT_EQ(diagnostics.error_count(), 5u);
  EXPECT_EQ(diagnostics.all().size(), 2u);
  EXPECT_EQ(
      diagnostics.text(),
      "error[missing-file]: m0\n  note: n\nerror[missing-file]: m1\n  note: n\n3 more errors not shown\n");
}

TEST(Diagnostics, WarningsBecomeErrorsOnlyOnRequest) {
  Diagnostics diagnostics(2);
  for (int i = 0; i < 3; ++i) diagnostics.report(Id::unused_node, "m" + std::to_string(i));
  EXPECT_FALSE(diagnostics.has_errors());
  EXPECT_EQ(diagnostics.text(),
            "warning[unused-node]: m0\nwarning[unused-node]: m1\n1 more warning not shown\n");

  Diagnostics strict;
  strict.warnings_as_errors(true);
  strict.report(Id::unused_node, "m");
  EXPECT_EQ(strict.error_count(), 1u);
  EXPECT_EQ(strict.text(), "error[unused-node]: m\n");
}

TEST(Diagnostics, OnlyWarningsCanBeDisabled) {
  Diagnostics diagnostics;
  diagnostics.warnings_as_errors(true);
  diagnostics.disable(Id::unused_node);
  diagnostics.disable(Id::syntax);
  diagnostics.report(Id::unused_node, "m").note("n");
  EXPECT_EQ(diagnostics.text(), "");
  diagnostics.report(Id::syntax, "m");
  EXPECT_EQ(diagnostics.text(), "error[syntax]: m\n");
}

TEST(Diagnostics, UnknownNamesSuggestTheNearest) {
  Diagnostics diagnostics(2);
  const auto fix = [&](std::string_view word) {
    return diagnostics.report_unknown(Id::unknown_key, {}, "m", word, {"roughness", "metallic"}).fix;
  };
  EXPECT_EQ(fix("roughnes"), "did you mean \"roughness\"?");
  EXPECT_EQ(fix("elephant"), "");
  EXPECT_EQ(fix("roughnes"), "");  // not shown any more, so not searched for
}

TEST(Diagnostics, JsonContainsEveryField) {
  const Source file = source("{\n  \"a\": 1\n}");
  Diagnostics diagnostics;
  diagnostics.report(Id::unknown_key, find(file, "\"a\""), "no \"a\"")
      .note(find(file, "1"), "n")
      .suggest("f")
      .at("/a");
  diagnostics.report(Id::missing_file, "m\xff");
  EXPECT_EQ(nlohmann::json::parse(diagnostics.json()), nlohmann::json::parse(R"([
    {"id": "unknown-key", "severity": "error", "file": "dir/a.json", "line": 2, "column": 3, "pointer": "/a",
     "message": "no \"a\"", "notes": [{"file": "dir/a.json", "line": 2, "column": 8, "message": "n"}], "fix": "f"},
    {"id": "missing-file", "severity": "error", "file": "", "line": 0, "column": 0, "pointer": "",
     "message": "m\ufffd", "notes": [], "fix": ""}])"));
  EXPECT_EQ(Diagnostics().json(), "[]\n");
}

TEST(Diagnostics, IdsAreDistinctAndExplained) {
  std::set<std::string_view> texts;
  for (const Id id : all_ids()) {
    EXPECT_TRUE(texts.insert(id_text(id)).second) << id_text(id);
    EXPECT_EQ(id_text(id).find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-"), std::string::npos);
    EXPECT_EQ(meaning(id).back(), '.') << id_text(id);
  }
  EXPECT_FALSE(texts.empty());
}

TEST(Nearest, FindsTypos) {
  const std::vector<std::string_view> words = {"base_color", "metallic", "roughness", "in1", "in2"};
  EXPECT_EQ(nearest("roughnes", words), "roughness");
  EXPECT_EQ(nearest("metalilc", words), "metallic");  // two neighbours swapped
  EXPECT_EQ(nearest("baseColor", words), "base_color");
  EXPECT_EQ(nearest("IN2", words), "in2");
  EXPECT_EQ(nearest("in3", words), "in1");
}

TEST(Nearest, SuggestsNothingForDistantWords) {
  const std::vector<std::string_view> words = {"roughness", "x", ""};
  EXPECT_EQ(nearest("elephant", words), "");
  EXPECT_EQ(nearest("y", words), "");
  EXPECT_EQ(nearest("", words), "");
  EXPECT_EQ(nearest("___", words), "");
  EXPECT_EQ(nearest(std::string(1'000'000, 'x'), words), "");
}

TEST(Nearest, IsFastForManyCandidates) {
  std::vector<std::string> words(300'000, std::string(60, 'x'));
  const std::vector<std::string_view> candidates(words.begin(), words.end());
  const std::clock_t begin = std::clock();
  EXPECT_EQ(nearest(std::string(59, 'x') + "yyyyyyyyyy", candidates), "");
  for (int i = 0; i < 10; ++i) nearest(std::string(40, 'x') + std::string(20, 'y'), candidates);
  EXPECT_LT(double(std::clock() - begin) / CLOCKS_PER_SEC, 5.0);
}

}  // namespace
}  // namespace isoshade::support
