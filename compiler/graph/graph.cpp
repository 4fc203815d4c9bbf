// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "compiler/support/parse_number.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {

using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

struct TypeRow {
  std::string_view name;
  int floats;
};
// In the order of Type.
constexpr std::array<TypeRow, 12> types = {{{"boolean", 0},
                                            {"integer", 0},
                                            {"float", 1},
                                            {"vector2", 2},
                                            {"vector3", 3},
                                            {"vector4", 4},
                                            {"color3", 3},
                                            {"color4", 4},
                                            {"matrix33", 9},
                                            {"matrix44", 16},
                                            {"filename", 0},
                                            {"string", 0}}};
static_assert(types.size() == static_cast<size_t>(Type::string) + 1);

// In the order of DocumentKind.
constexpr std::array<std::string_view, 5> kinds = {"function", "effect", "post", "scene", "image"};

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; }

/// Reports a missing or unsupported version.
bool check_version(const Document& document, Diagnostics& diagnostics) {
  const Json& root = document.root;
  const Json* version = root.find("isoshade");
  if (version == nullptr) {
    diagnostics
        .report(Id::missing_key, {document.source, root.begin, root.begin + 1},
                "the document has no version")
        .suggest("add \"isoshade\": 1");
    return false;
  }
  if (version->kind == Json::Kind::number && version->number == 1) return true;
  diagnostics.report(Id::wrong_version, document.span(*version),
                     "this version of isoshade reads documents of version 1 only");
  return false;
}

}  // namespace

std::string_view kind_name(DocumentKind kind) { return kinds[static_cast<size_t>(kind)]; }

std::string with_article(DocumentKind kind) {
  const bool is_vowel = kind == DocumentKind::effect || kind == DocumentKind::image;
  return (is_vowel ? "an " : "a ") + std::string(kind_name(kind));
}

std::string_view type_name(Type type) { return types[static_cast<size_t>(type)].name; }

std::optional<Type> find_type(std::string_view name) {
  for (size_t i = 0; i < types.size(); ++i) {
    if (types[i].name == name) return static_cast<Type>(i);
  }
  return std::nullopt;
}

std::vector<std::string_view> all_type_names() {
  std::vector<std::string_view> names;
  for (const TypeRow& row : types) names.push_back(row.name);
  return names;
}

int float_count(Type type) { return types[static_cast<size_t>(type)].floats; }

bool is_id(std::string_view text) {
  if (text.empty() || text.size() > 128 || !is_letter(text[0])) return false;
  for (const char c : text) {
    if (!is_letter(c) && !(c >= '0' && c <= '9')) return false;
  }
  return true;
}

std::optional<DocumentKind> document_kind(const Document& document, Diagnostics& diagnostics) {
  const Json& root = document.root;
  if (root.kind != Json::Kind::object) {
    diagnostics.report(Id::wrong_type, document.span(root),
                       "a document must be an object, not " + std::string(kind_name(root.kind)));
    return std::nullopt;
  }
  const bool version_fits = check_version(document, diagnostics);
  const Member* named = nullptr;
  DocumentKind kind{};
  for (const Member& member : root.members) {
    for (size_t i = 0; i < kinds.size(); ++i) {
      if (member.key != kinds[i]) continue;
      if (named != nullptr) {
        diagnostics.report(Id::wrong_kind, document.key_span(member), "a document has only one kind")
            .note(document.key_span(*named), "the first kind is here");
        return std::nullopt;
      }
      named = &member;
      kind = static_cast<DocumentKind>(i);
    }
  }
  if (named == nullptr) {
    diagnostics
        .report(Id::wrong_kind, {document.source, root.begin, root.begin + 1},
                "a document must be a function, effect, post, scene or image")
        .suggest("add \"effect\": \"its_name\", or another of these keys");
    return std::nullopt;
  }
  if (!version_fits) return std::nullopt;
  return kind;
}

std::optional<Literal> parse_literal(const Document& document, const Json& json, std::string_view key,
                                     Diagnostics& diagnostics) {
  Literal literal;
  const auto finite = [&](const Json& number) {
    if (std::isfinite(document.to_float(number))) return true;
    diagnostics.report(Id::out_of_range, document.span(number), quote(key) + " is beyond the range of float");
    return false;
  };
  switch (json.kind) {
    case Json::Kind::boolean:
      literal.kind = Literal::Kind::boolean;
      literal.boolean = json.boolean;
      return literal;
    case Json::Kind::number:
      if (!finite(json)) return std::nullopt;
      literal.number = document.to_float(json);
      literal.integral = json.integral;
      if (json.integral) literal.integer = document.to_integer(json);
      return literal;
    case Json::Kind::string:
      literal.kind = Literal::Kind::string;
      literal.string = json.string;
      return literal;
    case Json::Kind::array:
      literal.kind = Literal::Kind::numbers;
      if (json.items.empty() || json.items.size() > max_literal_numbers) break;
      for (const Json& item : json.items) {
        if (item.kind != Json::Kind::number) {
          diagnostics.report(
              Id::wrong_type, document.span(item),
              quote(key) + " must be an array of numbers, but contains " + std::string(kind_name(item.kind)));
          return std::nullopt;
        }
        if (!finite(item)) return std::nullopt;
        literal.numbers.push_back(document.to_float(item));
      }
      return literal;
    case Json::Kind::null:
    case Json::Kind::object: break;
  }
  const bool array = json.kind == Json::Kind::array;
  diagnostics.report(Id::wrong_type, document.span(json),
                     array ? quote(key) + " must be an array of 1 to " + std::to_string(max_literal_numbers) +
                                 " numbers, not of " + std::to_string(json.items.size())
                           : quote(key) + " cannot be " + std::string(kind_name(json.kind)));
  return std::nullopt;
}

std::optional<Link> parse_link(std::string_view text, TextRange place, const support::Span& where,
                               Diagnostics& diagnostics) {
  Link link{{}, {}, place};
  size_t parts = 0;
  bool good = true;
  for (std::string_view rest = text; good; ++parts) {
    const size_t dot = rest.find('.');
    const std::string_view part = rest.substr(0, dot);
    good = is_id(part) && parts < 3;
    if (good && parts == 0) link.name = part;
    if (good && parts > 0) link.selectors.emplace_back(part);
    if (dot == std::string_view::npos) break;
    rest.remove_prefix(dot + 1);
  }
  if (good) return link;
  diagnostics.report(Id::bad_link, where, quote(text) + " is not a link")
      .note("a link is \"node\", \"node.port\", \"node.xyz\" or \"node.port.xyz\"");
  return std::nullopt;
}

std::optional<Literal> named_value(const std::vector<std::string>& names, std::string_view name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  Literal literal;
  literal.integral = true;
  literal.integer = found - names.begin();
  literal.number = static_cast<float>(literal.integer);
  return literal;
}

std::string described_names(const std::vector<std::string>& names) {
  std::string list = "it is ";
  for (size_t i = 0; i < names.size(); ++i) {
    if (i > 0) list += i + 1 == names.size() ? " or " : ", ";
    list += std::to_string(i) + " (" + names[i] + ")";
  }
  return list;
}

std::string limit_text(Type type, float limit) {
  const bool whole = type == Type::integer && limit == std::floor(limit) && std::abs(limit) < 0x1p31f;
  return whole ? std::to_string(static_cast<int64_t>(limit)) : support::format_float(limit);
}

bool fits(Type type, const Literal& literal) {
  switch (type) {
    case Type::boolean: return literal.kind == Literal::Kind::boolean;
    case Type::integer:
      return literal.kind == Literal::Kind::number && literal.integral &&
             literal.integer >= std::numeric_limits<int32_t>::min() &&
             literal.integer <= std::numeric_limits<int32_t>::max();
    case Type::floating: return literal.kind == Literal::Kind::number;
    case Type::filename:
    case Type::string: return literal.kind == Literal::Kind::string;
    default:
      return literal.kind == Literal::Kind::numbers &&
             literal.numbers.size() == static_cast<size_t>(float_count(type));
  }
}

}  // namespace isoshade::graph
