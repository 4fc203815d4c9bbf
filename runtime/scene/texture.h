// SPDX-License-Identifier: Apache-2.0
// Images as shaders read them: linear, finite, with smaller versions of themselves.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/scene/image_file.h"

namespace isoshade::scene {

/// One size of a texture. Rows run top down; r g b a a texel. No value is infinite, NaN or denormal.
struct TextureLevel {
  int width = 0;
  int height = 0;
  std::vector<float> texels;
};

/// One size of a texture whose file has bytes: as there, a word a texel, r g b a from its lowest byte on.
struct ByteLevel {
  int width = 0;
  int height = 0;
  std::vector<uint32_t> texels;
};

/// What each byte is as a float: n / 255; under `srgb` srgb_decode of that, as for all bytes but alpha.
using ByteTable = std::array<float, 256>;
const ByteTable& byte_table(bool srgb);

/// The image with its numbers made linear: `srgb`, by srgb_decode, but for the fourth. NaN becomes 0, infinities the
/// greatest numbers of their sign.
TextureLevel linear_level(FileImage image, bool srgb);
/// The floats that bytes are.
TextureLevel linear_level(const ByteLevel& level, bool srgb);
/// The bytes that are nearest to the floats; between two, the lower one.
ByteLevel byte_level(const TextureLevel& level, bool srgb);

/// The next mip level: max(1, floor(n / 2)) of n columns, and so of the rows. Each texel is the mean of what it covers:
/// of two columns, or where n is odd of three, the outer ones in the parts that lie in it. Across, then down; the alpha
/// takes no part in the weights.
TextureLevel half_size(const TextureLevel& level);
/// The same of the floats that bytes are.
TextureLevel half_size(const ByteLevel& level, bool srgb);

}  // namespace isoshade::scene
