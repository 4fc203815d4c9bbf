// SPDX-License-Identifier: Apache-2.0
// The post chain of a scene.
#include <algorithm>

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

/// The image that `name` means to the next post.
int find_image(const std::vector<Post>& before, const std::string& name) {
  for (size_t i = 0; i < before.size(); ++i)
    if (before[i].name == name) return static_cast<int>(i);
  if (name == scene_image_name) return scene_image;
  return name == motion_image_name ? motion_image : no_image;
}

void parse_inputs(const Document& document, const Json& json, const std::vector<Post>& before, Post& post,
                  Diagnostics& diagnostics) {
  for (const Member& member : json.members) {
    const support::Span where = document.span(member.value);
    if (member.value.kind != Json::Kind::string) {
      diagnostics.report(Id::wrong_type, where,
                         "an input of post " + quote(post.name) + " is the name of an image, not " +
                             std::string(kind_name(member.value.kind)));
      continue;
    }
    const int image = find_image(before, member.value.string);
    if (image == no_image) {
      std::vector<std::string_view> names{scene_image_name, motion_image_name};
      for (const Post& other : before) names.push_back(other.name);
      diagnostics
          .report_unknown(Id::unknown_image, where,
                          "no post before " + quote(post.name) + " is called " + quote(member.value.string),
                          member.value.string, names)
          .note("a post reads the images of posts before it, \"scene\" and \"motion\"");
      continue;
    }
    post.inputs.push_back({member.key, image, document.key_span(member), where});
  }
}

}  // namespace

Post parse_post(const Document& document, const Json& json, const std::vector<Post>& before,
                Diagnostics& diagnostics) {
  namespace key = format::post;
  Post post;
  format::Reader<format::Object::post> reader(document, json, "a post of the scene", diagnostics);
  post.name = reader.read(key::name);
  post.name_where = reader.where(key::name);
  const Json* name = json.find(key::name.name);
  if (name != nullptr && name->kind == Json::Kind::string && name->string.empty())
    diagnostics.report(Id::bad_id, post.name_where, "a post needs a name that is not empty");
  post.effect = reader.read(key::effect);
  post.effect_where = reader.where(key::effect);
  if (const Json* parameters = reader.read(key::parameters))
    post.parameters = parse_parameters(document, *parameters, diagnostics);
  if (const Json* inputs = reader.read(key::inputs))
    parse_inputs(document, *inputs, before, post, diagnostics);
  post.size = reader.read(key::size);
  post.size_where = reader.has(key::size) ? reader.where(key::size) : post.name_where;
  reader.finish();
  return post;
}

}  // namespace isoshade::scene
