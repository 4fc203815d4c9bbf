// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/scene/scene.h"

namespace isoshade::cli {

/// Reads a scene document and writes the settings into it; reports what is wrong.
std::optional<scene::Scene> load_scene(const std::string& path, const std::vector<std::string>& settings,
                                       support::Diagnostics& diagnostics);

}  // namespace isoshade::cli
