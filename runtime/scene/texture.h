// SPDX-License-Identifier: Apache-2.0
// Images as shaders read them: linear, finite, with smaller versions of themselves.
#pragma once

#include <vector>

#include "runtime/scene/image_file.h"

namespace isoshade::scene {

/// One size of a texture. Rows run top down; r g b a a texel. No value is infinite, NaN or denormal.
struct TextureLevel {
  int width = 0;
  int height = 0;
  std::vector<float> texels;
};

/// The image with its numbers made linear: `srgb`, by srgb_decode, but for the fourth. NaN becomes 0, infinities the
/// greatest numbers of their sign.
TextureLevel linear_level(const FloatImage& image, bool srgb);

/// The next mip level: max(1, floor(n / 2)) of n columns, and so of the rows. Each texel is the mean of what it covers:
/// of two columns, or where n is odd of three, the outer ones in the parts that lie in it. Across, then down; the alpha
/// takes no part in the weights.
TextureLevel half_size(const TextureLevel& level);

}  // namespace isoshade::scene
