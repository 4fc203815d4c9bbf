// SPDX-License-Identifier: Apache-2.0
// Source texts and locations in them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace isoshade::support {

/// A text that diagnostics point into. Immutable and shared: spans keep it alive.
class SourceFile {
 public:
  enum class Origin : uint8_t {
    document,
    argument,  ///< given on the command line, so it may refer to any file
  };
  SourceFile(std::string path, std::string text, Origin origin = Origin::document);

  /// As the user gave it, or "<stdin>".
  const std::string& path() const { return path_; }
  const std::string& text() const { return text_; }
  Origin origin() const { return origin_; }

  struct Position {
    uint32_t line;    ///< from 1
    uint32_t column;  ///< from 1, in bytes
  };
  Position position(uint32_t offset) const;
  /// The text of a line without its line ending; `line` starts at 1.
  std::string_view line(uint32_t line) const;

 private:
  std::string path_;
  std::string text_;
  Origin origin_;
  std::vector<uint32_t> line_starts_;
};

using Source = std::shared_ptr<const SourceFile>;

/// Half-open byte range [begin, end) of a source. A null `file` means "not in a document".
struct Span {
  Source file;
  uint32_t begin = 0;
  uint32_t end = 0;

  uint32_t line() const { return file ? file->position(begin).line : 0; }
};

}  // namespace isoshade::support
