// SPDX-License-Identifier: Apache-2.0
#include "backends/backend.h"

namespace isoshade::backends {

void Image::resize(int w, int h) {
  width = w;
  height = h;
  const size_t pixels = static_cast<size_t>(w) * static_cast<size_t>(h);
  rgba.assign(4 * pixels, 0.0f);
  depth.assign(pixels, 0.0f);
}

}  // namespace isoshade::backends
