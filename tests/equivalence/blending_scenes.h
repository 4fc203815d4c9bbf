// SPDX-License-Identifier: Apache-2.0
// Effects that are blended in every way, and planes of them.
#pragma once

#include <string>

#include "tests/equivalence/scene_folder.h"

namespace isoshade::equivalence {

/// An effect of one pass that is blended so, with further keys.
inline std::string pane(const std::string& name, const std::string& blend, const std::string& keys = "") {
  return R"({"isoshade": 1, "effect": ")" + name + R"(",
  "parameters": {"tint": {"type": "color4", "value": [0.5, 0.25, 1, 0.25]}},
  "passes": [{"name": "base", "cull": "none", "blend": ")" + blend + R"(", "color": "tint")" + keys + "}]}";
}

/// Files of effects that are called as they are blended, `over.json`; with depth, `over_deep.json`.
inline void write_panes(const isoshade::testing::TemporaryFolder& folder) {
  for (const std::string blend : {"over", "add", "multiply", "premultiplied"}) {
    folder.write(blend + ".json", pane(blend, blend));
    folder.write(blend + "_deep.json", pane(blend, blend, R"(, "depth_write": "on")"));
  }
}

inline const std::string pane_camera = R"("camera": {"position": [1, 1.2, 4], "target": [0, 0, 0], "fov": 40},
  "background": [0.1, 0.2, 0.3, 0.5])";

/// Planes that overlap in a spiral, in the order of the scene.
inline std::string forty_layers() {
  std::string objects;
  const char* const modes[] = {"over", "add", "multiply", "premultiplied", "over_deep"};
  for (int i = 0; i < 40; ++i)
    objects += (i == 0 ? "" : ", ") + (R"("o)" + std::to_string(i)) +
               R"(": {"mesh": {"type": "plane", "size": [3, 2]}, "effect": ")" + modes[i % 5] +
               R"(.json", "transform": {"rotate": [)" + std::to_string(70 + i) + ", " + std::to_string(9 * i) + R"(, 0],
               "translate": [)" + std::to_string(0.02 * i - 0.4) + ", 0, " + std::to_string(0.11 * (i * 7 % 40) - 2) + R"(]},
               "parameters": {"tint": [)" + std::to_string(0.025 * i) + ", " + std::to_string(1 - 0.02 * i) +
               R"(, 0.5, 0.)" + std::to_string(1 + i % 7) + "]}}";
  return pane_camera + R"(, "objects": {)" + objects + "}";
}

}  // namespace isoshade::equivalence
