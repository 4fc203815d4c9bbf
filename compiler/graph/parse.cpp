// SPDX-License-Identifier: Apache-2.0
// JSON text -> Document: nlohmann's lexer and grammar with our source ranges, limits and messages.
#include <algorithm>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>

#include "compiler/graph/document.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {
namespace {

using support::Diagnostic;
using support::Diagnostics;
using support::Id;
using support::Source;
using support::Span;

/// Iterates over the text and records how far the lexer has read, which nlohmann does not report.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = char;

  CountingIterator(const char* at, const char** reached) : at_(at), reached_(reached) {}
  char operator*() const { return *at_; }
  CountingIterator& operator++() {
    *reached_ = ++at_;
    return *this;
  }
  CountingIterator operator++(int) {
    const CountingIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  const char** reached_;
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_word(char c) { return is_digit(c) || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; }

bool is_between_tokens(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',' || c == ':'; }

struct Extent {
  uint32_t begin, end;
};

/// nlohmann's message for a syntax error, and ours.
struct Explanation {
  std::string_view theirs;  ///< prefix of nlohmann's message
  Id id;
  std::string_view ours;
  std::string_view fix;
};
constexpr Explanation explanations[] = {
    {"invalid string: missing closing quote", Id::syntax, "unterminated string", "add the closing quote"},
    {"invalid string: control character", Id::syntax, "control character in a string",
     "write it as an escape"},
    {"invalid string: ill-formed UTF-8", Id::bad_utf8, "the text is not UTF-8 here", ""},
    {"invalid string: surrogate", Id::bad_utf8, "lone surrogate in an escape",
     "escapes from \\ud800 to \\udfff must come in pairs"},
    {"invalid string: forbidden character", Id::syntax, "unknown escape",
     "write a backslash as \\\\"},
    {"invalid string: '\\u'", Id::syntax, "\\u needs four hex digits", ""},
    {"invalid BOM", Id::bad_utf8, "the text is not UTF-8 here", ""},
    {"invalid number", Id::bad_number, "malformed number", "write numbers as 1, -0.5, 1e-4"},
    {"number overflow", Id::bad_number, "number beyond the range of a double", ""},
    {"unexpected string literal; expected '}'", Id::syntax, "missing comma before this key", ""},
    {"unexpected string literal; expected ']'", Id::syntax, "missing comma before this value", ""},
    {"unexpected '{'; expected ']'", Id::syntax, "missing comma before this value", ""},
    {"unexpected '['; expected ']'", Id::syntax, "missing comma before this value", ""},
    {"unexpected number literal; expected ']'", Id::syntax, "missing comma before this value", ""},
};

/// Handles nlohmann's SAX events. Each method returns whether to continue.
class Builder {
 public:
  Builder(Document& document, const char* const* reached, Diagnostics& diagnostics)
      : document_(document), text_(document.source->text()), reached_(reached), diagnostics_(diagnostics) {
    if (text_.substr(0, 3) == "\xef\xbb\xbf") last_end_ = 3;
  }

  bool null() { return add(Json::Kind::null, token()) != nullptr; }
  bool boolean(bool value) {
    Json* json = add(Json::Kind::boolean, token());
    if (json != nullptr) json->boolean = value;
    return json != nullptr;
  }
  bool number_integer(int64_t value) { return add_number(static_cast<double>(value), true); }
  bool number_unsigned(uint64_t value) { return add_number(static_cast<double>(value), value <= INT64_MAX); }
  bool number_float(double value, const std::string&) { return add_number(value, false); }
  bool string(std::string& value) {
    Json* json = add(Json::Kind::string, token());
    if (json != nullptr) json->string = std::move(value);
    return json != nullptr;
  }
  bool binary(nlohmann::json::binary_t&) { return false; }  // does not occur in JSON text
  bool start_object(size_t) { return open(Json::Kind::object); }
  bool start_array(size_t) { return open(Json::Kind::array); }
  bool end_object() {
    report_duplicates(*open_.back());
    return close();
  }
  bool end_array() { return close(); }
  bool key(std::string& key) {
    const Extent extent = token();
    std::vector<Member>& members = open_.back()->members;
    if (members.empty()) members.reserve(4);  // as a node has
    Member& member = members.emplace_back();
    member.key = std::move(key);
    member.key_begin = extent.begin;
    member.key_end = extent.end;
    return true;
  }

  bool parse_error(size_t, const std::string&, const nlohmann::json::exception& error);

  /// nlohmann stops at a NUL; reports any text after it.
  void check_rest() {
    const uint32_t rest = skip(last_end_, " \t\r\n");
    if (rest < text_.size())
      report_syntax({rest, static_cast<uint32_t>(text_.size())}, "text after the end of the document");
  }

 private:
  Span span(Extent extent) const { return {document_.source, extent.begin, extent.end}; }
  uint32_t reached() const { return static_cast<uint32_t>(*reached_ - text_.data()); }
  uint32_t skip(uint32_t at, std::string_view what) const {
    return static_cast<uint32_t>(std::min(text_.find_first_not_of(what, at), text_.size()));
  }

  /// The range of the token that nlohmann has just read. Only whitespace and separators, which cause no events,
  /// lie between it and the previous token.
  Extent token() {
    uint32_t begin = last_end_;
    while (begin < text_.size() && is_between_tokens(text_[begin])) ++begin;
    Extent extent{begin, reached()};
    const char first = text_[extent.begin];
    // The lexer reads one character beyond a number to find its end.
    if ((is_digit(first) || first == '-') && !is_digit(text_[extent.end - 1])) --extent.end;
    last_begin_ = extent.begin;
    last_end_ = extent.end;
    return extent;
  }

  Json* add(Json::Kind kind, Extent extent) {
    if (++count_ > max_values) {
      diagnostics_.report(Id::too_large, span(extent),
                          "the document has more than " + std::to_string(max_values) + " values");
      return nullptr;
    }
    Json* json = &document_.root;
    if (!open_.empty()) {
      Json& parent = *open_.back();
      json = parent.kind == Json::Kind::array ? &parent.items.emplace_back() : &parent.members.back().value;
    }
    json->kind = kind;
    json->begin = extent.begin;
    json->end = extent.end;
    return json;
  }

  bool add_number(double value, bool integral) {
    Json* json = add(Json::Kind::number, token());
    if (json == nullptr) return false;
    // nlohmann reports -0 as the integer 0, without its sign.
    json->number = value == 0 && text_[json->begin] == '-' ? -0.0 : value;
    json->integral = integral;
    return true;
  }

  bool open(Json::Kind kind) {
    const Extent extent = token();
    if (open_.size() >= max_depth) {
      diagnostics_.report(Id::too_deep, span(extent),
                          "arrays and objects are nested deeper than " + std::to_string(max_depth));
      return false;
    }
    Json* json = add(kind, extent);
    // The pointer stays valid while the value is open: its parent grows only after it is closed.
    if (json != nullptr) open_.push_back(json);
    return json != nullptr;
  }

  bool close() {
    open_.back()->end = token().end;
    open_.pop_back();
    return true;
  }

  void report_duplicates(const Json& object);

  Diagnostic& report_syntax(Extent extent, std::string message, Id id = Id::syntax) {
    return diagnostics_.report(id, span(extent), std::move(message));
  }

  Document& document_;
  std::string_view text_;
  const char* const* reached_;
  Diagnostics& diagnostics_;
  std::vector<Json*> open_;                 ///< arrays and objects, the root first
  uint32_t last_begin_ = 0, last_end_ = 0;  ///< of the last token
  size_t count_ = 0;                        ///< values so far
};

/// Whether no two members have one key, of so few that comparing all is the fastest.
bool are_few_and_different(const std::vector<Member>& members) {
  constexpr size_t few = 8;
  if (members.size() > few) return false;
  for (size_t i = 1; i < members.size(); ++i)
    for (size_t k = 0; k < i; ++k)
      if (members[i].key == members[k].key) return false;
  return true;
}

void Builder::report_duplicates(const Json& object) {
  if (are_few_and_different(object.members)) return;
  // Sort instead of using a hash table, which a hostile document could make slow; compare hashes first, because that
  // is faster.
  struct Entry {
    size_t hash;
    const Member* member;
  };
  std::vector<Entry> sorted;
  sorted.reserve(object.members.size());
  for (const Member& member : object.members)
    sorted.push_back({std::hash<std::string>()(member.key), &member});
  std::sort(sorted.begin(), sorted.end(), [](const Entry& a, const Entry& b) {
    if (a.hash != b.hash) return a.hash < b.hash;
    const int order = a.member->key.compare(b.member->key);
    return order != 0 ? order < 0 : a.member < b.member;
  });
  std::vector<std::pair<const Member*, const Member*>> twice;  // the repeated member, the first one
  for (size_t i = 1, first = 0; i < sorted.size(); ++i) {
    const bool same =
        sorted[i].hash == sorted[first].hash && sorted[i].member->key == sorted[first].member->key;
    if (same) twice.emplace_back(sorted[i].member, sorted[first].member);
    if (!same) first = i;
  }
  std::sort(twice.begin(), twice.end());
  for (const auto& [again, first] : twice) {
    diagnostics_
        .report(Id::duplicate_key, document_.key_span(*again),
                "duplicate key " + support::quote(again->key))
        .note(document_.key_span(*first), "the first one is here");
  }
}

bool Builder::parse_error(size_t, const std::string&, const nlohmann::json::exception& error) {
  // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error while parsing value -
  // REASON; last read: '...'". The message for an overflow has no " - REASON" part.
  std::string_view reason = error.what();
  const size_t overflow = reason.find("number overflow");
  const size_t dash = reason.find(" - ");
  if (overflow != std::string_view::npos) {
    reason.remove_prefix(overflow);
  } else if (dash != std::string_view::npos) {
    reason.remove_prefix(dash + 3);
  }
  reason = reason.substr(0, reason.find("; last read: "));
  const auto begins = [&](std::string_view start) { return reason.substr(0, start.size()) == start; };

  const auto size = static_cast<uint32_t>(text_.size());
  const uint32_t end = reached();
  const uint32_t last = end == 0 ? 0 : end - 1;
  Extent extent{std::min(skip(last_end_, " \t\r\n,:"), last), end};
  const char first = extent.begin < size ? text_[extent.begin] : '\0';

  const bool begins_number = is_digit(first) || first == '-';
  if (begins("unexpected number literal") && (!begins_number || extent.begin < last_end_)) {
    // The grammar ends a number after a leading zero, and the last event included the next digit.
    report_syntax({last_begin_, last_end_}, "number with a leading zero", Id::bad_number);
    return false;
  }
  if (count_ > 0 && open_.empty()) {
    report_syntax({extent.begin, size}, "text after the end of the document");
    return false;
  }
  if (begins("unexpected end of input")) {
    if (last < size && text_[last] == '\0') {
      report_syntax({last, end}, "NUL byte in the document");
    } else if (skip(0, " \t\r\n") == size || text_ == "\xef\xbb\xbf") {
      report_syntax({0, 0}, "the document is empty");
    } else {
      Diagnostic& report = report_syntax({size, size}, "unexpected end of the document");
      if (!open_.empty()) {
        const Json& unclosed = *open_.back();
        const bool array = unclosed.kind == Json::Kind::array;
        report.note(span({unclosed.begin, unclosed.begin + 1}),
                    array ? "this '[' is not closed" : "this '{' is not closed");
      }
    }
    return false;
  }
  if ((first == '}' || first == ']') && begins("unexpected")) {
    const size_t before = text_.find_last_not_of(" \t\r\n", extent.begin - (extent.begin > 0));
    if (extent.begin > 0 && before != std::string_view::npos && text_[before] == ',') {
      const auto comma = static_cast<uint32_t>(before);
      report_syntax({comma, comma + 1}, std::string("trailing comma before '") + first + "'").suggest("remove it");
      return false;
    }
  }
  if (begins("invalid literal")) {
    // The lexer stops at the first wrong character; report the whole word.
    while (is_word(first) && extent.end < size && is_word(text_[extent.end])) ++extent.end;
    const bool comment = first == '/' || first == '#';
    Diagnostic& report = report_syntax(extent, comment ? "JSON has no comments" : "not a JSON value");
    if (first == '\'' || is_word(first)) report.suggest("put strings and keys in double quotes");
    if (comment) report.suggest("put remarks under \"doc\" or \"extras\"");
    return false;
  }
  if (begins("invalid string") && !begins("invalid string: missing closing quote")) extent.begin = last;
  if (begins("invalid BOM")) extent = {0, 1};
  const bool whole_number = begins("number overflow") || begins("unexpected number literal");
  if (whole_number && !is_digit(text_[extent.end - 1])) --extent.end;
  for (const Explanation& explanation : explanations) {
    if (!begins(explanation.theirs)) continue;
    report_syntax(extent, std::string(explanation.ours), explanation.id)
        .suggest(std::string(explanation.fix));
    return false;
  }
  report_syntax(extent, std::string(reason));
  return false;
}

}  // namespace

std::optional<Document> parse_document(Source source, Diagnostics& diagnostics) {
  Document document{std::move(source), {}};
  const std::string& text = document.source->text();
  if (text.size() > max_document_bytes) {
    diagnostics.report(Id::too_large, {document.source, 0, 0},
                       "the document has more than " + std::to_string(max_document_bytes >> 20) + " MiB");
    return std::nullopt;
  }
  // nlohmann keeps whitespace with the next token, and in an error spends 0.1 us per character on it.
  constexpr size_t most_blanks = 1 << 16;
  size_t blanks = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    blanks = static_cast<unsigned char>(text[i]) <= ' ' ? blanks + 1 : 0;
    if (blanks <= most_blanks) continue;
    diagnostics.report(Id::too_large,
                       {document.source, static_cast<uint32_t>(i), static_cast<uint32_t>(i + 1)},
                       "the document has more than " + std::to_string(most_blanks) + " blanks in a row");
    return std::nullopt;
  }
  const size_t errors_before = diagnostics.error_count();
  const char* reached = text.data();
  Builder builder(document, &reached, diagnostics);
  const char* const end = text.data() + text.size();
  if (nlohmann::json::sax_parse(CountingIterator(text.data(), &reached), CountingIterator(end, &reached),
                                &builder)) {
    builder.check_rest();
  }
  if (diagnostics.error_count() != errors_before) return std::nullopt;
  return document;
}

}  // namespace isoshade::graph
