// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/lexer.h"

#include <optional>

namespace isoshade::ir {

namespace {

// The C locale's classes, whatever the program's locale.
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_name(char c) { return is_letter(c) || is_digit(c); }

std::optional<int> hex_digit(char c) {
  if (is_digit(c)) return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return std::nullopt;
}

class Lexer {
 public:
  explicit Lexer(std::string_view text) : rest_(text) {}

  std::vector<Token> run() {
    while (tokens_.empty() ||
           (tokens_.back().kind != Token::Kind::end && tokens_.back().kind != Token::Kind::bad)) {
      skip_space();
      next();
    }
    return std::move(tokens_);
  }

 private:
  using Kind = Token::Kind;

  char peek(size_t ahead = 0) const { return ahead < rest_.size() ? rest_[ahead] : '\0'; }

  void skip_space() {
    while (!rest_.empty()) {
      if (peek() == '#') {
        rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size()));
      } else if (peek() == '\n') {
        ++line_;
        rest_.remove_prefix(1);
      } else if (peek() == ' ' || peek() == '\t' || peek() == '\r') {
        rest_.remove_prefix(1);
      } else {
        return;
      }
    }
  }

  void add(Kind kind, std::string text) { tokens_.push_back({kind, std::move(text), line_}); }

  // Takes the first `skip` characters and all that follow while `more` holds; the token is without the
  // skipped.
  template <class Predicate>
  void take(Kind kind, size_t skip, Predicate more) {
    size_t size = skip;
    while (size < rest_.size() && more(rest_[size])) ++size;
    if (size == skip && skip != 0)
      return add(Kind::bad, "a name is missing after '" + std::string(1, peek()) + "'");
    add(kind, std::string(rest_.substr(skip, size - skip)));
    rest_.remove_prefix(size);
  }

  void next() {
    if (rest_.empty()) return add(Kind::end, "");
    const char c = peek();
    if (is_letter(c)) return take(Kind::word, 0, is_name);
    if (c == '%') return take(Kind::value, 1, [](char d) { return is_name(d) || d == '.'; });
    if (c == '@') return take(Kind::function, 1, is_name);
    if (c == '"') return string();
    if (c == '-' && peek(1) == '>') {
      add(Kind::mark, "->");
      rest_.remove_prefix(2);
      return;
    }
    if (is_digit(c) || c == '-') return number();
    if (std::string_view("(){}[]<,:;=").find(c) != std::string_view::npos) {
      add(Kind::mark, std::string(1, c));
      rest_.remove_prefix(1);
      return;
    }
    add(Kind::bad, "a character that is nowhere part of text IR");
  }

  void number() {
    size_t size = 1;
    while (size < rest_.size() && is_name(rest_[size])) ++size;
    add(Kind::number, std::string(rest_.substr(0, size)));
    rest_.remove_prefix(size);
  }

  void string() {
    std::string text;
    for (size_t i = 1; i < rest_.size() && rest_[i] != '\n'; ++i) {
      if (rest_[i] == '"') {
        add(Kind::string, std::move(text));
        rest_.remove_prefix(i + 1);
        return;
      }
      if (rest_[i] != '\\') {
        text += rest_[i];
        continue;
      }
      const char escape = peek(++i);
      if (escape == '"' || escape == '\\') {
        text += escape;
        continue;
      }
      const auto high = hex_digit(peek(i + 1)), low = hex_digit(peek(i + 2));
      if (escape != 'x' || !high || !low) return add(Kind::bad, "an escape that does not exist");
      text += static_cast<char>(*high * 16 + *low);
      i += 2;
    }
    add(Kind::bad, "a string that does not end on its line");
  }

  std::string_view rest_;
  uint32_t line_ = 1;
  std::vector<Token> tokens_;
};

}  // namespace

std::vector<Token> tokenise(std::string_view text) { return Lexer(text).run(); }

bool is_identifier(std::string_view text) {
  if (text.empty() || !is_letter(text.front())) return false;
  for (char c : text)
    if (!is_name(c)) return false;
  return true;
}

}  // namespace isoshade::ir
