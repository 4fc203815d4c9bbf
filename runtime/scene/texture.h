// SPDX-License-Identifier: Apache-2.0
// Images as shaders read them: linear and finite, with mip levels.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/scene/image_file.h"

namespace isoshade::threads {
class Workers;
}

namespace isoshade::scene {

/// A level of a texture. Rows from top to bottom, r g b a per texel. No value is infinite, NaN or denormal.
struct TextureLevel {
  int width = 0;
  int height = 0;
  std::vector<float> texels;
};

/// A level of a texture whose file has bytes: one word per texel, r in the lowest byte, then g b a.
struct ByteLevel {
  int width = 0;
  int height = 0;
  std::vector<uint32_t> texels;
};

/// The float of each byte: n / 255; with `srgb`, which does not apply to alpha, srgb_decode of that.
using ByteTable = std::array<float, 256>;
const ByteTable& byte_table(bool srgb);

/// Makes the numbers of an image linear: with `srgb`, applies srgb_decode to all but alpha. NaN becomes 0, infinities
/// the greatest number of their sign.
TextureLevel linear_level(FileImage image, bool srgb);
/// The floats of bytes.
TextureLevel linear_level(const ByteLevel& level, bool srgb);
/// The bytes nearest to the floats; of two equally near ones the lower.
ByteLevel byte_level(const TextureLevel& level, bool srgb);

/// The next mip level: max(1, floor(n / 2)) of n columns, and rows likewise. Each texel is the mean of the texels it
/// covers: two columns, or three if n is odd, the outer ones weighted by the covered fraction. Columns first, then rows.
/// Alpha does not affect the weights. Works on the threads of `workers` if there are any; the bits do not depend on that.
TextureLevel half_size(const TextureLevel& level, threads::Workers* workers = nullptr);
/// The same for the floats of bytes.
TextureLevel half_size(const ByteLevel& level, bool srgb, threads::Workers* workers = nullptr);

}  // namespace isoshade::scene
