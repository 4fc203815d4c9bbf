// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "runtime/cli/arguments.h"
#include "runtime/scene/scene.h"

namespace isoshade::cli {

/// Reads a scene and makes the changes; reports what is wrong. A glTF file takes the place of the mesh of
/// the object that has one, or of the only object, centred and scaled to unit size.
std::optional<scene::Scene> load_scene(const std::string& path, const SceneChanges& changes,
                                       const Common& common, support::Diagnostics& diagnostics);

}  // namespace isoshade::cli
