// SPDX-License-Identifier: Apache-2.0
// Images as files: PNG for eyes, OpenEXR for floats; and as textures JPEG and Radiance HDR too.
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

/// An image as a file holds it. Bytes are over 255, numbers of 16 bits over 65535, as encoded; where a file is grey,
/// its three colours are alike; where it has no alpha, it is 1; where it has no depth, `depth` is empty.
struct FloatImage {
  int width = 0;
  int height = 0;
  std::vector<float> rgba;
  std::vector<float> depth;
  bool bytes = false;  ///< the file has 8 bits a number, or fewer

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

/// An image, or the reason why there is none: "it is tiled".
struct Decoded {
  std::optional<FloatImage> image;
  std::string reason;
};

/// PNG, JPEG, Radiance HDR or OpenEXR, by how they begin. Not beyond 8192 pixels a side, which is known before anything
/// is unpacked.
Decoded decode_image(std::string_view bytes);

/// Reads an image file. Reports what is no such file, is damaged or too large, at `where`.
std::optional<FloatImage> read_image(const std::string& path, support::Diagnostics& diagnostics,
                                     const support::Span& where = {});
/// The same of the bytes of a file that messages call `name`.
std::optional<FloatImage> read_image(const std::string& name, std::string_view bytes,
                                     support::Diagnostics& diagnostics, const support::Span& where);

}  // namespace isoshade::scene
