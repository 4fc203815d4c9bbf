// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/source.h"

#include <algorithm>
#include <utility>

namespace isoshade::support {

SourceFile::SourceFile(std::string path, std::string text, Origin origin)
    : path_(std::move(path)), text_(std::move(text)), origin_(origin) {
  line_starts_.reserve(1 + std::count(text_.begin(), text_.end(), '\n'));
  // A byte order mark is invisible, so it does not count as columns of the first line.
  line_starts_.push_back(text_.compare(0, 3, "\xef\xbb\xbf") == 0 ? 3 : 0);
  for (size_t at = text_.find('\n'); at != std::string::npos; at = text_.find('\n', at + 1)) {
    line_starts_.push_back(static_cast<uint32_t>(at + 1));
  }
}

SourceFile::Position SourceFile::position(uint32_t offset) const {
  offset = std::clamp<uint32_t>(offset, line_starts_.front(), static_cast<uint32_t>(text_.size()));
  const auto after = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset);
  return {static_cast<uint32_t>(after - line_starts_.begin()), offset - *(after - 1) + 1};
}

std::string_view SourceFile::line(uint32_t line) const {
  if (line < 1 || line > line_starts_.size()) return {};
  const size_t begin = line_starts_[line - 1];
  size_t end = line < line_starts_.size() ? line_starts_[line] - 1 : text_.size();
  if (end > begin && text_[end - 1] == '\r') --end;
  return std::string_view(text_).substr(begin, end - begin);
}

}  // namespace isoshade::support
