// SPDX-License-Identifier: Apache-2.0
// A scene from its files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiler/graph/files.h"
#include "runtime/scene/scene.h"

namespace isoshade::scene {

/// How many scenes may extend each other in a row.
inline constexpr size_t max_bases = 16;

/// Parses a scene, merges it into the one that it extends ("extends": "path beside it"; graph::merge), and that into
/// the one that it extends, and writes the settings (settings.h) into what comes of it. Reports what is wrong.
std::optional<Scene> load_scene(const support::Source& source, const std::vector<std::string>& settings,
                                const graph::FileRule& files, support::Diagnostics& diagnostics);

}  // namespace isoshade::scene
