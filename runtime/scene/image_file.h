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

/// An image as a file holds it, as encoded: in `bytes` or in `rgba`, the other of which is empty. Where a file is grey,
/// its three colours are alike; where it has no alpha, it is 1; where it has no depth, `depth` is empty. Colours are not
/// multiplied by alpha in a PNG, and are in an EXR: they stay as the file has them. All numbers of `rgba` are finite.
struct FileImage {
  int width = 0;
  int height = 0;
  /// A word a pixel, r g b a from its lowest byte on, of files with 8 bits a number or fewer.
  std::vector<uint32_t> bytes;
  std::vector<float> rgba;  ///< 4 a pixel; numbers of 16 bits are over 65535
  std::vector<float> depth;
  size_t not_finite = 0;  ///< pixels that had numbers in the file which are not finite

  bool has_bytes() const { return !bytes.empty(); }
  ImageView view() const { return {width, height, rgba, depth}; }
};

/// What infinity becomes where an image is read: the greatest half float.
inline constexpr float greatest_texel = 65504;
/// Makes infinite numbers of `rgba` +-greatest_texel and NaN 0, and counts their pixels in `not_finite`.
void make_finite(FileImage& image);

/// The bytes over 255, or `rgba` as it is: 4 floats a pixel.
std::vector<float> numbers_of(const FileImage& image);

/// The bytes of an 8-bit RGBA PNG; `rgba` has 4 bytes a pixel, the colours not multiplied by alpha.
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

/// What a file says of its image before its data: enough to know what room it takes.
struct ImageHeader {
  int width = 0;  ///< both from 1 to max_size
  int height = 0;
  bool bytes = false;  ///< the image will be in FileImage::bytes
  /// Its numbers are whole ones, of 8 or 16 bits, and no floats.
  bool integers = false;
};

/// What is in a file, or the reason why it is not: "it is tiled".
template <class T>
struct Read {
  std::optional<T> found;
  std::string reason;
};

/// PNG, JPEG, Radiance HDR or OpenEXR, by how they begin. Not beyond 8192 pixels a side.
Read<ImageHeader> read_header(std::string_view bytes);
/// Also refuses what read_header does, before anything is unpacked.
Read<FileImage> decode_image(std::string_view bytes);

/// The bytes of an image file. Reports a file that cannot be read, or has more than 2 GiB, at `where`.
std::optional<std::string> read_image_file(const std::string& path, support::Diagnostics& diagnostics,
                                           const support::Span& where);

/// What a file that messages call `name` says of its image; or reports at `where` that it is no image, or too large.
std::optional<ImageHeader> read_header(const std::string& name, std::string_view bytes,
                                       support::Diagnostics& diagnostics, const support::Span& where);
/// The image in such a file. Reports also what is damaged, and warns of numbers that were not finite.
std::optional<FileImage> read_image(const std::string& name, std::string_view bytes,
                                    support::Diagnostics& diagnostics, const support::Span& where);
/// The same of a file on the disk.
std::optional<FileImage> read_image(const std::string& path, support::Diagnostics& diagnostics,
                                    const support::Span& where = {});

}  // namespace isoshade::scene
