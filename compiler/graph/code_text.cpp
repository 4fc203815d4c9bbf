// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/code_text.h"

#include "compiler/support/assert.h"

namespace isoshade::graph {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// Length in bytes of the UTF-8 sequence that begins with `lead`.
size_t utf8_length(unsigned char lead) { return lead < 0x80 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4; }

/// Length in bytes of the escape of a character that is `length` bytes of UTF-8: characters beyond the basic
/// multilingual plane are written as two \u escapes.
size_t escape_length(std::string_view raw, size_t length) { return raw[1] != 'u' ? 2 : length == 4 ? 12 : 6; }

size_t end_of_number(std::string_view text, size_t at) {
  const auto digits = [&] {
    while (at < text.size() && is_digit(text[at])) ++at;
  };
  digits();
  if (at < text.size() && text[at] == '.') {
    ++at;
    digits();
  }
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    const size_t sign = at + 1 < text.size() && (text[at + 1] == '+' || text[at + 1] == '-') ? 1 : 0;
    if (at + 1 + sign < text.size() && is_digit(text[at + 1 + sign])) {
      at += 1 + sign;
      digits();
    }
  }
  return at;
}

/// id {"::" id}
size_t end_of_name(std::string_view text, size_t at) {
  while (true) {
    while (at < text.size() && (is_letter(text[at]) || is_digit(text[at]))) ++at;
    if (text.substr(at, 2) != "::" || at + 2 >= text.size() || !is_letter(text[at + 2])) return at;
    at += 2;
  }
}

size_t end_of_symbol(std::string_view text, size_t at) {
  for (const std::string_view two : {"||", "&&", "==", "!=", "<=", ">="})
    if (text.substr(at, 2) == two) return at + 2;
  return at + 1;
}

}  // namespace

CodeText::CodeText(const Document& document, const Json& string)
    : text_(string.string), source_(string.source) {
  const std::string_view raw = document.text(string);
  offsets_.reserve(text_.size() + 1);
  size_t at = 1;  // after the quote
  while (offsets_.size() < text_.size()) {
    const size_t length = utf8_length(static_cast<unsigned char>(text_[offsets_.size()]));
    const size_t written = raw[at] == '\\' ? escape_length(raw.substr(at), length) : length;
    for (size_t i = 0; i < length && offsets_.size() < text_.size(); ++i)
      offsets_.push_back(string.begin + static_cast<uint32_t>(at));
    at += written;
    support::assert_that(at < raw.size(), "a decoded string is longer than its JSON text");
  }
  offsets_.push_back(string.begin + static_cast<uint32_t>(at));
}

CodeText::Token CodeText::next(uint32_t from) const {
  size_t at = from;
  while (at < text_.size() && is_blank(text_[at])) ++at;
  const auto token = [&](Kind kind, size_t end) {
    return Token{kind, std::string_view(text_).substr(at, end - at), static_cast<uint32_t>(at),
                 static_cast<uint32_t>(end)};
  };
  if (at == text_.size()) return token(Kind::end, at);
  const char c = text_[at];
  if (is_letter(c)) return token(Kind::name, end_of_name(text_, at));
  const bool point = c == '.' && at + 1 < text_.size() && is_digit(text_[at + 1]);
  if (is_digit(c) || point) return token(Kind::number, end_of_number(text_, at));
  constexpr std::string_view symbols = "+-*/<>=!&|?:.,()";
  if (symbols.find(c) != std::string_view::npos) return token(Kind::symbol, end_of_symbol(text_, at));
  return token(Kind::unknown, at + utf8_length(static_cast<unsigned char>(c)));
}

}  // namespace isoshade::graph
