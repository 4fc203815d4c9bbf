// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/load.h"

#include "compiler/graph/extend.h"
#include "runtime/scene/animate.h"
#include "runtime/scene/format.h"

namespace isoshade::scene {

static_assert(format::scene::extends.name == graph::extends_key);

namespace {

/// The scene of a document at a time, with the settings, which win over animations.
std::optional<Scene> scene_at(graph::Document document, double time, const std::vector<std::string>& settings,
                              const graph::FileRule& files, support::Diagnostics& diagnostics) {
  if (!animate(document, time, diagnostics) || !apply_settings(document, settings, files, diagnostics))
    return std::nullopt;
  return parse_scene(document, diagnostics);
}

/// A number of the scene that does not move: with the settings, the document's, or the default.
float resting_number(const graph::Document& document, std::string_view key, float fallback) {
  const graph::Json* json = document.root.find(key);
  return json != nullptr && json->kind == graph::Json::Kind::number ? document.to_float(*json) : fallback;
}

}  // namespace

std::optional<Scene> load_scene(const support::Source& source, const std::vector<std::string>& settings,
                                const graph::FileRule& files, support::Diagnostics& diagnostics, std::optional<float> time) {
  auto document = graph::load_document(source, files, diagnostics);
  if (!document) return std::nullopt;
  if (document->root.find(format::scene::animate.name) == nullptr) {
    auto scene = scene_at(*std::move(document), 0, settings, files, diagnostics);
    if (scene && time) scene->time = *time;
    return scene;
  }
  graph::Document set = *document;
  support::Diagnostics unheard;  // the same is reported below
  apply_settings(set, settings, files, unheard);
  const float now = time.value_or(resting_number(set, format::scene::time.name, Scene{}.time));
  auto scene = scene_at(*document, static_cast<double>(now), settings, files, diagnostics);
  if (!scene) return std::nullopt;
  scene->time = now;
  // Where there was no such scene yet, nothing has moved.
  const double before = static_cast<double>(now) - 1 / static_cast<double>(scene->frames_per_second);
  auto earlier = scene_at(*std::move(document), before, settings, files, unheard);
  scene->before = std::make_shared<Scene>(earlier ? *std::move(earlier) : *scene);
  scene->before->time = static_cast<float>(before);
  return scene;
}

}  // namespace isoshade::scene
