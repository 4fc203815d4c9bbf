// SPDX-License-Identifier: Apache-2.0
// Documents made from good ones by damage.
#pragma once

#include <algorithm>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace isoshade {

/// Damages documents in ways in which authors, scripts and attackers do. The same seed gives the same texts.
class Mutator {
 public:
  Mutator(std::vector<std::string> documents, uint32_t seed)
      : documents_(std::move(documents)), random_(seed) {}

  std::string next() {
    std::string text = any(documents_);
    for (size_t n = below(3) == 0 ? 1 + below(4) : 1; n > 0; --n) damage(text);
    return text;
  }

 private:
  size_t below(size_t end) { return end == 0 ? 0 : random_() % end; }
  template <class T>
  const T& any(const std::vector<T>& values) {
    return values[below(values.size())];
  }

  /// Places where JSON values or keys stand: after a quote, a colon, a bracket or a comma.
  size_t token(const std::string& text) {
    const size_t from = below(text.size());
    const size_t found = text.find_first_of("\":,[]{}", from);
    return found == std::string::npos ? from : found;
  }

  static std::string nested(size_t depth, std::string_view open, std::string_view close) {
    std::string text;
    for (size_t i = 0; i < depth; ++i) text += open;
    text += "1";
    for (size_t i = 0; i < depth; ++i) text += close;
    return text;
  }

  std::string strange_value() {
    switch (below(12)) {
      case 0: return "1e400";
      case 1: return "-0.0000000000000000000000000000000000000000000001e-400";
      case 2: return "9223372036854775808";
      case 3: return nested(below(2) == 0 ? 60 : 100'000, "[", "]");
      case 4: return nested(below(2) == 0 ? 60 : 100'000, "{\"a\":", "}");
      case 5: {
        std::string array = "[0";
        for (size_t i = below(20'000); i > 0; --i) array += ",0";
        return array + "]";
      }
      case 6: return "\"*/ #include <stdio.h>\\n?\?/ \\\\\"";
      case 7: return "\"" + std::string(below(5'000), 'x') + "\"";
      case 8: return "null";
      case 9: return "{\"link\": \"x\"}";
      case 10: return "\"\\ud83d\\ude00.\\u0000\"";
      default: return std::to_string(static_cast<int64_t>(random_()) - 2'000'000'000);
    }
  }

  void damage(std::string& text) {
    if (text.empty()) text = any(documents_);
    // Half of the damage leaves the text JSON, so that it gets farther than the parser.
    constexpr size_t still_json[] = {3, 4, 5, 11, 12, 12};
    switch (below(2) == 0 ? still_json[below(std::size(still_json))] : below(13)) {
      case 0:
        for (size_t n = 1 + below(8); n > 0; --n)
          text[below(text.size())] ^= static_cast<char>(1u << below(8));
        return;
      case 1: text.resize(below(text.size())); return;
      case 2: {  // a piece twice, or somewhere else
        const size_t from = token(text), length = 1 + below(200);
        const std::string piece = text.substr(from, length);
        if (below(2) == 0) text.erase(from, length);
        text.insert(std::min(token(text), text.size()), piece);
        return;
      }
      case 3: swap_strings(text); return;
      case 4: replace_string(text, quoted_word()); return;
      case 5: replace_number(text, strange_value()); return;
      case 6: text.insert(token(text), strange_value()); return;
      case 7: text.erase(token(text), 1 + below(40)); return;
      case 8: {  // a piece of another document
        const std::string& other = any(documents_);
        const size_t from = token(other) % (other.size() + 1);
        text.insert(token(text), other.substr(from, 1 + below(300)));
        return;
      }
      case 9: text.insert(below(text.size()), 1, static_cast<char>(below(256))); return;
      case 10: replace_string(text, strange_value()); return;
      case 11: replace_number(text, std::to_string(below(200) / 8.0)); return;
      default: {  // a link to something else of the document
        const auto [at, length] = string_at(text);
        if (length != 0) replace_string(text, text.substr(at, length));
        return;
      }
    }
  }

  /// The range of a string with its quotes, or nothing.
  std::pair<size_t, size_t> string_at(const std::string& text) {
    const size_t first = text.find('"', below(text.size()));
    if (first == std::string::npos) return {0, 0};
    const size_t last = text.find('"', first + 1);
    return last == std::string::npos ? std::pair<size_t, size_t>{0, 0} : std::pair{first, last - first + 1};
  }

  void swap_strings(std::string& text) {
    const auto [a, a_length] = string_at(text);
    const auto [b, b_length] = string_at(text);
    if (a_length == 0 || b_length == 0 || a + a_length > b) return;
    const std::string one = text.substr(a, a_length), other = text.substr(b, b_length);
    text.replace(b, b_length, one);
    text.replace(a, a_length, other);
  }

  void replace_string(std::string& text, const std::string& with) {
    const auto [at, length] = string_at(text);
    if (length != 0) text.replace(at, length, with);
  }

  void replace_number(std::string& text, const std::string& with) {
    const size_t first = text.find_first_of("0123456789", below(text.size()));
    if (first == std::string::npos) return;
    const size_t end = text.find_first_not_of("0123456789.eE+-", first);
    text.replace(first, std::min(end, text.size()) - first, with);
  }

  std::string quoted_word() {
    static const std::vector<std::string> words = {"main",
                                                   "gl_Position",
                                                   "float",
                                                   "template",
                                                   "iso_dot_v3",
                                                   "shade",
                                                   "precise",
                                                   "any",
                                                   "expression",
                                                   "code",
                                                   "type",
                                                   "sum_lights",
                                                   "lightcolor",
                                                   "normal",
                                                   "position",
                                                   "add",
                                                   "mix",
                                                   "constant",
                                                   "convert",
                                                   "to",
                                                   "color4",
                                                   "matrix44",
                                                   "boolean",
                                                   "filename",
                                                   "x.y.z.w",
                                                   "../../etc/passwd",
                                                   "brdf/cook_torrance",
                                                   "a*(b+c.xyz)?1:2",
                                                   "((((((((",
                                                   "max(1,2)",
                                                   "-----x"};
    return "\"" + any(words) + "\"";
  }

  std::vector<std::string> documents_;
  std::mt19937 random_;
};

}  // namespace isoshade
