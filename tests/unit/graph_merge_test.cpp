// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <memory>

#include "compiler/graph/document.h"

namespace isoshade::graph {
namespace {

Document parse(const std::string& path, const std::string& text) {
  support::Diagnostics diagnostics;
  auto document = parse_document(std::make_shared<support::SourceFile>(path, text), diagnostics);
  EXPECT_TRUE(document) << diagnostics.text();
  return document.value_or(Document{});
}

/// Compact; values as they were written.
std::string text(const Document& document, const Json& json) {
  std::string out;
  if (json.kind == Json::Kind::object) {
    for (const Member& member : json.members) {
      const support::Span key = document.key_span(member);
      out += (out.empty() ? "" : ", ") + key.file->text().substr(key.begin, key.end - key.begin) + ": " +
             text(document, member.value);
    }
    return "{" + out + "}";
  }
  return std::string(document.text(json));
}

std::string merged(const std::string& base, const std::string& changes,
                   support::Diagnostics* diagnostics = nullptr) {
  support::Diagnostics own;
  const Document result = merge(parse("base.json", base), parse("changes.json", changes),
                                diagnostics != nullptr ? *diagnostics : own);
  EXPECT_EQ(own.text(), "");
  return text(result, result.root);
}

TEST(Merge, CombinesMembersRecursively) {
  EXPECT_EQ(merged(R"({"a": 1, "b": {"x": 1, "y": [1, 2]}})", R"({"b": {"y": [3], "z": 4}, "c": true})"),
            R"({"a": 1, "b": {"x": 1, "y": [3], "z": 4}, "c": true})");
  EXPECT_EQ(merged(R"({"a": {"x": 1}})", R"({"a": 2})"), R"({"a": 2})");
  EXPECT_EQ(merged(R"({"a": 2})", R"({"a": {"x": 1}})"), R"({"a": {"x": 1}})");
}

TEST(Merge, NullRemovesAMember) {
  EXPECT_EQ(merged(R"({"a": 1, "b": {"x": 1, "y": 2}, "c": 3})", R"({"b": {"x": null}, "c": null})"),
            R"({"a": 1, "b": {"y": 2}})");
}

TEST(Merge, KeepsNullsOfTheBase) {
  EXPECT_EQ(merged(R"({"a": {"x": null, "y": null, "z": null}})", R"({"a": {"y": null, "z": 1}})"),
            R"({"a": {"x": null, "z": 1}})");
}

TEST(Merge, AllowsAnyNullInExtras) {
  support::Diagnostics diagnostics;
  merged(R"({"b": {"extras": {"x": 1}}})", R"({"b": {"extras": {"y": {"z": null}}}, "extras": {"x": null}})",
         &diagnostics);
  EXPECT_EQ(diagnostics.text(), "");
  merged("{}", R"({"extras": {}, "b": {"x": null}})", &diagnostics);
  EXPECT_EQ(diagnostics.error_count(), 1u);
}

TEST(Merge, ReportsNullsThatRemoveNothing) {
  for (const char* changes : {R"({"b": {"xx": null}})", R"({"new": {"xx": null}})"}) {
    support::Diagnostics diagnostics;
    merged(R"({"b": {"x": 1}})", changes, &diagnostics);
    ASSERT_EQ(diagnostics.error_count(), 1u) << changes;
    EXPECT_EQ(diagnostics.all()[0].where.file->path(), "changes.json");
    EXPECT_NE(diagnostics.text().find("there is no \"xx\" to remove"), std::string::npos);
  }
}

TEST(Merge, ReplacesObjectsThatStateTheirType) {
  EXPECT_EQ(merged(R"({"mesh": {"type": "box", "size": 1}})", R"({"mesh": {"type": "sphere"}})"),
            R"({"mesh": {"type": "sphere"}})");
  // Here it is a name.
  EXPECT_EQ(merged(R"({"objects": {"a": 1}})", R"({"objects": {"type": {}}})"),
            R"({"objects": {"a": 1, "type": {}}})");
}

TEST(Merge, KeepsTheSourceOfEveryValue) {
  support::Diagnostics diagnostics;
  Document first =
      merge(parse("1", R"({"a": 0.1, "b": {"x": 0.1}})"), parse("2", R"({"b": {"y": 0.2}})"), diagnostics);
  const Document both = merge(std::move(first), parse("3", R"(   {"b": {"x": 0.30}})"), diagnostics);
  const auto path = [&](const Json& json) { return both.source_of(json)->path(); };
  EXPECT_EQ(path(both.root), "3");
  EXPECT_EQ(path(*both.root.find("a")), "1");
  const Json& b = *both.root.find("b");
  EXPECT_EQ(path(b), "3");
  EXPECT_EQ(path(*b.find("x")), "3");
  EXPECT_EQ(path(*b.find("y")), "2");
  EXPECT_EQ(both.to_float(*b.find("x")), 0.3f);
  EXPECT_EQ(both.to_float(*b.find("y")), 0.2f);
  EXPECT_EQ(both.to_float(*both.root.find("a")), 0.1f);
}

TEST(Merge, IsFastForManyMembers) {
  std::string base = "{", changes = "{";
  for (int i = 0; i < 100'000; ++i) {
    base += (i == 0 ? "\"k" : ",\"k") + std::to_string(i) + "\":1";
    changes += (i == 0 ? "\"k" : ",\"k") + std::to_string(i) + "\":null";
  }
  EXPECT_EQ(merged(base + "}", changes + "}"), "{}");
}

}  // namespace
}  // namespace isoshade::graph
