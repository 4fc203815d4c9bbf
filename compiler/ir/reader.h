// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/ir/lexer.h"
#include "compiler/ir/type.h"

namespace isoshade::ir {

/// Steps through the tokens of text IR. Each `take` and `expect` is false, and `error` says why, where the
/// text has something else; the first error stays.
class Reader {
 public:
  Reader(const std::vector<Token>& tokens, size_t position, std::string& error)
      : tokens_(tokens), position_(position), error_(error) {}

  size_t position() const { return position_; }

 protected:
  using Kind = Token::Kind;

  const Token& peek() const { return tokens_[position_]; }
  const Token& next() { return tokens_[position_ + 1 < tokens_.size() ? position_++ : position_]; }
  bool at(Kind kind, std::string_view text = {}) const {
    return peek().kind == kind && (text.empty() || peek().text == text);
  }
  bool accept(Kind kind, std::string_view text = {}) {
    const bool here = at(kind, text);
    if (here) next();
    return here;
  }

  bool fail(const std::string& message) {
    const bool bad = peek().kind == Kind::bad;
    if (error_.empty()) error_ = "line " + std::to_string(peek().line) + ": " + (bad ? peek().text : message);
    return false;
  }
  bool expect(std::string_view mark) {
    return accept(Kind::mark, mark) || fail("expected '" + std::string(mark) + "'");
  }
  bool take(Kind kind, std::string& out, std::string_view what) {
    if (!at(kind)) return fail("expected " + std::string(what));
    out = next().text;
    return true;
  }
  template <class Integer>
  bool take_number(Integer& out, std::string_view what) {
    if (!at(Kind::number)) return fail("expected " + std::string(what));
    const std::string& text = peek().text;
    const bool hex = text.starts_with("0x");
    const char* const end = text.data() + text.size();
    const auto [stop, code] = std::from_chars(text.data() + (hex ? 2 : 0), end, out, hex ? 16 : 10);
    if (stop != end || code != std::errc()) return fail("no such number here: " + text);
    next();
    return true;
  }
  bool take_type(Type& out) {
    const auto type = at(Kind::word) ? type_from_name(peek().text) : std::nullopt;
    if (!type) return fail("expected a type");
    out = *type;
    next();
    return true;
  }

  const std::vector<Token>& tokens_;
  size_t position_;
  std::string& error_;
};

}  // namespace isoshade::ir
