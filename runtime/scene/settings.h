// SPDX-License-Identifier: Apache-2.0
// `--set`: a scene document with some of its values replaced.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiler/graph/document.h"

namespace isoshade::scene {

/// Writes values into a scene document, each setting upon the one before, as if its author had written them:
///
///     object.parameter=value   a parameter of an object's effect, for all copies in its grid
///     post.parameter=value     a parameter of a post
///     parameter=value          the same, where only one object or post has a parameter of that name
///     light.key=value          "sun.intensity=2"
///     camera.key=value         "camera.fov=30", and so output.key
///     key=value                background or size of the scene
///
/// A path for a parameter of type filename counts from the working directory.
///
/// A value is JSON, or numbers with commas between them ("1,0.5,0"), or a plain word. Whether it fits is
/// found when the result is read by parse_scene; what it then reports shows the line with the new value.
/// Lines keep their numbers. Reports settings that are malformed or that name nothing, or more than one
/// thing.
std::optional<graph::Document> apply_settings(const graph::Document& document,
                                              const std::vector<std::string>& settings,
                                              support::Diagnostics& diagnostics);

}  // namespace isoshade::scene
