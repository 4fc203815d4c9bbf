// SPDX-License-Identifier: Apache-2.0
#include "backends/backend.h"

namespace isoshade::backends {

void Image::resize(int w, int h) {
  width = w;
  height = h;
  const size_t pixels = static_cast<size_t>(w) * static_cast<size_t>(h);
  rgba.resize(4 * pixels);
  depth.resize(pixels);
}

}  // namespace isoshade::backends
