// SPDX-License-Identifier: Apache-2.0
// `--set`: some values of a scene document replaced.
#pragma once

#include <string>
#include <vector>

#include "compiler/graph/document.h"

namespace isoshade::scene {

/// Writes values into a scene document, each setting upon the one before:
///
///     object.parameter=value   a parameter of an object's effect, for all copies in its grid
///     post.parameter=value     a parameter of a post
///     parameter=value          the same, where only one object or post has a parameter of that name
///     light.key=value          "sun.intensity=2"
///     camera.key=value         "camera.fov=30", and so output.key
///     key=value                background, size or samples of the scene
///
/// A path for a parameter of type filename counts from the working directory, and may lie anywhere.
///
/// A value is JSON, or numbers with commas between them ("1,0.5,0"), or a plain word. Whether it fits is found when the
/// document is read by parse_scene; what that reports of a value shows the setting. Reports settings that are malformed
/// or that name nothing, or more than one thing, and then returns false.
bool apply_settings(graph::Document& document, const std::vector<std::string>& settings,
                    support::Diagnostics& diagnostics);

}  // namespace isoshade::scene
