// SPDX-License-Identifier: Apache-2.0
// The lexer of expressions: tokens, and their ranges in the document.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "compiler/graph/document.h"
#include "compiler/graph/graph.h"

namespace isoshade::graph {

class CodeText {
 public:
  enum class Kind : uint8_t { name, number, symbol, end, unknown };
  struct Token {
    Kind kind = Kind::end;
    std::string_view text;
    uint32_t begin = 0, end = 0;  ///< in the decoded string
  };

  /// `string` must outlive this.
  CodeText(const Document& document, const Json& string);

  const std::string& text() const { return text_; }
  /// The first token at or after `from`, an offset in the decoded string.
  Token next(uint32_t from) const;
  /// Maps a range of the decoded string to the document, accounting for escapes.
  TextRange place(uint32_t begin, uint32_t end) const { return {offsets_[begin], offsets_[end], source_}; }

 private:
  const std::string& text_;
  uint32_t source_;               ///< as Json::source
  std::vector<uint32_t> offsets_;  ///< document offset of each decoded byte and of the closing quote
};

}  // namespace isoshade::graph
