// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <unordered_map>

#include "compiler/support/visible.h"
#include "runtime/scene/parse_parts.h"

namespace isoshade::scene {

using graph::Document;
using graph::Json;
using graph::Member;
using graph::ObjectReader;
using support::Diagnostics;
using support::Id;
using support::quote;
using Need = ObjectReader::Need;

namespace {

/// Names that settings give to the scene's own parts.
constexpr std::string_view reserved_names[] = {"camera", "output"};

/// Objects, lights and posts share their names, so that a setting means one thing.
class Names {
 public:
  Names(const Document& document, Diagnostics& diagnostics)
      : document_(document), diagnostics_(diagnostics) {}

  void enter(const Member& member, std::string_view what) {
    enter(member.key, document_.key_span(member), what);
  }

  void enter(const std::string& name, const support::Span& where, std::string_view what) {
    const bool reserved =
        std::find(std::begin(reserved_names), std::end(reserved_names), name) != std::end(reserved_names);
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

void parse_size(const Document& document, ObjectReader& reader, Scene& scene, Diagnostics& diagnostics) {
  const Json* size = reader.array("size", Need::optional);
  if (size == nullptr) return;
  const bool integers = size->items.size() == 2 && std::ranges::all_of(size->items, graph::is_whole);
  if (!integers) {
    diagnostics.report(Id::wrong_type, document.span(*size), "\"size\" of a scene is an array of 2 integers");
    return;
  }
  const auto side = [&](const Json& json) {
    return reader.check_range("size", json, {1, max_size}) ? static_cast<int>(document.to_integer(json)) : 1;
  };
  scene.width = side(size->items[0]);
  scene.height = side(size->items[1]);
}

void parse_samples(const Document& document, ObjectReader& reader, Scene& scene, Diagnostics& diagnostics) {
  const Json* json = document.root.find("samples");
  const int64_t samples = reader.integer("samples", coordinates, 1);
  if (json == nullptr) return;
  scene.samples_where = document.span(*json);
  scene.samples = static_cast<int>(samples);
  if (samples == 1 || samples == 4 || samples == 16) return;
  diagnostics
      .report(Id::out_of_range, scene.samples_where,
              "a pixel has 1, 4 or 16 samples, not " + std::to_string(samples))
      .note("they lie in one row, two or four");
}

Output parse_output(const Document& document, const Json& json, Diagnostics& diagnostics) {
  Output output;
  ObjectReader reader(document, json, "the output", diagnostics);
  output.encoding = static_cast<Encoding>(reader.choice("encoding", {"srgb", "linear"}, 0));
  output.exposure = reader.number("exposure", brightness, 1.0f);
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
          .note("it is the image that was drawn");
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
  ObjectReader reader(document, document.root, "a scene", diagnostics);
  if (*kind != graph::DocumentKind::scene) {
    diagnostics.report(
        Id::wrong_kind, document.span(document.root),
        "a scene is needed here, not a document of the kind " + std::string(graph::kind_name(*kind)));
    return std::nullopt;
  }
  // "extends" is done already (load.h); here it is known for those who misspell it.
  for (const std::string_view key : {"$schema", "isoshade", "doc", "extends"}) reader.ignore(key);

  Scene scene;
  scene.source = document.source;
  scene.name = reader.string("scene");
  Names names(document, diagnostics);
  parse_size(document, reader, scene, diagnostics);
  parse_samples(document, reader, scene, diagnostics);
  scene.time = reader.number("time", coordinates, 0.0f);
  if (const Json* camera = reader.object("camera"))
    scene.camera = parse_camera(document, *camera, diagnostics);
  if (const Json* lights = reader.object("lights", Need::optional))
    parse_lights(document, *lights, names, scene, diagnostics);
  scene.background = reader.numbers<4>("background", brightness, {{0, 0, 0, 1}});
  if (const Json* objects = reader.object("objects", Need::optional))
    parse_objects(document, *objects, names, scene, diagnostics);
  if (const Json* output = reader.object("output", Need::optional))
    scene.output = parse_output(document, *output, diagnostics);
  // Under another key than the one that says what kind a document is.
  if (const Json* posts = reader.array("posts", Need::optional))
    parse_posts(document, *posts, names, scene, diagnostics);
  reader.finish();
  if (diagnostics.error_count() != errors_before) return std::nullopt;
  return scene;
}

}  // namespace isoshade::scene
