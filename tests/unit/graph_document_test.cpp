// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "compiler/graph/document.h"

namespace isoshade::graph {
namespace {

using support::Diagnostics;

support::Source source(std::string text) {
  return std::make_shared<support::SourceFile>("a.json", std::move(text));
}

Document parse(std::string text) {
  Diagnostics diagnostics;
  std::optional<Document> document = parse_document(source(std::move(text)), diagnostics);
  EXPECT_EQ(diagnostics.text(), "");
  return document ? std::move(*document) : Document{source(""), {}};
}

/// What is said of a text that is no document.
std::string complaint(std::string text) {
  Diagnostics diagnostics;
  EXPECT_FALSE(parse_document(source(std::move(text)), diagnostics).has_value());
  EXPECT_TRUE(diagnostics.has_errors());
  return diagnostics.text();
}

TEST(Document, ReadsNumbersOfManyDigits) {
  const Document document = parse(R"([1234567890123456789, 18446744073709551615, -1234567890123456789, 4.9e-324])");
  EXPECT_TRUE(document.root.items[0].integral);
  EXPECT_FALSE(document.root.items[1].integral);
  EXPECT_EQ(document.root.items[2].number, -1234567890123456789.0);
  EXPECT_EQ(document.root.items[3].number, 4.9e-324);
}

TEST(Document, ParsesEveryKindOfValue) {
  const Document document =
      parse(R"({"n": null, "t": true, "s": "a\n\u00e9\ud83c\udfb1", "l": [1, -2.5], "o": {}})");
  const Json& root = document.root;
  ASSERT_EQ(root.members.size(), 5u);
  EXPECT_EQ(root.find("n")->kind, Json::Kind::null);
  EXPECT_TRUE(root.find("t")->boolean);
  EXPECT_EQ(root.find("s")->string, "a\n\xc3\xa9\xf0\x9f\x8e\xb1");
  ASSERT_EQ(root.find("l")->items.size(), 2u);
  EXPECT_EQ(root.find("l")->items[1].number, -2.5);
  EXPECT_EQ(root.find("o")->kind, Json::Kind::object);
  EXPECT_EQ(root.find("x"), nullptr);
}

TEST(Document, MembersKeepTheirOrder) {
  const Document document = parse(R"({"b": 1, "a": 2, "c": 3})");
  EXPECT_EQ(document.root.members[0].key, "b");
  EXPECT_EQ(document.root.members[1].key, "a");
  EXPECT_EQ(document.root.members[2].key, "c");
}

/// Every value's text is a document of its own with the same value; every key's text is that key.
void expect_places(const Document& document, const Json& json) {
  const Document again = parse(std::string(document.text(json)));
  EXPECT_EQ(again.root.kind, json.kind) << document.text(json);
  EXPECT_EQ(again.root.number, json.number);
  EXPECT_EQ(again.root.string, json.string);
  EXPECT_EQ(again.root.end, json.end - json.begin);
  for (const Json& item : json.items) expect_places(document, item);
  for (const Member& member : json.members) {
    const std::string key =
        document.source->text().substr(member.key_begin, member.key_end - member.key_begin);
    EXPECT_EQ(parse(key).root.string, member.key);
    expect_places(document, member.value);
  }
}

TEST(Document, TextRangesAreExact) {
  for (const char* text :
       {"1", "-12", "1.5e3", "\"a\"", "null", "[]", "{}", "[1]", "[1,2]", "[ 1 , 2\n]\n", "[12\t,-0.5e+7]",
        "[true,false,null]", "[[],[[]],{}]", "{\"a\":1}", "{\"a\" : 1 ,\"b\":[2]}",
        "{\"\\\"\":{\"b\":\"]}\"}}", "\r\n{\r\n\t\"\xc3\xa9\" :\r\n\"\\u00e9\"\r\n}"}) {
    const Document document = parse(text);
    expect_places(document, document.root);
  }
}

TEST(Document, ByteOrderMarkIsSkipped) {
  const Document document = parse("\xef\xbb\xbf{\"a\": 1}");
  EXPECT_EQ(document.root.begin, 3u);
  EXPECT_EQ(document.text(*document.root.find("a")), "1");
  EXPECT_EQ(document.span(document.root).line(), 1u);
}

TEST(Document, DistinguishesIntegersFromFloats) {
  const Document document =
      parse("[1, -9223372036854775808, 9223372036854775807, 9223372036854775808, 1.0, 1e2, -0]");
  const std::vector<Json>& items = document.root.items;
  EXPECT_TRUE(items[0].integral);
  EXPECT_EQ(document.to_integer(items[1]), INT64_MIN);
  EXPECT_EQ(document.to_integer(items[2]), INT64_MAX);
  EXPECT_FALSE(items[3].integral);
  EXPECT_EQ(items[3].number, 9223372036854775808.0);
  EXPECT_FALSE(items[4].integral);
  EXPECT_FALSE(items[5].integral);
  EXPECT_TRUE(items[6].integral);
  EXPECT_TRUE(std::signbit(items[6].number));
}

TEST(Document, FloatsAreRoundedOnce) {
  const Document document = parse("[1.00000005960464477540, 1e-40, -1e-40, 1e39, -0]");
  const auto bits = [&](size_t i) {
    return std::bit_cast<uint32_t>(document.to_float(document.root.items[i]));
  };
  EXPECT_EQ(bits(0), 0x3f800001u);  // through a double it is 1
  EXPECT_EQ(bits(1), 0u);
  EXPECT_EQ(bits(2), 0x80000000u);
  EXPECT_EQ(bits(3), 0x7f800000u);
  EXPECT_EQ(bits(4), 0x80000000u);
}

struct Broken {
  const char* text;
  const char* said;
};

TEST(Document, ReportsSyntaxErrors) {
  const Broken cases[] = {
      {"", "a.json:1:1: error[syntax]: the document is empty\n  1 |\n    | ^\n"},
      {" \n", "a.json:1:1: error[syntax]: the document is empty\n  1 |  \n    | ^\n"},
      {"{\"a\": 1,}", R"(a.json:1:8: error[syntax]: trailing comma before '}'
  1 | {"a": 1,}
    |        ^ remove it
)"},
      {"[1, 2, ]", R"(a.json:1:6: error[syntax]: trailing comma before ']'
  1 | [1, 2, ]
    |      ^ remove it
)"},
      {"{\"a\": 1 \"b\": 2}", R"(a.json:1:9: error[syntax]: missing comma before this key
  1 | {"a": 1 "b": 2}
    |         ^^^
)"},
      {"[1 22]", R"(a.json:1:4: error[syntax]: missing comma before this value
  1 | [1 22]
    |    ^^
)"},
      {"{\"a\": [1, 2", R"(a.json:1:12: error[syntax]: unexpected end of the document
  1 | {"a": [1, 2
    |            ^
a.json:1:7: note: this '[' is not closed
  1 | {"a": [1, 2
    |       ^
)"},
      {"{\"a\": 1} x", R"(a.json:1:10: error[syntax]: text after the end of the document
  1 | {"a": 1} x
    |          ^
)"},
      {"{\"a\": 1} {}", R"(a.json:1:10: error[syntax]: text after the end of the document
  1 | {"a": 1} {}
    |          ^^
)"},
      {"{\"a\": nope}", R"(a.json:1:7: error[syntax]: not a JSON value
  1 | {"a": nope}
    |       ^^^^ put strings and keys in double quotes
)"},
      {"{a: 1}", R"(a.json:1:2: error[syntax]: not a JSON value
  1 | {a: 1}
    |  ^ put strings and keys in double quotes
)"},
      {"{\"a\": 'x'}", R"(a.json:1:7: error[syntax]: not a JSON value
  1 | {"a": 'x'}
    |       ^ put strings and keys in double quotes
)"},
      {"{ // x\n}", R"(a.json:1:3: error[syntax]: JSON has no comments
  1 | { // x
    |   ^ put remarks under "doc" or "extras"
)"},
      {"{\"a\": \"x\n}", R"(a.json:1:9: error[syntax]: control character in a string
  1 | {"a": "x
    |         ^ write it as an escape
)"},
      {"{\"a\": \"x", R"(a.json:1:7: error[syntax]: unterminated string
  1 | {"a": "x
    |       ^^ add the closing quote
)"},
      {"[\"\\q\"]", R"(a.json:1:4: error[syntax]: unknown escape
  1 | ["\q"]
    |    ^ write a backslash as \\
)"},
      {"[01]", R"(a.json:1:2: error[bad-number]: number with a leading zero
  1 | [01]
    |  ^^
)"},
      {"-01", R"(a.json:1:1: error[bad-number]: number with a leading zero
  1 | -01
    | ^^^
)"},
      {"[1.]", R"(a.json:1:2: error[bad-number]: malformed number
  1 | [1.]
    |  ^^^ write numbers as 1, -0.5, 1e-4
)"},
      {"[1e400]", R"(a.json:1:2: error[bad-number]: number beyond the range of a double
  1 | [1e400]
    |  ^^^^^
)"},
      {"-1e999", R"(a.json:1:1: error[bad-number]: number beyond the range of a double
  1 | -1e999
    | ^^^^^^
)"},
      {"[1}", R"(a.json:1:3: error[syntax]: unexpected '}'; expected ']'
  1 | [1}
    |   ^
)"},
      {"[,]", R"(a.json:1:2: error[syntax]: unexpected ','; expected '[', '{', or a literal
  1 | [,]
    |  ^
)"},
      {"[1,,2]", R"(a.json:1:4: error[syntax]: unexpected ','; expected '[', '{', or a literal
  1 | [1,,2]
    |    ^
)"},
      {"{\"a\" 1}", R"(a.json:1:6: error[syntax]: unexpected number literal; expected ':'
  1 | {"a" 1}
    |      ^
)"},
      {"}", R"(a.json:1:1: error[syntax]: unexpected '}'; expected '[', '{', or a literal
  1 | }
    | ^
)"},
  };
  for (const Broken& broken : cases) EXPECT_EQ(complaint(broken.text), broken.said) << broken.text;
}

TEST(Document, ReportsInvalidUtf8) {
  EXPECT_EQ(complaint("[\"a\xff\"]"),
            "a.json:1:4: error[bad-utf8]: the text is not UTF-8 here\n  1 | [\"a\\xff\"]\n    |    ^^^^\n");
  EXPECT_EQ(complaint("[\xff]"), "a.json:1:2: error[syntax]: not a JSON value\n  1 | [\\xff]\n    |  ^^^^\n");
  EXPECT_EQ(complaint("\xef\xbb{}"),
            "a.json:1:1: error[bad-utf8]: the text is not UTF-8 here\n  1 | \\xef\\xbb{}\n    | ^^^^\n");
  EXPECT_EQ(complaint("[\"\\ud800\"]"), R"(a.json:1:9: error[bad-utf8]: lone surrogate in an escape
  1 | ["\ud800"]
    |         ^ escapes from \ud800 to \udfff must come in pairs
)");
}

TEST(Document, ReportsNulBytes) {
  using namespace std::string_literals;
  EXPECT_EQ(complaint("{\"a\":\0 1}"s),
            "a.json:1:6: error[syntax]: NUL byte in the document\n  1 | {\"a\":\\x00 1}\n    |      ^^^^\n");
  EXPECT_EQ(complaint("{}\0x"s),
            "a.json:1:3: error[syntax]: text after the end of the document\n  1 | {}\\x00x\n    |   ^^^^^\n");
  EXPECT_NE(complaint("[\"\0\"]"s).find("control character in a string"), std::string::npos);
}

TEST(Document, ReportsEveryDuplicateKey) {
  EXPECT_EQ(complaint("{\"a\": 1, \"b\": 2,\n \"a\": 3, \"\\u0061\": 4}"),
            R"(a.json:2:2: error[duplicate-key]: duplicate key "a"
  2 |  "a": 3, "\u0061": 4}
    |  ^^^
a.json:1:2: note: the first one is here
  1 | {"a": 1, "b": 2,
    |  ^^^
a.json:2:10: error[duplicate-key]: duplicate key "a"
  2 |  "a": 3, "\u0061": 4}
    |          ^^^^^^^^
a.json:1:2: note: the first one is here
  1 | {"a": 1, "b": 2,
    |  ^^^
)");
}

TEST(Document, JsonPointersNameValues) {
  const Document document = parse(R"({"a/b": [1, {"~": 2}], "c": 3})");
  const auto pointer = [&](std::string_view what) {
    return pointer_at(document, static_cast<uint32_t>(document.source->text().find(what)));
  };
  EXPECT_EQ(pointer("{"), "");
  EXPECT_EQ(pointer("1"), "/a~1b/0");
  EXPECT_EQ(pointer("2"), "/a~1b/1/~0");
  EXPECT_EQ(pointer("\"c\""), "/c");  // a key stands for its value

  Diagnostics diagnostics;
  diagnostics.report(support::Id::wrong_type, document.span(*document.root.find("c")), "m");
  diagnostics.report(support::Id::wrong_type, "elsewhere");
  add_pointers(document, diagnostics);
  EXPECT_EQ(diagnostics.all()[0].pointer, "/c");
  EXPECT_EQ(diagnostics.all()[1].pointer, "");
}

class ReadSource : public testing::Test {
 protected:
  ReadSource() : folder_(testing::TempDir() + "isoshade_read_source_" + std::to_string(getpid())) {
    std::filesystem::create_directories(folder_);
  }
  ~ReadSource() override { std::filesystem::remove_all(folder_); }

  std::string folder_;
  Diagnostics diagnostics_;
};

TEST_F(ReadSource, ReturnsTheBytesOfTheFile) {
  const std::string path = folder_ + "/a.json", text("a\0\r\n\xff", 5);
  std::ofstream(path, std::ios::binary) << text;
  const support::Source file = read_source(path, diagnostics_);
  ASSERT_NE(file, nullptr);
  EXPECT_EQ(file->text(), text);
  EXPECT_EQ(file->path(), path);
}

TEST_F(ReadSource, ReportsMissingFiles) {
  EXPECT_EQ(read_source("no/such", diagnostics_), nullptr);
  EXPECT_EQ(diagnostics_.text(), "error[missing-file]: cannot read \"no/such\": No such file or directory\n");
}

TEST_F(ReadSource, PointsAtTheReference) {
  read_source("no/such", diagnostics_, {source("\"no/such\""), 0, 9});
  EXPECT_EQ(diagnostics_.text(),
            "a.json:1:1: error[missing-file]: cannot read \"no/such\": No such file or directory\n"
            "  1 | \"no/such\"\n    | ^^^^^^^^^\n");
}

TEST_F(ReadSource, RejectsPipesAndDevicesNamedByDocuments) {
  const std::string pipe = folder_ + "/pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const support::Source document = source("{}");
  for (const std::string& name : {pipe, std::string("-"), std::string("/dev/zero")}) {
    Diagnostics diagnostics;
    EXPECT_EQ(read_source(name, diagnostics, {document, 0, 1}), nullptr) << name;
    EXPECT_EQ(diagnostics.error_count(), 1u) << name;
  }
}

TEST_F(ReadSource, DoesNotTruncateNamesAtNulBytes) {
  std::ofstream(folder_ + "/a") << "x";
  EXPECT_EQ(read_source(folder_ + "/a" + std::string("\0.json", 6), diagnostics_), nullptr);
  EXPECT_EQ(diagnostics_.all().at(0).id, support::Id::missing_file);
}

TEST_F(ReadSource, ReportsFoldersAndEndlessFiles) {
  EXPECT_EQ(read_source(folder_, diagnostics_), nullptr);
  EXPECT_EQ(read_source("/dev/zero", diagnostics_), nullptr);
  EXPECT_EQ(diagnostics_.all().at(0).id, support::Id::unreadable_file);
  EXPECT_EQ(diagnostics_.all().at(1).id, support::Id::unreadable_file);
}

}  // namespace
}  // namespace isoshade::graph
