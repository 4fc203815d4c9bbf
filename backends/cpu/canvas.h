// SPDX-License-Identifier: Apache-2.0
// Where the samples of a tile are drawn.
#pragma once

#include <cstddef>

namespace isoshade::cpu {

/// Begins at the tile's first sample, and ends with the window that is drawn.
struct Canvas {
  float* color = nullptr;  ///< null if the target has none
  float* depth = nullptr;
  size_t stride = 0;  ///< samples from a row to the next
  int width = 0, height = 0;

  size_t index(int x, int y) const { return static_cast<size_t>(y) * stride + static_cast<size_t>(x); }
};

}  // namespace isoshade::cpu
