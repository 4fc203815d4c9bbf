// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/document.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <unistd.h>
#include <utility>

#include "compiler/support/parse_number.h"
#include "compiler/support/read_file.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {

using support::Diagnostics;
using support::Id;
using support::Source;
using support::Span;

const Json* Json::find(std::string_view key) const {
  for (const Member& member : members) {
    if (member.key == key) return &member.value;
  }
  return nullptr;
}

Json* Json::find(std::string_view key) { return const_cast<Json*>(std::as_const(*this).find(key)); }

std::string_view kind_name(Json::Kind kind) {
  switch (kind) {
    case Json::Kind::null: return "null";
    case Json::Kind::boolean: return "a boolean";
    case Json::Kind::number: return "a number";
    case Json::Kind::string: return "a string";
    case Json::Kind::array: return "an array";
    case Json::Kind::object: return "an object";
  }
  return {};
}

float Document::to_float(const Json& number) const {
  if (number.computed) {
    const auto rounded = static_cast<float>(number.number);
    return std::abs(rounded) < std::numeric_limits<float>::min() ? std::copysign(0.0f, rounded) : rounded;
  }
  // parse_float accepts every JSON number.
  return support::parse_float(text(number)).value_or(0.0f);
}

int64_t Document::to_integer(const Json& number) const {
  if (!number.integral) return static_cast<int64_t>(number.number);
  const std::string_view digits = text(number);
  int64_t value = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

Source read_source(const std::string& path, Diagnostics& diagnostics, const Span& where) {
  const bool named_by_document = where.file != nullptr;
  const bool standard_input = path == "-" && !named_by_document;
  auto [bytes, id, reason] =
      standard_input
          ? support::read_open_file(STDIN_FILENO, max_document_bytes)
          : support::read_file(path, max_document_bytes,
                               named_by_document ? support::Pipes::refused : support::Pipes::nameless);
  if (!bytes) {
    diagnostics.report(id, where, "cannot read " + support::quote(path) + ": " + reason);
    return nullptr;
  }
  return std::make_shared<support::SourceFile>(standard_input ? "<stdin>" : path, *std::move(bytes));
}

std::string pointer_at(const Document& document, uint32_t offset) {
  const auto holds = [&](uint32_t begin, uint32_t end) { return begin <= offset && offset < end; };
  std::string pointer;
  const Json* value = &document.root;
  for (bool inside = true; inside;) {
    inside = false;
    for (const Member& member : value->members) {
      if (!holds(member.key_begin, member.value.end)) continue;
      pointer += '/';
      for (const char c : member.key) pointer += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
      value = &member.value;
      inside = true;
      break;
    }
    if (inside) continue;
    for (size_t i = 0; i < value->items.size(); ++i) {
      if (!holds(value->items[i].begin, value->items[i].end)) continue;
      pointer += '/' + std::to_string(i);
      value = &value->items[i];
      inside = true;
      break;
    }
  }
  return pointer;
}

void add_pointers(const Document& document, Diagnostics& diagnostics) {
  for (support::Diagnostic& diagnostic : diagnostics.all()) {
    if (diagnostic.where.file != document.source || !diagnostic.pointer.empty()) continue;
    diagnostic.pointer = pointer_at(document, diagnostic.where.begin);
  }
}

void add_pointers(Diagnostics& diagnostics) {
  std::set<Source> sources;
  for (const support::Diagnostic& diagnostic : diagnostics.all()) sources.insert(diagnostic.where.file);
  for (const Source& source : sources) {
    Diagnostics ignored;
    const auto document = source != nullptr ? parse_document(source, ignored) : std::nullopt;
    if (document) add_pointers(*document, diagnostics);
  }
}

}  // namespace isoshade::graph
