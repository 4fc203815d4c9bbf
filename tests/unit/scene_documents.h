// SPDX-License-Identifier: Apache-2.0
// Scenes from text, for tests.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compiler/graph/document.h"
#include "runtime/scene/load.h"
#include "runtime/scene/scene.h"

namespace isoshade::testing {

inline std::optional<graph::Document> document_of(const std::string& text, support::Diagnostics& diagnostics,
                                                  const std::string& path = "scenes/test.json") {
  return graph::parse_document(std::make_shared<support::SourceFile>(path, text), diagnostics);
}

/// The members of a scene, around what every scene needs. Without a camera among them it has a usual one.
inline std::string scene_text(const std::string& members) {
  const bool has_camera = members.find("\"camera\"") != std::string::npos;
  const std::string camera = R"("camera": {"position": [0, 0, 5], "target": [0, 0, 0]})";
  return R"({"isoshade": 1, "scene": "test")" + std::string(has_camera ? "" : ",\n" + camera) +
         (members.empty() ? "" : ",\n" + members) + "}";
}

struct ParsedScene {
  std::optional<scene::Scene> scene;
  support::Diagnostics diagnostics;

  /// "id: message" of the first error; empty if there is none.
  std::string first_error() const {
    if (diagnostics.all().empty()) return {};
    const support::Diagnostic& first = diagnostics.all().front();
    return std::string(support::id_text(first.id)) + ": " + first.message;
  }
  bool fails_with(const std::string& part) const {
    return !scene && first_error().find(part) != std::string::npos;
  }
};

inline ParsedScene parse_text(const std::string& text, const std::vector<std::string>& settings = {}) {
  ParsedScene parsed;
  std::optional<graph::Document> document = document_of(text, parsed.diagnostics);
  if (document && scene::apply_settings(*document, settings, {}, parsed.diagnostics))
    parsed.scene = scene::parse_scene(*document, parsed.diagnostics);
  return parsed;
}

inline ParsedScene parse_members(const std::string& members, const std::vector<std::string>& settings = {}) {
  return parse_text(scene_text(members), settings);
}

}  // namespace isoshade::testing
