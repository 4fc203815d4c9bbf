// SPDX-License-Identifier: Apache-2.0
// Settings: --set.
#include <algorithm>
#include <map>
#include <utility>

#include "compiler/graph/extend.h"
#include "compiler/graph/graph.h"
#include "compiler/graph/setting.h"
#include "compiler/support/visible.h"
#include "runtime/scene/format.h"
#include "runtime/scene/load.h"

namespace isoshade::scene {

using graph::Document;
using graph::Json;
using graph::Member;
using graph::Setting;
using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

template <typename Value>  // Json or const Json
Value* find_object(Value& json, std::string_view key) {
  Value* found = json.find(key);
  return found != nullptr && found->kind == Json::Kind::object ? found : nullptr;
}

class Editor {
 public:
  Editor(Document& document, const graph::FileRule& files, Diagnostics& diagnostics)
      : document_(document), files_(files), diagnostics_(diagnostics) {}

  /// Writes a setting into the document.
  bool apply(Setting& setting);

 private:
  bool set_named(Setting& setting);
  bool set_bare(Setting& setting);
  void set_parameter(Json& object, Setting& setting);
  /// Sets a member of an object, replacing or adding it.
  void set_member(Json& object, Setting& setting);
  /// The object under a key of another one; added if it is missing.
  Json& part(Json& object, std::string_view key, const Setting& setting);

  std::vector<std::pair<std::string_view, Json*>> owners();
  std::vector<std::string_view> parameters_of(const Json& object);
  const std::vector<std::string>& parameters_of_effect(const std::string& path);

  Document& document_;
  const graph::FileRule& files_;
  Diagnostics& diagnostics_;
  std::map<std::string, std::vector<std::string>> effects_;  ///< parameter names by path
};

const std::vector<std::string>& Editor::parameters_of_effect(const std::string& path) {
  const auto [found, is_new] = effects_.try_emplace(path);
  if (!is_new) return found->second;
  // Errors of the effect are reported when it is compiled.
  Diagnostics unheard;
  const support::Source source = graph::read_document(path, files_, unheard, {document_.source, 0, 0});
  const auto effect = source ? graph::load_document(source, files_, unheard) : std::nullopt;
  if (!effect) return found->second;
  if (const Json* parameters = find_object(effect->root, "parameters"))
    for (const Member& member : parameters->members) found->second.push_back(member.key);
  return found->second;
}

/// The objects and posts of the scene, by name.
std::vector<std::pair<std::string_view, Json*>> Editor::owners() {
  std::vector<std::pair<std::string_view, Json*>> all;
  if (Json* objects = find_object(document_.root, "objects")) {
    for (Member& member : objects->members)
      if (member.value.kind == Json::Kind::object) all.emplace_back(member.key, &member.value);
  }
  Json* posts = document_.root.find("posts");
  if (posts == nullptr || posts->kind != Json::Kind::array) return all;
  for (Json& post : posts->items) {
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
    for (const std::string& name :
         parameters_of_effect(graph::path_beside(document_.source_of(*effect)->path(), effect->string)))
      names.push_back(name);
  }
  return names;
}

void Editor::set_member(Json& object, Setting& setting) {
  const auto key_end = static_cast<uint32_t>(setting.source->text().find('='));
  const uint32_t key_begin = key_end - static_cast<uint32_t>(setting.key.size());
  Member set{std::string(setting.key), key_begin, key_end, setting.value};
  const auto found = std::ranges::find(object.members, set.key, &Member::key);
  if (found == object.members.end()) {
    object.members.push_back(std::move(set));
  } else {
    *found = std::move(set);
  }
}

Json& Editor::part(Json& object, std::string_view key, const Setting& setting) {
  if (Json* found = find_object(object, key)) return *found;
  Member made{std::string(key), 0, 0, {}};
  made.value.kind = Json::Kind::object;
  made.value.source = setting.value.source;
  made.key_end = made.value.end = static_cast<uint32_t>(setting.source->text().size());
  std::erase_if(object.members, [&](const Member& member) { return member.key == key; });
  object.members.push_back(std::move(made));
  return object.members.back().value;
}

void Editor::set_parameter(Json& object, Setting& setting) {
  if (Json* repeat = object.find("repeat")) {
    for (Json& axis : repeat->items) {
      if (Json* variations = find_object(axis, "parameters"))
        std::erase_if(variations->members, [&](const Member& member) { return member.key == setting.key; });
    }
  }
  set_member(part(object, "parameters", setting), setting);
}

bool Editor::set_named(Setting& setting) {
  const std::vector<std::string_view> parts = format::object_keys_of_scene();
  std::vector<std::string_view> names = parts;
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
  if (Json* lights = find_object(document_.root, "lights")) {
    for (Member& member : lights->members) {
      names.push_back(member.key);
      if (member.key != setting.name || member.value.kind != Json::Kind::object) continue;
      set_member(member.value, setting);
      return true;
    }
  }
  if (std::ranges::find(parts, setting.name) != parts.end()) {
    set_member(part(document_.root, setting.name, setting), setting);
    return true;
  }
  diagnostics_.report_unknown(
      Id::unknown_setting, {},
      "--set " + quote(setting.text) + ": the scene has no object, light or post " + quote(setting.name),
      setting.name, names);
  return false;
}

bool Editor::set_bare(Setting& setting) {
  const std::vector<std::string_view> scene_keys = format::plain_keys_of_scene();
  if (std::ranges::count(scene_keys, setting.key) != 0) {
    set_member(document_.root, setting);
    return true;
  }
  std::vector<std::pair<std::string_view, Json*>> having;
  std::vector<std::string_view> all_parameters = scene_keys;
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
      .suggest("name one: --set " + support::visible(std::string(having[0].first)) + "." +
               std::string(setting.text));
  return false;
}

bool Editor::apply(Setting& setting) {
  setting.value = graph::adopt(document_, setting.source, std::move(setting.value));
  return setting.name.empty() ? set_bare(setting) : set_named(setting);
}

}  // namespace

bool apply_settings(Document& document, const std::vector<std::string>& settings,
                    const graph::FileRule& files, Diagnostics& diagnostics) {
  Editor editor(document, files, diagnostics);
  for (const std::string& text : settings) {
    std::optional<Setting> setting = graph::parse_setting(text, "balls.roughness=0.3", diagnostics);
    if (!setting || !editor.apply(*setting)) return false;
  }
  return true;
}

}  // namespace isoshade::scene
