// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

namespace isoshade::graph {

/// Reads JSON and calls what nlohmann::json::sax_parse would call, several times as fast. Fails, without an event
/// that says why, on what is not valid and on what few documents have: escapes, characters beyond ASCII, integers of
/// more than 18 digits. `reached` receives where the token ends that an event is of.
template <class Events>
class PlainReader {
 public:
  PlainReader(std::string_view text, const char** reached, Events& events)
      : at_(text.data()), end_(text.data() + text.size()), reached_(reached), events_(events) {}

  bool read() { return value() && next() == '\0' && at_ == end_; }

 private:
  /// The next character that is no blank; NUL at the end.
  char next() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\n' || *at_ == '\r' || *at_ == '\t')) ++at_;
    return at_ == end_ ? '\0' : *at_;
  }

  /// Passes a character if it is the next one.
  bool pass(char c) {
    if (next() != c) return false;
    *reached_ = ++at_;
    return true;
  }

  // Nests as deep as `events` lets it.
  bool value() {
    switch (next()) {
      case '{': return pass('{') && events_.start_object(0) && rest_of_object();
      case '[': return pass('[') && events_.start_array(0) && rest_of_array();
      case '"': return string() && events_.string(text_);
      case 't': return word("true") && events_.boolean(true);
      case 'f': return word("false") && events_.boolean(false);
      case 'n': return word("null") && events_.null();
      default: return number();
    }
  }

  bool rest_of_object() {
    if (pass('}')) return events_.end_object();
    do {
      if (next() != '"' || !string() || !events_.key(text_) || !pass(':') || !value()) return false;
    } while (pass(','));
    return pass('}') && events_.end_object();
  }

  bool rest_of_array() {
    if (pass(']')) return events_.end_array();
    do {
      if (!value()) return false;
    } while (pass(','));
    return pass(']') && events_.end_array();
  }

  bool string() {
    const char* const begin = ++at_;
    while (at_ != end_ && *at_ != '"' && *at_ != '\\' && *at_ >= ' ' && *at_ <= '~') ++at_;
    if (at_ == end_ || *at_ != '"') return false;
    text_.assign(begin, at_);
    *reached_ = ++at_;
    return true;
  }

  bool word(std::string_view word) {
    if (!std::string_view(at_, end_).starts_with(word)) return false;
    *reached_ = at_ += word.size();
    return true;
  }

  bool digits() {
    const char* const begin = at_;
    while (at_ != end_ && *at_ >= '0' && *at_ <= '9') ++at_;
    return at_ != begin;
  }

  bool number() {
    const char* const begin = at_;
    const bool is_negative = at_ != end_ && *at_ == '-';
    if (is_negative) ++at_;
    const char* const first = at_;
    if (!digits() || (*first == '0' && at_ - first > 1)) return false;
    constexpr ptrdiff_t most_digits = 18;  // of an int64
    const char* const whole = at_;
    if (at_ != end_ && *at_ == '.' && (++at_, !digits())) return false;
    if (at_ != end_ && (*at_ == 'e' || *at_ == 'E')) {
      ++at_;
      if (at_ != end_ && (*at_ == '+' || *at_ == '-')) ++at_;
      if (!digits()) return false;
    }
    *reached_ = at_;
    if (at_ != whole) {
      double value = 0;
      return std::from_chars(begin, at_, value).ec == std::errc() && events_.number_float(value, text_);
    }
    int64_t value = 0;
    if (whole - first > most_digits || std::from_chars(begin, at_, value).ec != std::errc()) return false;
    return events_.number_integer(value);
  }

  const char* at_;
  const char* const end_;
  const char** reached_;
  Events& events_;
  std::string text_;
};

}  // namespace isoshade::graph
