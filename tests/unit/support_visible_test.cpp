// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "compiler/support/visible.h"

namespace isoshade::support {
namespace {

TEST(Visible, PrintableTextIsUnchanged) {
  EXPECT_EQ(visible("a \"b\" ~ \xc3\xa9 \xe5\xb1\xb1 \xf0\x9f\x8e\xb1"),
            "a \"b\" ~ \xc3\xa9 \xe5\xb1\xb1 \xf0\x9f\x8e\xb1");
}

TEST(Visible, ControlCharactersAreEscaped) {
  EXPECT_EQ(visible(std::string_view("\x1b[31m\0\t\r\n\x7f", 10)), "\\x1b[31m\\x00\\x09\\x0d\\x0a\\x7f");
  EXPECT_EQ(visible("\xc2\x9b"
                    "31m"),
            "\\u009b31m");  // CSI as one character
}

TEST(Visible, ReorderingAndInvisibleCharactersAreEscaped) {
  EXPECT_EQ(visible("a\xe2\x80\xae"
                    "b"),
            "a\\u202eb");                              // right-to-left override
  EXPECT_EQ(visible("\xe2\x80\x8b"), "\\u200b");       // zero width space
  EXPECT_EQ(visible("\xf3\xa0\x81\x81"), "\\ue0041");  // tag characters
}

TEST(Visible, InvalidUtf8IsEscaped) {
  EXPECT_EQ(visible("\xff"), "\\xff");
  EXPECT_EQ(visible("\xc3"), "\\xc3");                             // cut short
  EXPECT_EQ(visible("\xc0\x9b"), "\\xc0\\x9b");                    // overlong ESC
  EXPECT_EQ(visible("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // surrogate
  EXPECT_EQ(visible("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond U+10FFFF
}

TEST(Visible, ColumnsMatchTerminalWidth) {
  std::string out;
  EXPECT_EQ(append_visible("a", out).columns, 1u);
  EXPECT_EQ(append_visible("\xcc\x81", out).columns, 0u);          // combining acute accent
  EXPECT_EQ(append_visible("\xe5\xb1\xb1", out).columns, 2u);      // CJK
  EXPECT_EQ(append_visible("\xf0\x9f\x8e\xb1", out).columns, 2u);  // emoji
  EXPECT_EQ(append_visible("\x01", out).columns, 4u);
}

TEST(Visible, QuotedTextIsTruncated) {
  EXPECT_EQ(quote("a"), "\"a\"");
  const std::string text = quote(std::string(1000, 'x'));
  EXPECT_LT(text.size(), 100u);
  EXPECT_EQ(text.substr(text.size() - 5), "x...\"");
}

}  // namespace
}  // namespace isoshade::support
