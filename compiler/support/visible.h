// SPDX-License-Identifier: Apache-2.0
// Text of documents on its way to a terminal. Nothing in it may move the cursor, change colours, reorder the
// line or be bytes that the terminal guesses about.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace isoshade::support {

struct Glyph {
  size_t bytes;    ///< consumed from the text, at least 1
  size_t columns;  ///< taken up on a terminal
};

/// Appends the first character of `text` (not empty) to `out`: as it is where it prints as itself; as \x1b
/// where it is a control character or a byte that is not UTF-8; as \u202e where it is invisible or changes
/// the direction of writing.
Glyph append_visible(std::string_view text, std::string& out);

/// All of `text` made visible, so it is one line.
std::string visible(std::string_view text);

/// The visible text in double quotes, cut after some 80 bytes: how messages name what a document says.
std::string quote(std::string_view text);

}  // namespace isoshade::support
