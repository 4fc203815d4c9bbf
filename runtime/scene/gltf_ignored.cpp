// SPDX-License-Identifier: Apache-2.0
// Warnings about features of a glTF file that isoshade does not read.
#include <iterator>
#include <set>

#include "compiler/support/visible.h"
#include "runtime/scene/gltf_parts.h"

namespace isoshade::scene {

using graph::Json;
using support::quote;

namespace {

bool is_beyond_1(const Json& value) { return value.number > 1; }
bool is_point_or_line(const Json& value) { return value.number < 4; }
bool is_given(const Json& value) { return value.kind != Json::Kind::array || !value.items.empty(); }

/// A key of the glTF 2.0 specification, and which of its values request a feature that is not read.
struct Feature {
  std::string_view key;
  std::string_view name;
  bool (*asks)(const Json& value);
};
constexpr std::string_view texcoords = "texture coordinates beyond the second set", skins = "skins";
constexpr Feature features[] = {
    {"texCoord", texcoords, is_beyond_1},
    {"mode", "points and lines", is_point_or_line},
    {"skin", skins, is_given},
    {"targets", "morph targets", is_given},
    {"animations", "animations", is_given},
    {"cameras", "cameras", is_given},
};

/// What a vertex attribute belongs to, if it is not read. Those whose names begin with an underscore are a program's own
/// and show nothing.
std::string_view ignored_attribute(std::string_view name) {
  const auto is_set = [&](std::string_view stem) { return name.starts_with(stem); };
  if (is_set("TEXCOORD_")) return name == "TEXCOORD_0" || name == "TEXCOORD_1" ? "" : texcoords;
  if (is_set("COLOR_")) return name == "COLOR_0" ? "" : "vertex colours beyond the first set";
  return is_set("JOINTS_") || is_set("WEIGHTS_") ? skins : "";
}

class Warner {
 public:
  Warner(const graph::Document& document, const std::string& path, const support::Span& where,
         support::Diagnostics& diagnostics)
      : document_(document), path_(path), where_(where), diagnostics_(diagnostics) {}

  void walk(const Json& value) {
    for (const Json& item : value.items) walk(item);
    for (const graph::Member& member : value.members) {
      if (member.key == "extras") continue;
      if (member.key == "extensions") {
        for (const graph::Member& extension : member.value.members) {
          if (is_read_extension(extension.key))
            walk(extension.value);
          else
            warn_extension(extension.key, extension.value);
        }
        continue;
      }
      if (member.key == "attributes")
        for (const graph::Member& attribute : member.value.members)
          if (const std::string_view name = ignored_attribute(attribute.key); !name.empty())
            warn(std::string(name), attribute.value);
      for (const Feature& feature : features)
        if (member.key == feature.key && feature.asks(member.value))
          warn(std::string(feature.name), member.value);
      walk(member.value);
    }
  }

  /// Those that a file only lists.
  void walk_list(const Json& names) {
    for (const Json& name : names.items)
      if (!is_read_extension(name.string)) warn_extension(name.string, name);
  }

 private:
  void warn_extension(const std::string& name, const Json& value) { warn("the extension " + quote(name), value); }
  void warn(const std::string& name, const Json& value) {
    if (!warned_.insert(name).second) return;
    diagnostics_.report(support::Id::ignored_feature, where_,
                        quote(path_) + " uses " + name + ", which isoshade does not read; first at " +
                            quote(graph::pointer_at(document_, value.begin)));
  }

  const graph::Document& document_;
  const std::string& path_;
  const support::Span& where_;
  support::Diagnostics& diagnostics_;
  std::set<std::string> warned_;
};

}  // namespace

void warn_ignored(const graph::Document& document, const std::string& path, const support::Span& where,
                  support::Diagnostics& diagnostics) {
  Warner warner(document, path, where, diagnostics);
  warner.walk(document.root);
  if (const Json* used = document.root.find("extensionsUsed")) warner.walk_list(*used);
}

}  // namespace isoshade::scene
