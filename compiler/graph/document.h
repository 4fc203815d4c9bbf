// SPDX-License-Identifier: Apache-2.0
// A JSON document with the source range of every key and value: parsing, merging, formatting.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/support/diagnostics.h"

namespace isoshade::graph {

struct Member;

/// One JSON value. `number` is the double nearest to the text; integers are numbers with `integral` set. A value may be
/// computed from others, such as one between two keys of an animation; its range is then that of one of them.
struct Json {
  enum class Kind : uint8_t { null, boolean, number, string, array, object };
  Kind kind = Kind::null;
  bool boolean = false;
  bool integral = false;  ///< the number has no fraction or exponent and fits int64
  bool computed = false;  ///< the number is `number`, and not what its text says; then it is not `integral`
  uint32_t source = 0;    ///< 0: Document::source; n: Document::others[n - 1]
  double number = 0;
  std::string string;
  std::vector<Json> items;      ///< of an array
  std::vector<Member> members;  ///< of an object, in document order
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
inline constexpr size_t max_document_bytes = 32u << 20;  ///< a graph of 100,000 nodes has about 10 MiB
inline constexpr size_t max_values = 1'000'000;          ///< each takes about 300 bytes, with its share of the Graph

struct Document {
  support::Source source;
  Json root;
  std::vector<support::Source> others{};  ///< sources 1, 2, ... of values from merged documents

  const support::Source& source_of(const Json& value) const {
    return value.source == 0 ? source : others[value.source - 1];
  }
  support::Span span(const Json& value) const { return {source_of(value), value.begin, value.end}; }
  /// The source text of the value, with quotes and escapes.
  std::string_view text(const Json& value) const {
    return std::string_view(source_of(value)->text()).substr(value.begin, value.end - value.begin);
  }
  /// The text of a number rounded once to float (Json::number would round twice), or a computed number. Denormals flush
  /// to zero; overflow gives infinity.
  float to_float(const Json& number) const;
  /// The exact value of an integral number.
  int64_t to_integer(const Json& number) const;
  support::Span key_span(const Member& member) const {
    return {source_of(member.value), member.key_begin, member.key_end};
  }
};

/// Parses JSON (RFC 8259, UTF-8). Reports syntax errors, duplicate keys, nesting beyond max_depth, numbers
/// beyond the range of double, and invalid UTF-8; stops at the first syntax error. Skips a byte order mark.
std::optional<Document> parse_document(support::Source source, support::Diagnostics& diagnostics);

/// Reads a file ("-" is standard input). Reports a missing, unreadable or too large file and returns null.
/// `where` is the location in a document that refers to the file, if any; documents may refer only to regular
/// files.
support::Source read_source(const std::string& path, support::Diagnostics& diagnostics,
                            const support::Span& where = {});

/// The JSON pointer (RFC 6901) of the innermost value at a byte offset of a document with one source:
/// "/nodes/a/in1"; "" is the root.
std::string pointer_at(const Document& document, uint32_t offset);

/// Fills in the pointer of every diagnostic that lies in `document` and has none. For --diagnostics json.
void add_pointers(const Document& document, support::Diagnostics& diagnostics);

/// The same for all diagnostics, whatever documents they lie in.
void add_pointers(support::Diagnostics& diagnostics);

/// Copies `value`, which stands in `source`, so that it can be inserted into the document.
Json adopt(Document& document, support::Source source, Json value);

/// Applies `changes` to `base` as a JSON Merge Patch (RFC 7386): objects are merged member by member, null removes a
/// member, anything else replaces the old value. Two additions: an object with a "type" replaces the old object as a
/// whole, because the keys of another type have no meaning in it; and a null that removes nothing is an error, except
/// in "extras". Every value keeps its source, so that diagnostics point there and paths are relative to it; source 0 of
/// the result is that of `changes`.
Document merge(Document base, Document changes, support::Diagnostics& diagnostics);

/// The document in canonical layout, at most 120 columns wide: two spaces per indent; a value stays on one line if it
/// fits, otherwise each member has its own line, as do the members of objects of objects at the top level. Keeps the
/// order of keys, the spelling of strings and numbers, and one blank line wherever members were separated by blank
/// lines. Idempotent.
std::string format(const Document& document);

}  // namespace isoshade::graph
