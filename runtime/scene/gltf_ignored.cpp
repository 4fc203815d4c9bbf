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

bool is_blend(const Json& value) { return value.string == "BLEND"; }
bool is_not_zero(const Json& value) { return value.number != 0; }
/// NEAREST, NEAREST_MIPMAP_NEAREST, NEAREST_MIPMAP_LINEAR.
bool is_nearest(const Json& value) {
  return value.number == 9728 || value.number == 9984 || value.number == 9986;
}
bool is_not_repeat(const Json& value) { return value.number != 10497; }
bool is_point_or_line(const Json& value) { return value.number < 4; }
bool is_given(const Json& value) { return value.kind != Json::Kind::array || !value.items.empty(); }

/// A key of the glTF 2.0 specification, and which of its values request a feature that is not read.
struct Feature {
  std::string_view key;
  std::string_view name;
  bool (*asks)(const Json& value);
};
constexpr Feature features[] = {
    {"alphaMode", "the alpha mode BLEND", is_blend},
    {"texCoord", "texture coordinates beyond the first set", is_not_zero},
    {"magFilter", "nearest filtering of samplers", is_nearest},
    {"minFilter", "nearest filtering of samplers", is_nearest},
    {"wrapS", "wrap modes of samplers other than REPEAT", is_not_repeat},
    {"wrapT", "wrap modes of samplers other than REPEAT", is_not_repeat},
    {"mode", "points and lines", is_point_or_line},
    {"skin", "skins", is_given},
    {"targets", "morph targets", is_given},
    {"animations", "animations", is_given},
};

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
        for (const graph::Member& extension : member.value.members)
          warn("the extension " + quote(extension.key), extension.value);
        continue;
      }
      for (const Feature& feature : features)
        if (member.key == feature.key && feature.asks(member.value))
          warn(std::string(feature.name), member.value);
      walk(member.value);
    }
  }

 private:
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
  Warner(document, path, where, diagnostics).walk(document.root);
}

}  // namespace isoshade::scene
