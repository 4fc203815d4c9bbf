// SPDX-License-Identifier: Apache-2.0
// The string that an expression is written in: its tokens, and where they stand in the document.
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
  /// Bytes of the decoded string as a place in the document, whatever escapes stand before and in them.
  TextRange place(uint32_t begin, uint32_t end) const { return {offsets_[begin], offsets_[end]}; }

 private:
  const std::string& text_;
  std::vector<uint32_t> offsets_;  ///< of each byte in the document, and of the closing quote
};

}  // namespace isoshade::graph
