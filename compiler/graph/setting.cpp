// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/setting.h"

#include <utility>

#include "compiler/support/visible.h"

namespace isoshade::graph {

using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

std::optional<Document> parse_json(const std::string& text) {
  Diagnostics unheard;
  return parse_document(std::make_shared<support::SourceFile>("--set", text), unheard);
}

bool is_json(const std::string& text) { return parse_json(text).has_value(); }

/// The value as JSON.
std::optional<std::string> to_json(std::string_view text) {
  const std::string value(text);
  if (is_json(value)) return value;
  if (std::string list = "[" + value + "]"; value.find(',') != std::string::npos && is_json(list))
    return list;
  if (value.empty() || value.find_first_of("[]{},:\"") != std::string::npos) return std::nullopt;
  if (std::string word = "\"" + value + "\""; is_json(word)) return word;
  return std::nullopt;
}

}  // namespace

std::optional<Setting> parse_setting(std::string_view text, std::string_view example, Diagnostics& diagnostics) {
  Setting setting{text, {}, {}, {}, {}};
  const size_t equals = text.find('=');
  const std::string target(text.substr(0, equals));
  const size_t dot = target.find('.');
  setting.key = text.substr(0, equals);
  if (dot != std::string::npos) {
    setting.name = setting.key.substr(0, dot);
    setting.key.remove_prefix(dot + 1);
  }
  const bool named = is_id(setting.key) && (dot == std::string::npos || is_id(setting.name));
  const auto value = equals == std::string_view::npos ? std::nullopt : to_json(text.substr(equals + 1));
  // Parsed at its position in the text, so that spans are right.
  const std::string padding(target.size() + 1, ' ');
  auto parsed = named && value ? parse_json(padding + *value) : std::nullopt;
  if (parsed) {
    setting.value = std::move(parsed->root);
    setting.source = std::make_shared<support::SourceFile>("--set", target + "=" + *value,
                                                           support::SourceFile::Origin::argument);
    return setting;
  }
  diagnostics.report(Id::bad_setting, "--set " + quote(text) + " is not of the form name.parameter=value")
      .note(named && equals != std::string_view::npos
                ? "the value is JSON, numbers with commas between them, or a plain word"
                : "for example --set " + std::string(example));
  return std::nullopt;
}

std::optional<GivenParameter> parse_given_parameter(std::string_view text, Diagnostics& diagnostics) {
  const std::optional<Setting> setting = parse_setting(text, "roughness=0.3", diagnostics);
  if (!setting) return std::nullopt;
  if (!setting->name.empty()) {
    diagnostics.report(Id::bad_setting, "--set " + quote(text) + " names something in a scene")
        .suggest("--set " + support::visible(std::string(text.substr(setting->name.size() + 1))));
    return std::nullopt;
  }
  const Document document{setting->source, setting->value};
  const auto literal = parse_literal(document, setting->value, setting->key, diagnostics);
  if (!literal) return std::nullopt;
  const auto key_end = static_cast<uint32_t>(setting->key.size());
  return GivenParameter{std::string(setting->key), *literal, {setting->source, 0, key_end}, document.span(setting->value)};
}

}  // namespace isoshade::graph
