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

bool has_animations(const graph::Document& document) {
  return document.root.find(format::scene::animate.name) != nullptr;
}

std::optional<Scene> scene_of(graph::Document document, const std::vector<std::string>& settings,
                              const graph::FileRule& files, support::Diagnostics& diagnostics, std::optional<float> time) {
  if (!has_animations(document)) {
    auto scene = scene_at(std::move(document), 0, settings, files, diagnostics);
    if (scene && time) scene->time = *time;
    return scene;
  }
  graph::Document set = document;
  support::Diagnostics unheard;  // the same is reported below
  apply_settings(set, settings, files, unheard);
  const float now = time.value_or(resting_number(set, format::scene::time.name, Scene{}.time));
  auto scene = scene_at(document, static_cast<double>(now), settings, files, diagnostics);
  if (!scene) return std::nullopt;
  scene->time = now;
  // Where there was no such scene yet, nothing has moved.
  const double before = static_cast<double>(now) - 1 / static_cast<double>(scene->frames_per_second);
  auto earlier = scene_at(std::move(document), before, settings, files, unheard);
  scene->before = std::make_shared<Scene>(earlier ? *std::move(earlier) : *scene);
  scene->before->time = static_cast<float>(before);
  return scene;
}

}  // namespace

std::optional<Scene> load_scene(const support::Source& source, const std::vector<std::string>& settings,
                                const graph::FileRule& files, support::Diagnostics& diagnostics, std::optional<float> time) {
  auto document = graph::load_document(source, files, diagnostics);
  return document ? scene_of(*std::move(document), settings, files, diagnostics, time) : std::nullopt;
}

std::optional<SceneDocument> SceneDocument::load(const support::Source& source, const std::vector<std::string>& settings,
                                                 const graph::FileRule& files, support::Diagnostics& diagnostics) {
  auto document = graph::load_document(source, files, diagnostics);
  return document ? std::optional(SceneDocument(*std::move(document), settings, files)) : std::nullopt;
}

bool SceneDocument::is_animated() const { return has_animations(document_); }

std::optional<Scene> SceneDocument::at(std::optional<float> time, support::Diagnostics& diagnostics) const {
  return scene_of(document_, settings_, files_, diagnostics, time);
}

}  // namespace isoshade::scene
