// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/visible.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <iterator>

namespace isoshade::support {
namespace {

struct Range {
  uint32_t first, last;
};

// Unicode characters without a visible glyph, or that change the writing direction.
constexpr Range invisible[] = {{0x80, 0x9f},      {0xad, 0xad},     {0x61c, 0x61c},   {0x115f, 0x1160},
                               {0x180e, 0x180e},  {0x200b, 0x200f}, {0x2028, 0x202e}, {0x2060, 0x206f},
                               {0x3164, 0x3164},  {0xfeff, 0xfeff}, {0xffa0, 0xffa0}, {0xfff0, 0xfffb},
                               {0xe0000, 0xe0fff}};
constexpr Range combining[] = {{0x300, 0x36f},   {0x1ab0, 0x1aff}, {0x1dc0, 0x1dff},
                               {0x20d0, 0x20ff}, {0xfe00, 0xfe0f}, {0xfe20, 0xfe2f}};
constexpr Range wide[] = {{0x1100, 0x115f},   {0x2e80, 0x303e},   {0x3041, 0xa4cf},   {0xac00, 0xd7a3},
                          {0xf900, 0xfaff},   {0xfe30, 0xfe6f},   {0xff00, 0xff60},   {0xffe0, 0xffe6},
                          {0x1f300, 0x1f64f}, {0x1f680, 0x1f6ff}, {0x1f900, 0x1f9ff}, {0x20000, 0x3fffd}};

template <size_t N>
bool contains(const Range (&ranges)[N], uint32_t code) {
  return std::any_of(std::begin(ranges), std::end(ranges),
                     [&](const Range& range) { return range.first <= code && code <= range.last; });
}

/// Decodes the first code point of `text`. Returns its length, or 0 if the bytes are not UTF-8.
size_t decode(std::string_view text, uint32_t& code) {
  const auto byte = [&](size_t i) -> uint32_t { return static_cast<unsigned char>(text[i]); };
  const uint32_t head = byte(0);
  const size_t length = head < 0x80 ? 1 : head >> 5 == 6 ? 2 : head >> 4 == 14 ? 3 : head >> 3 == 30 ? 4 : 0;
  if (length == 0 || length > text.size()) return 0;
  code = length == 1 ? head : head & (0x7fu >> length);
  for (size_t i = 1; i < length; ++i) {
    if (byte(i) >> 6 != 2) return 0;
    code = code << 6 | (byte(i) & 0x3f);
  }
  constexpr uint32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  return code < smallest[length] || surrogate || code > 0x10ffff ? 0 : length;
}

}  // namespace

Glyph append_visible(std::string_view text, std::string& out) {
  uint32_t code = 0;
  size_t length = decode(text, code);
  char escape[16];
  int columns = 0;
  if (length == 0 || code < 0x20 || code == 0x7f) {
    length = 1;
    columns = std::snprintf(escape, sizeof escape, "\\x%02x", static_cast<unsigned char>(text[0]));
  } else if (contains(invisible, code)) {
    columns = std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(code));
  } else {
    out.append(text.substr(0, length));
    return {length, contains(combining, code) ? 0u : contains(wide, code) ? 2u : 1u};
  }
  out.append(escape, columns);
  return {length, static_cast<size_t>(columns)};
}

std::string visible(std::string_view text) {
  std::string out;
  while (!text.empty()) text.remove_prefix(append_visible(text, out).bytes);
  return out;
}

std::string quote(std::string_view text) {
  constexpr size_t longest = 80;
  std::string out = "\"";
  while (!text.empty() && out.size() < longest) text.remove_prefix(append_visible(text, out).bytes);
  return out + (text.empty() ? "\"" : "...\"");
}

}  // namespace isoshade::support
