// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "compiler/support/source.h"

namespace isoshade::support {
namespace {

TEST(Source, PositionsCountLinesAndBytesFromOne) {
  const SourceFile file("a.json", "ab\n\ncd");
  const auto position = [&](uint32_t offset) {
    const auto [line, column] = file.position(offset);
    return std::pair(line, column);
  };
  EXPECT_EQ(position(0), std::pair(1u, 1u));
  EXPECT_EQ(position(2), std::pair(1u, 3u));  // the newline ends its line
  EXPECT_EQ(position(3), std::pair(2u, 1u));
  EXPECT_EQ(position(5), std::pair(3u, 2u));
  EXPECT_EQ(position(6), std::pair(3u, 3u));     // the end
  EXPECT_EQ(position(1000), std::pair(3u, 3u));  // beyond the end is the end
}

TEST(Source, LinesExcludeLineEndings) {
  const SourceFile file("a.json", "ab\r\n\ncd");
  EXPECT_EQ(file.line(1), "ab");
  EXPECT_EQ(file.line(2), "");
  EXPECT_EQ(file.line(3), "cd");
  EXPECT_EQ(file.line(0), "");
  EXPECT_EQ(file.line(4), "");
}

TEST(Source, EmptyTextHasOneEmptyLine) {
  const SourceFile file("a.json", "");
  EXPECT_EQ(file.position(0).line, 1u);
  EXPECT_EQ(file.position(0).column, 1u);
  EXPECT_EQ(file.line(1), "");
}

TEST(Source, ByteOrderMarkTakesNoColumns) {
  const SourceFile file("a.json", "\xef\xbb\xbf{}\n");
  EXPECT_EQ(file.line(1), "{}");
  EXPECT_EQ(file.position(3).column, 1u);
  EXPECT_EQ(file.position(0).column, 1u);
}

TEST(Source, SpanWithoutADocumentHasNoLine) {
  EXPECT_EQ(Span{}.line(), 0u);
  const Source file = std::make_shared<SourceFile>("a.json", "\n\nx");
  EXPECT_EQ((Span{file, 2, 3}.line()), 3u);
}

}  // namespace
}  // namespace isoshade::support
