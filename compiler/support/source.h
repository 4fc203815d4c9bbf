// SPDX-License-Identifier: Apache-2.0
// Source texts and places in them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace isoshade::support {

/// A text that diagnostics can point into. Shared and immutable: spans keep it alive.
class SourceFile {
 public:
  enum class Origin : uint8_t {
    document,
    argument,  ///< the user's own words on the command line, which may name any file
  };
  SourceFile(std::string path, std::string text, Origin origin = Origin::document);

  /// As the user gave it; "<stdin>" for standard input.
  const std::string& path() const { return path_; }
  const std::string& text() const { return text_; }
  Origin origin() const { return origin_; }

  struct Position {
    uint32_t line;    ///< from 1
    uint32_t column;  ///< from 1, in bytes
  };
  Position position(uint32_t offset) const;
  /// The line without its end, `line` from 1.
  std::string_view line(uint32_t line) const;

 private:
  std::string path_;
  std::string text_;
  Origin origin_;
  std::vector<uint32_t> line_starts_;
};

using Source = std::shared_ptr<const SourceFile>;

/// Half-open byte range [begin, end) of a source. An empty `file` means "nowhere in a document".
struct Span {
  Source file;
  uint32_t begin = 0;
  uint32_t end = 0;

  uint32_t line() const { return file ? file->position(begin).line : 0; }
};

}  // namespace isoshade::support
