// SPDX-License-Identifier: Apache-2.0
// Images as files: PNG for eyes, OpenEXR for floats.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/support/diagnostics.h"
#include "runtime/scene/encode.h"

namespace isoshade::scene {

/// Rows run top down; 4 values a pixel. The spans belong to whoever made the view.
struct ImageView {
  int width = 0;
  int height = 0;
  std::span<const float> rgba;   ///< linear
  std::span<const float> depth;  ///< one a pixel
};

/// An image as a file holds it. A PNG's values are its bytes over 255, as encoded; where a file has no alpha,
/// it is 1; where it has no depth, `depth` is empty.
struct FloatImage {
  int width = 0;
  int height = 0;
  std::vector<float> rgba;
  std::vector<float> depth;

  ImageView view() const { return {width, height, rgba, depth}; }
};

/// The bytes of an 8-bit RGBA PNG; `rgba` has 4 bytes a pixel.
std::string png(int width, int height, std::span<const uint8_t> rgba);
/// The bytes of an OpenEXR file: float32 channels R G B A, and Z for the depth, bit for bit.
std::string exr(const ImageView& image);

/// Whether write_image knows what to write under this name: it ends in .png or .exr, or is "-" (PNG).
/// Reports it if not, so that it can be asked before the image is rendered.
bool check_image_path(const std::string& path, support::Diagnostics& diagnostics);

/// Writes a PNG (8 bits, encoded) or an OpenEXR file (floats as they are), by the path's ending; "-" is a PNG
/// on standard output. The file is written whole or not at all.
bool write_image(const std::string& path, const ImageView& image, Encoding encoding, float exposure,
                 support::Diagnostics& diagnostics);

/// Reads a PNG or OpenEXR file, by its ending. Reports what is no such file, is damaged, or has a side beyond
/// 8192 pixels.
std::optional<FloatImage> read_image(const std::string& path, support::Diagnostics& diagnostics);

}  // namespace isoshade::scene
