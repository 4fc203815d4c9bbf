// SPDX-License-Identifier: Apache-2.0
// Where the samples of a tile are drawn.
#pragma once

#include <cstddef>
#include <cstring>

namespace isoshade::cpu {

/// Begins at the tile's first sample, and ends with the window that is drawn.
struct Canvas {
  float* color = nullptr;  ///< null if the target has none
  float* depth = nullptr;
  size_t stride = 0;  ///< samples from a row to the next
  int width = 0, height = 0;

  size_t index(int x, int y) const { return static_cast<size_t>(y) * stride + static_cast<size_t>(x); }
};

/// Writes one color to `count` samples side by side.
inline void fill_color(const float (&color)[4], int count, float* to) {
  for (int i = 0; i < count; ++i) std::memcpy(to + 4 * i, color, sizeof color);
}

}  // namespace isoshade::cpu
