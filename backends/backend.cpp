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

bool Backend::draw(const Frame& frame, std::span<const float> vertices, std::span<const int32_t> triangles,
                   Image& image, support::Diagnostics& diagnostics) {
  const std::unique_ptr<Drawing> drawing = begin(frame, vertices, diagnostics);
  return drawing != nullptr &&
         drawing->draw({0, 0, frame.width, frame.height}, triangles, image, diagnostics);
}

}  // namespace isoshade::backends
