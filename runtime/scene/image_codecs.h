// SPDX-License-Identifier: Apache-2.0
// What read_image chooses among.
#pragma once

#include <string>
#include <string_view>

#include "runtime/scene/image_file.h"

namespace isoshade::scene {

/// An image, or the reason why there is none: "it is tiled".
struct Decoded {
  std::optional<FloatImage> image;
  std::string reason;
};

Decoded decode_exr(std::string_view bytes);
Decoded decode_png(std::string_view bytes);

}  // namespace isoshade::scene
