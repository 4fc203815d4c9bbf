// SPDX-License-Identifier: Apache-2.0
// A scene from its files, and `--set`: values of it replaced.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compiler/graph/document.h"
#include "compiler/graph/files.h"
#include "runtime/scene/scene.h"

namespace isoshade::scene {

/// Parses a scene with what it extends (graph::load_document), as it is at a time, in seconds (animate), and applies the
/// settings to the result. Without `time` it is the scene's own. Reports what is wrong.
std::optional<Scene> load_scene(const support::Source& source, const std::vector<std::string>& settings,
                                const graph::FileRule& files, support::Diagnostics& diagnostics,
                                std::optional<float> time = {});

/// A document of a scene, read once, for scenes at several times.
class SceneDocument {
 public:
  /// Reads the document with what it extends. Reports what is wrong with its syntax.
  static std::optional<SceneDocument> load(const support::Source& source, const std::vector<std::string>& settings,
                                           const graph::FileRule& files, support::Diagnostics& diagnostics);
  /// Whether scenes at different times differ in more than their `time`.
  bool is_animated() const;
  /// What load_scene() makes of the document.
  std::optional<Scene> at(std::optional<float> time, support::Diagnostics& diagnostics) const;

 private:
  SceneDocument(graph::Document document, std::vector<std::string> settings, graph::FileRule files)
      : document_(std::move(document)), settings_(std::move(settings)), files_(std::move(files)) {}

  graph::Document document_;
  std::vector<std::string> settings_;
  graph::FileRule files_;
};

/// Writes values into a scene document, one setting after the other:
///
///     object.parameter=value   a parameter of an object's effect, for all copies in its grid
///     post.parameter=value     a parameter of a post
///     parameter=value          the same, where only one object or post has a parameter of that name
///     light.key=value          "sun.intensity=2"
///     camera.key=value         "camera.fov=30", and so output.key
///     key=value                a key of the scene with a plain value, such as size
///
/// A path for a parameter of type filename is relative to the working directory, and may lead anywhere.
///
/// Values are those of graph::parse_setting(). parse_scene checks whether they fit; its reports show the setting. Reports settings that are malformed, or that name nothing or
/// more than one thing, and then returns false.
bool apply_settings(graph::Document& document, const std::vector<std::string>& settings,
                    const graph::FileRule& files, support::Diagnostics& diagnostics);

}  // namespace isoshade::scene
