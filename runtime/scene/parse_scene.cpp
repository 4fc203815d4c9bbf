// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <unordered_map>

#include "compiler/support/visible.h"
#include "runtime/scene/animate.h"
#include "runtime/scene/parse_parts.h"

namespace isoshade::scene {

using graph::Document;
using graph::Json;
using graph::Member;
using support::Diagnostics;
using support::Id;
using support::quote;
using SceneReader = format::Reader<format::Object::scene>;

namespace {

/// Objects, lights and posts share their names, so that a setting means one thing.
class Names {
 public:
  Names(const Document& document, Diagnostics& diagnostics)
      : document_(document), diagnostics_(diagnostics) {}

  void enter(const Member& member, std::string_view what) {
    enter(member.key, document_.key_span(member), what);
  }

  void enter(const std::string& name, const support::Span& where, std::string_view what) {
    // Settings call parts of the scene by these names.
    const std::vector<std::string_view> parts = format::object_keys_of_scene();
    const bool reserved = std::ranges::find(parts, name) != parts.end();
    if (!graph::is_id(name) || reserved) {
      diagnostics_.report(Id::bad_id, where, quote(name) + " cannot name " + std::string(what))
          .note(reserved ? "it names a part of the scene itself"
                         : "names are letters, digits and '_', at most 128, and begin with no digit");
    }
    const auto [found, is_new] = names_.emplace(name, Named{where, std::string(what)});
    if (is_new) return;
    const std::string& other = found->second.what;
    diagnostics_
        .report(Id::duplicate_name, where,
                other == what ? "two posts are called " + quote(name)
                              : other + " and " + std::string(what) + " are both called " + quote(name))
        .note(found->second.where, "also here");
  }

 private:
  const Document& document_;
  Diagnostics& diagnostics_;
  struct Named {
    support::Span where;
    std::string what;
  };
  std::unordered_map<std::string, Named> names_;
};

int parse_samples(SceneReader& reader, Diagnostics& diagnostics) {
  constexpr auto& key = format::scene::samples;
  const int64_t samples = reader.read(key);
  if (std::ranges::find(key.type.values, samples) != key.type.values.end()) return static_cast<int>(samples);
  diagnostics
      .report(Id::out_of_range, reader.where(key),
              "a pixel has 1, 4 or 16 samples, not " + std::to_string(samples))
      .note("they form 1, 2 or 4 rows of as many");
  return key.type.fallback;
}

Output parse_output(const Document& document, const Json& json, Diagnostics& diagnostics) {
  Output output;
  format::Reader<format::Object::output> reader(document, json, "the output", diagnostics);
  output.encoding = static_cast<Encoding>(reader.read(format::output::encoding));
  output.exposure = reader.read(format::output::exposure);
  reader.finish();
  return output;
}

void parse_lights(const Document& document, const Json& json, Names& names, Scene& scene,
                  Diagnostics& diagnostics) {
  if (json.members.size() > max_lights) {
    diagnostics.report(Id::too_large, document.span(json),
                       "a scene has at most " + std::to_string(max_lights) + " lights");
    return;
  }
  for (const Member& member : json.members) {
    names.enter(member, "a light");
    scene.lights.push_back(parse_light(document, member, diagnostics));
  }
}

void parse_objects(const Document& document, const Json& json, Names& names, Scene& scene,
                   Diagnostics& diagnostics) {
  int64_t total = 0;
  for (const Member& member : json.members) {
    names.enter(member, "an object");
    scene.objects.push_back(parse_object(document, member, diagnostics));
    if (total > max_instances) continue;  // reported already
    total += instance_count(scene.objects.back());
    if (total <= max_instances) continue;
    diagnostics
        .report(Id::too_large, document.key_span(member),
                "with object " + quote(member.key) + " the scene has " + std::to_string(total) + " copies")
        .note("at most " + std::to_string(max_instances) + " are drawn");
  }
}

void parse_posts(const Document& document, const Json& json, Names& names, Scene& scene,
                 Diagnostics& diagnostics) {
  if (json.items.size() > max_posts) {
    diagnostics.report(Id::too_large, document.span(json),
                       "a scene has at most " + std::to_string(max_posts) + " posts");
    return;
  }
  for (const Json& item : json.items) {
    Post post = parse_post(document, item, scene.posts, diagnostics);
    if (post.name == scene_image_name) {
      diagnostics.report(Id::bad_id, post.name_where, "\"scene\" cannot name a post")
          .note("it means the rendered image");
    } else if (!post.name.empty()) {
      names.enter(post.name, post.name_where, "a post");
    }
    scene.posts.push_back(std::move(post));
  }
}

}  // namespace

std::optional<Scene> parse_scene(const Document& document, Diagnostics& diagnostics) {
  const size_t errors_before = diagnostics.error_count();
  const auto kind = graph::document_kind(document, diagnostics);
  if (!kind) return std::nullopt;
  if (*kind != graph::DocumentKind::scene) {
    diagnostics.report(
        Id::wrong_kind, document.span(document.root),
        "a scene is needed here, not a document of the kind " + std::string(graph::kind_name(*kind)));
    return std::nullopt;
  }
  SceneReader reader(document, document.root, "a scene", diagnostics);
  reader.skip_document_keys();
  reader.skip(format::scene::extends);
  if (const Json* animations = reader.read(format::scene::animate))
    for (const Member& member : animations->members) parse_animation(document, member, diagnostics);

  Scene scene;
  scene.animated = animated_parameters(document);
  scene.source = document.source;
  scene.name = reader.read(format::scene::scene);
  Names names(document, diagnostics);
  const auto size = reader.read(format::scene::size);
  scene.width = size[0];
  scene.height = size[1];
  scene.samples = parse_samples(reader, diagnostics);
  scene.samples_where = reader.where(format::scene::samples);
  scene.time = reader.read(format::scene::time);
  scene.frames_per_second = reader.read(format::scene::frames_per_second);
  if (const Json* camera = reader.read(format::scene::camera))
    scene.camera = parse_camera(document, *camera, diagnostics);
  if (const Json* lights = reader.read(format::scene::lights))
    parse_lights(document, *lights, names, scene, diagnostics);
  if (const Json* environment = reader.read(format::scene::environment))
    scene.environment = parse_environment(document, *environment, diagnostics);
  scene.background = reader.read(format::scene::background);
  if (const Json* objects = reader.read(format::scene::objects))
    parse_objects(document, *objects, names, scene, diagnostics);
  scene.sort = static_cast<Sort>(reader.read(format::scene::sort));
  if (const Json* output = reader.read(format::scene::output))
    scene.output = parse_output(document, *output, diagnostics);
  if (const Json* posts = reader.read(format::scene::posts))
    parse_posts(document, *posts, names, scene, diagnostics);
  reader.finish();
  if (diagnostics.error_count() != errors_before) return std::nullopt;
  return scene;
}

}  // namespace isoshade::scene
