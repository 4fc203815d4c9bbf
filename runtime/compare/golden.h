// SPDX-License-Identifier: Apache-2.0
// Golden images: the recorded hashes of scenes, by the scene's path from the file and the precision tier.
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

/// By scene, then by tier.
using Goldens = std::map<std::string, std::map<std::string, Golden>>;

/// How a scene is named in the file: by its path from the folder of that file, so that it does not matter where
/// the command is run.
std::string golden_key(const std::string& scene_path, const std::string& golden_path);

/// Reports a file that is missing or is no file of goldens.
std::optional<Goldens> read_goldens(const std::string& path, support::Diagnostics& diagnostics);
/// Puts these into the file, or makes it; what else it holds by then stays, also what another process is putting there:
/// they wait for each other, by a lock on the folder. Sorted and indented, so that a change shows as one line. The file
/// is replaced whole or not at all.
bool update_goldens(const std::string& path, const Goldens& changes, support::Diagnostics& diagnostics);
std::string goldens_text(const Goldens& goldens);

/// Empty if the scene is recorded with just these hashes; otherwise what is wrong, as one line.
std::string golden_mismatch(const Goldens& goldens, const std::string& key, const std::string& tier,
                            const Golden& found);

}  // namespace isoshade::compare
