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
  double number = 0;
  std::string string;
  std::vector<Json> items;      ///< of an array
  std::vector<Member> members;  ///< of an object, in the order written
  uint32_t begin = 0, end = 0;  ///< byte range in the document

  const Json* find(std::string_view key) const;
};

struct Member {
  std::string key;
  uint32_t key_begin = 0, key_end = 0;
  Json value;
};

std::string_view kind_name(Json::Kind kind);

/// Limits that keep hostile documents harmless.
inline constexpr int max_depth = 64;
inline constexpr size_t max_document_bytes = 256u << 20;

struct Document {
  support::Source source;
  Json root;

  support::Span span(const Json& value) const { return {source, value.begin, value.end}; }
  support::Span key_span(const Member& member) const { return {source, member.key_begin, member.key_end}; }
};

/// Parses JSON text (RFC 8259, UTF-8). Reports syntax errors, duplicate keys, nesting beyond max_depth,
/// numbers that no double holds, and bytes that are not UTF-8.
std::optional<Document> parse_document(support::Source source, support::Diagnostics& diagnostics);

/// Reads a file ("-" is standard input); reports a file that is missing, unreadable or too large.
support::Source read_source(const std::string& path, support::Diagnostics& diagnostics);

}  // namespace isoshade::graph
