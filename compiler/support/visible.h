// SPDX-License-Identifier: Apache-2.0
// Makes text from documents safe to print on a terminal: it must not move the cursor, change colours, reorder
// the line or contain invalid UTF-8.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace isoshade::support {

struct Glyph {
  size_t bytes;    ///< consumed from the text, at least 1
  size_t columns;  ///< width on a terminal
};

/// Appends the first character of `text` (not empty) to `out`: unchanged if printable; as \x1b if it is a
/// control character or a byte that is not UTF-8; as \u202e if it is invisible or changes the writing
/// direction.
Glyph append_visible(std::string_view text, std::string& out);

/// `text` with every character made visible; the result is one line.
std::string visible(std::string_view text);

/// visible(text) in double quotes, cut after about 80 bytes. Messages use it for names and text from documents.
std::string quote(std::string_view text);

}  // namespace isoshade::support
