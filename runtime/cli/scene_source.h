// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/scene/scene.h"

namespace isoshade::cli {

/// Reads a scene document and writes the settings into it; reports what is wrong. `mesh`, if not empty, is a
/// glTF file that takes the place of the mesh of the object that has one, or of the only object, centred and
/// scaled to unit size.
std::optional<scene::Scene> load_scene(const std::string& path, const std::vector<std::string>& settings,
                                       const std::string& mesh, support::Diagnostics& diagnostics);

}  // namespace isoshade::cli
