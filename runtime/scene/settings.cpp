// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/settings.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "compiler/graph/files.h"
#include "compiler/graph/graph.h"
#include "compiler/support/visible.h"
#include "runtime/scene/parse_parts.h"

namespace isoshade::scene {

using graph::Document;
using graph::Json;
using graph::Member;
using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

struct Setting {
  std::string_view text;  ///< as given
  std::string_view name;  ///< empty if only a parameter was given
  std::string_view key;
  std::string value;  ///< JSON on one line
};

/// A replacement of bytes in the document's text.
struct Edit {
  uint32_t begin, end;
  std::string text;
};

bool is_json(const std::string& text) {
  Diagnostics unheard;
  return graph::parse_document(std::make_shared<support::SourceFile>("--set", text), unheard).has_value();
}

/// The value as one line of JSON.
std::optional<std::string> to_json(std::string_view text) {
  std::string value(text);
  std::replace(value.begin(), value.end(), '\n', ' ');
  std::replace(value.begin(), value.end(), '\r', ' ');
  if (is_json(value)) return value;
  if (std::string list = "[" + value + "]"; value.find(',') != std::string::npos && is_json(list))
    return list;
  if (value.empty() || value.find_first_of("[]{},:\"") != std::string::npos) return std::nullopt;
  if (std::string word = "\"" + value + "\""; is_json(word)) return word;
  return std::nullopt;
}

std::optional<Setting> split(std::string_view text, Diagnostics& diagnostics) {
  Setting setting{text, {}, {}, {}};
  const size_t equals = text.find('=');
  const std::string_view target = text.substr(0, equals);
  const size_t dot = target.find('.');
  setting.key = dot == std::string_view::npos ? target : target.substr(dot + 1);
  if (dot != std::string_view::npos) setting.name = target.substr(0, dot);
  const bool named =
      graph::is_id(setting.key) && (dot == std::string_view::npos || graph::is_id(setting.name));
  const auto value = equals == std::string_view::npos ? std::nullopt : to_json(text.substr(equals + 1));
  if (named && value) {
    setting.value = *value;
    return setting;
  }
  diagnostics.report(Id::bad_setting, "--set " + quote(text) + " is not of the form name.parameter=value")
      .note(named && equals != std::string_view::npos
                ? "the value is JSON, numbers with commas between them, or a plain word"
                : "for example --set balls.roughness=0.3");
  return std::nullopt;
}

const Json* find_object(const Json& json, std::string_view key) {
  const Json* found = json.find(key);
  return found != nullptr && found->kind == Json::Kind::object ? found : nullptr;
}

class Editor {
 public:
  Editor(const Document& document, Diagnostics& diagnostics)
      : document_(document), diagnostics_(diagnostics) {}

  /// The document with the setting written into it.
  std::optional<Document> apply(const Setting& setting);

 private:
  bool set_named(const Setting& setting);
  bool set_bare(const Setting& setting);
  void set_parameter(const Json& object, const Setting& setting);
  /// Sets a member of an object, replacing or adding it.
  void set_member(const Json& object, std::string_view key, const std::string& value);
  void remove_member(const Json& object, const Member& member);

  std::vector<std::pair<std::string_view, const Json*>> owners() const;
  std::vector<std::string_view> parameters_of(const Json& object);
  const std::vector<std::string>& parameters_of_effect(const std::string& path);
  /// A value for a parameter of an object, with a path in it from the root, as the user counts it from where he is.
  std::string value_for(const Json& object, const Setting& setting);

  const Document& document_;
  Diagnostics& diagnostics_;
  std::vector<Edit> edits_;
  std::map<std::string, std::vector<std::string>> effects_;  ///< parameter names by path
};

const std::vector<std::string>& Editor::parameters_of_effect(const std::string& path) {
  const auto [found, is_new] = effects_.try_emplace(path);
  if (!is_new) return found->second;
  // What is wrong with the effect is reported when it is compiled.
  Diagnostics unheard;
  const support::Source source = graph::read_source(path, unheard, {document_.source, 0, 0});
  const auto effect = source ? graph::parse_document(source, unheard) : std::nullopt;
  if (!effect) return found->second;
  if (const Json* parameters = find_object(effect->root, "parameters"))
    for (const Member& member : parameters->members) found->second.push_back(member.key);
  return found->second;
}

/// The objects of the scene, and its posts under the names that they have.
std::vector<std::pair<std::string_view, const Json*>> Editor::owners() const {
  std::vector<std::pair<std::string_view, const Json*>> all;
  if (const Json* objects = find_object(document_.root, "objects")) {
    for (const Member& member : objects->members)
      if (member.value.kind == Json::Kind::object) all.emplace_back(member.key, &member.value);
  }
  const Json* posts = document_.root.find("posts");
  if (posts == nullptr || posts->kind != Json::Kind::array) return all;
  for (const Json& post : posts->items) {
    const Json* name = post.kind == Json::Kind::object ? post.find("name") : nullptr;
    if (name != nullptr && name->kind == Json::Kind::string) all.emplace_back(name->string, &post);
  }
  return all;
}

std::vector<std::string_view> Editor::parameters_of(const Json& object) {
  std::vector<std::string_view> names;
  const auto add_keys = [&](const Json* json) {
    if (json == nullptr) return;
    for (const Member& member : json->members) names.push_back(member.key);
  };
  add_keys(find_object(object, "parameters"));
  if (const Json* repeat = object.find("repeat"))
    for (const Json& axis : repeat->items) add_keys(find_object(axis, "parameters"));
  const Json* effect = object.find("effect");
  if (effect != nullptr && effect->kind == Json::Kind::string) {
    for (const std::string& name : parameters_of_effect(path_beside(document_, effect->string)))
      names.push_back(name);
  }
  return names;
}

void Editor::set_member(const Json& object, std::string_view key, const std::string& value) {
  for (const Member& member : object.members) {
    if (member.key != key) continue;
    edits_.push_back({member.value.begin, member.value.end, value});
    return;
  }
  const std::string separator = object.members.empty() ? "" : ", ";
  edits_.push_back(
      {object.begin + 1, object.begin + 1, "\"" + std::string(key) + "\": " + value + separator});
}

void Editor::remove_member(const Json& object, const Member& member) {
  const auto place = static_cast<size_t>(&member - object.members.data());
  const bool last = place + 1 == object.members.size();
  // With the comma after it, or before it if it is the last.
  const uint32_t begin = last && place > 0 ? object.members[place - 1].value.end : member.key_begin;
  const uint32_t end = last ? member.value.end : object.members[place + 1].key_begin;
  edits_.push_back({begin, end, ""});
}

std::string Editor::value_for(const Json& object, const Setting& setting) {
  const Json* effect = object.find("effect");
  if (effect == nullptr || effect->kind != Json::Kind::string) return setting.value;
  Diagnostics unheard;
  const auto value =
      graph::parse_document(std::make_shared<support::SourceFile>("--set", setting.value), unheard);
  const std::string path = path_beside(document_, effect->string);
  const support::Source source = graph::read_source(path, unheard, {document_.source, 0, 0});
  const auto read = source ? graph::parse_document(source, unheard) : std::nullopt;
  if (!value || !read || value->root.kind != Json::Kind::string || value->root.string.empty())
    return setting.value;
  const Json* parameters = find_object(read->root, "parameters");
  const Json* parameter = parameters != nullptr ? find_object(*parameters, setting.key) : nullptr;
  const Json* type = parameter != nullptr ? parameter->find("type") : nullptr;
  if (type == nullptr || type->string != graph::type_name(graph::Type::filename)) return setting.value;
  return nlohmann::json(graph::canonical_path(value->root.string))
      .dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

void Editor::set_parameter(const Json& object, const Setting& setting) {
  const std::string value = value_for(object, setting);
  if (const Json* repeat = object.find("repeat")) {
    for (const Json& axis : repeat->items) {
      const Json* variations = find_object(axis, "parameters");
      if (variations == nullptr) continue;
      for (const Member& member : variations->members)
        if (member.key == setting.key) remove_member(*variations, member);
    }
  }
  if (const Json* parameters = find_object(object, "parameters")) {
    set_member(*parameters, setting.key, value);
  } else {
    set_member(object, "parameters", "{\"" + std::string(setting.key) + "\": " + value + "}");
  }
}

bool Editor::set_named(const Setting& setting) {
  std::vector<std::string_view> names = {"camera", "output"};
  for (const auto& [name, owner] : owners()) {
    names.push_back(name);
    if (name != setting.name) continue;
    const std::vector<std::string_view> parameters = parameters_of(*owner);
    if (std::find(parameters.begin(), parameters.end(), setting.key) == parameters.end()) {
      diagnostics_.report_unknown(Id::unknown_setting, {},
                                  "--set " + quote(setting.text) + ": the effect of " + quote(setting.name) +
                                      " has no parameter " + quote(setting.key),
                                  setting.key, parameters);
      return false;
    }
    set_parameter(*owner, setting);
    return true;
  }
  if (const Json* lights = find_object(document_.root, "lights")) {
    for (const Member& member : lights->members) {
      names.push_back(member.key);
      if (member.key != setting.name || member.value.kind != Json::Kind::object) continue;
      set_member(member.value, setting.key, setting.value);
      return true;
    }
  }
  if (setting.name == "camera" || setting.name == "output") {
    if (const Json* part = find_object(document_.root, setting.name)) {
      set_member(*part, setting.key, setting.value);
    } else {
      set_member(document_.root, setting.name,
                 "{\"" + std::string(setting.key) + "\": " + setting.value + "}");
    }
    return true;
  }
  diagnostics_.report_unknown(
      Id::unknown_setting, {},
      "--set " + quote(setting.text) + ": the scene has no object, light or post " + quote(setting.name),
      setting.name, names);
  return false;
}

bool Editor::set_bare(const Setting& setting) {
  if (setting.key == "background" || setting.key == "size") {
    set_member(document_.root, setting.key, setting.value);
    return true;
  }
  std::vector<std::pair<std::string_view, const Json*>> having;
  std::vector<std::string_view> all_parameters = {"background", "size"};
  for (const auto& owner : owners()) {
    const std::vector<std::string_view> parameters = parameters_of(*owner.second);
    all_parameters.insert(all_parameters.end(), parameters.begin(), parameters.end());
    if (std::find(parameters.begin(), parameters.end(), setting.key) != parameters.end())
      having.push_back(owner);
  }
  if (having.size() == 1) {
    set_parameter(*having[0].second, setting);
    return true;
  }
  if (having.empty()) {
    diagnostics_.report_unknown(
        Id::unknown_setting, {},
        "--set " + quote(setting.text) + ": no object or post has a parameter " + quote(setting.key),
        setting.key, all_parameters);
    return false;
  }
  diagnostics_
      .report(Id::unknown_setting, "--set " + quote(setting.text) + ": " + std::to_string(having.size()) +
                                       " objects or posts have a parameter " + quote(setting.key))
      .suggest("name the one: --set " + support::visible(std::string(having[0].first)) + "." +
               std::string(setting.text));
  return false;
}

std::optional<Document> Editor::apply(const Setting& setting) {
  if (!(setting.name.empty() ? set_bare(setting) : set_named(setting))) return std::nullopt;
  // From the end, so that the places of the others stay right.
  std::sort(edits_.begin(), edits_.end(), [](const Edit& a, const Edit& b) { return a.begin > b.begin; });
  std::string text = document_.source->text();
  for (const Edit& edit : edits_) text.replace(edit.begin, edit.end - edit.begin, edit.text);
  return graph::parse_document(
      std::make_shared<support::SourceFile>(document_.source->path(), std::move(text)), diagnostics_);
}

}  // namespace

std::optional<Document> apply_settings(const Document& document, const std::vector<std::string>& settings,
                                       Diagnostics& diagnostics) {
  Document result = document;
  for (const std::string& text : settings) {
    const std::optional<Setting> setting = split(text, diagnostics);
    if (!setting) return std::nullopt;
    std::optional<Document> changed = Editor(result, diagnostics).apply(*setting);
    if (!changed) return std::nullopt;
    result = *std::move(changed);
  }
  return result;
}

}  // namespace isoshade::scene
