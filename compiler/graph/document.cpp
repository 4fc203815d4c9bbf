// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/document.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "compiler/support/parse_number.h"
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
  // Every JSON number is one that parse_float takes.
  return support::parse_float(text(number)).value_or(0.0f);
}

int64_t Document::to_integer(const Json& number) const {
  const std::string_view digits = text(number);
  int64_t value = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

Source read_source(const std::string& path, Diagnostics& diagnostics, const Span& where) {
  const bool named_by_document = where.file != nullptr;
  const bool standard_input = path == "-" && !named_by_document;
  const auto fail = [&](Id id, const std::string& reason) {
    diagnostics.report(id, where, "cannot read " + support::quote(path) + ": " + reason);
    return nullptr;
  };
  // The system would open what stands before the NUL.
  if (path.find('\0') != std::string::npos) return fail(Id::missing_file, "the name has a NUL byte");
  // A user may name a pipe. Opening one that a document names would wait for a writer.
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (named_by_document && std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    return fail(Id::unreadable_file, "it is no regular file");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> opened(
      standard_input ? nullptr : std::fopen(path.c_str(), "rb"),
      [](std::FILE* file) { return std::fclose(file); });
  std::FILE* const file = standard_input ? stdin : opened.get();
  if (file == nullptr) {
    const int error = errno;
    const bool missing = error == ENOENT || error == ENOTDIR || error == ENAMETOOLONG;
    return fail(missing ? Id::missing_file : Id::unreadable_file, std::strerror(error));
  }
  // Read rather than asked for its size: pipes have none, and /dev/zero no end.
  std::string text;
  char buffer[1 << 16];
  while (text.size() <= max_document_bytes) {
    const size_t count = std::fread(buffer, 1, sizeof buffer, file);
    text.append(buffer, count);
    if (count < sizeof buffer) break;
  }
  if (std::ferror(file)) return fail(Id::unreadable_file, std::strerror(errno));
  if (text.size() > max_document_bytes) {
    return fail(Id::too_large, "it has more than " + std::to_string(max_document_bytes >> 20) + " MiB");
  }
  return std::make_shared<support::SourceFile>(standard_input ? "<stdin>" : path, std::move(text));
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

}  // namespace isoshade::graph
