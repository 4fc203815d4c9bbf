// SPDX-License-Identifier: Apache-2.0
// A JSON text with the place of every key and value, and a reader that reports what an author gets wrong.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/support/diagnostics.h"

namespace isoshade::graph {

struct Member;

/// One JSON value. Numbers keep their text's exact double; integers are numbers with `integral` set.
struct Json {
  enum class Kind : uint8_t { null, boolean, number, string, array, object };
  Kind kind = Kind::null;
  bool boolean = false;
  bool integral = false;  ///< the number was written without fraction or exponent and fits int64
  uint32_t source = 0;    ///< which of the document's sources it stands in
  double number = 0;
  std::string string;
  std::vector<Json> items;      ///< of an array
  std::vector<Member> members;  ///< of an object, in the order written
  uint32_t begin = 0, end = 0;  ///< byte range in its source

  const Json* find(std::string_view key) const;
  Json* find(std::string_view key);
};

struct Member {
  std::string key;
  uint32_t key_begin = 0, key_end = 0;  ///< in the source of the value
  Json value;
};

/// With its article: "a number", "an array", "null".
std::string_view kind_name(Json::Kind kind);

/// Limits that keep hostile documents harmless.
inline constexpr int max_depth = 64;
inline constexpr size_t max_document_bytes = 32u << 20;  ///< a graph of 100,000 nodes has some 10 MiB
inline constexpr size_t max_values =
    1'000'000;  ///< each takes some 300 bytes, its part of the Graph included

struct Document {
  support::Source source;
  Json root;
  std::vector<support::Source> others{};  ///< sources 1, 2, ... of values that came from elsewhere: merge.h

  const support::Source& source_of(const Json& value) const {
    return value.source == 0 ? source : others[value.source - 1];
  }
  support::Span span(const Json& value) const { return {source_of(value), value.begin, value.end}; }
  /// The value as it is written, quotes and escapes included.
  std::string_view text(const Json& value) const {
    return std::string_view(source_of(value)->text()).substr(value.begin, value.end - value.begin);
  }
  /// A number's text rounded once to float: through Json::number it would be rounded twice. Denormals are
  /// zeros; what is beyond the range is infinite.
  float to_float(const Json& number) const;
  /// The exact value of an integral number.
  int64_t to_integer(const Json& number) const;
  support::Span key_span(const Member& member) const {
    return {source_of(member.value), member.key_begin, member.key_end};
  }
};

/// Parses JSON text (RFC 8259, UTF-8). Reports syntax errors, duplicate keys, nesting beyond max_depth,
/// numbers that no double holds, and bytes that are not UTF-8; a text that is no JSON ends at its first
/// error. A byte order mark at the head is skipped.
std::optional<Document> parse_document(support::Source source, support::Diagnostics& diagnostics);

/// Reads a file ("-" is standard input); reports a file that is missing, unreadable or too large, and then
/// returns nothing. `where` is the place that names the file, if a document does, which can name regular files
/// only.
support::Source read_source(const std::string& path, support::Diagnostics& diagnostics,
                            const support::Span& where = {});

/// The JSON pointer (RFC 6901) of the innermost value at a byte offset of a document with one source:
/// "/nodes/a/in1"; "" is the root.
std::string pointer_at(const Document& document, uint32_t offset);

/// Fills in the pointer of every diagnostic that lies in `document` and has none. For --diagnostics json.
void add_pointers(const Document& document, support::Diagnostics& diagnostics);

}  // namespace isoshade::graph
