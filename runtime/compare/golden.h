// SPDX-License-Identifier: Apache-2.0
// Golden images: recorded hashes, by the path of the scene (relative to the golden file) and the precision tier.
//
//   {
//     "../../graphs/scenes/material_balls.json": {
//       "default": {"size": [1280, 720], "image": "...", "encoded": "..."}
//     }
//   }
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "compiler/support/diagnostics.h"

namespace isoshade::compare {

struct Golden {
  int width = 0, height = 0;
  std::string image;    ///< image_hash()
  std::string encoded;  ///< encoded_hash()
  bool operator==(const Golden&) const = default;
};

/// Keys: scene, then tier.
using Goldens = std::map<std::string, std::map<std::string, Golden>>;

/// The key of a scene: its path relative to the folder of the golden file, whatever the working directory.
std::string golden_key(const std::string& scene_path, const std::string& golden_path);

/// Reports a missing or malformed file.
std::optional<Goldens> read_goldens(const std::string& path, support::Diagnostics& diagnostics);
/// Writes `changes` to the file, creating it if needed, and keeps all other entries. A lock on the folder keeps concurrent
/// updates from losing entries. The file is replaced atomically; it is sorted and indented, so that diffs are small.
bool update_goldens(const std::string& path, const Goldens& changes, support::Diagnostics& diagnostics);
std::string goldens_text(const Goldens& goldens);

/// Empty if the recorded hashes of the scene are the same; otherwise one line that says what differs.
std::string golden_mismatch(const Goldens& goldens, const std::string& key, const std::string& tier,
                            const Golden& found);

}  // namespace isoshade::compare
