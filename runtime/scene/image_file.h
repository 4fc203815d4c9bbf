// SPDX-License-Identifier: Apache-2.0
// Image files: PNG and OpenEXR are read and written; JPEG and Radiance HDR are read as textures.
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

/// Rows from top to bottom, 4 values per pixel. The view does not own the data.
struct ImageView {
  int width = 0;
  int height = 0;
  std::span<const float> rgba;   ///< linear
  std::span<const float> depth;  ///< one per pixel
};

/// The decoded image of a file, still in its transfer function: in `bytes` or in `rgba`; the other is empty. Grey images
/// have three equal colours, images without alpha an alpha of 1; without depth, `depth` is empty. Alpha is straight in
/// PNG files and premultiplied in EXR files; it is kept as it is. All numbers of `rgba` are finite.
struct FileImage {
  int width = 0;
  int height = 0;
  /// One word per pixel, r in the lowest byte, then g b a; for files with at most 8 bits per channel.
  std::vector<uint32_t> bytes;
  std::vector<float> rgba;  ///< 4 per pixel; 16-bit numbers are divided by 65535
  std::vector<float> depth;
  size_t not_finite = 0;  ///< number of pixels that had numbers which are not finite

  bool has_bytes() const { return !bytes.empty(); }
  ImageView view() const { return {width, height, rgba, depth}; }
};

/// Infinity becomes this when an image is read: the greatest half float.
inline constexpr float greatest_texel = 65504;
/// Replaces infinities in `rgba` by +-greatest_texel and NaN by 0, and counts the pixels in `not_finite`.
void make_finite(FileImage& image);

/// The bytes divided by 255, or `rgba`: 4 floats per pixel.
std::vector<float> numbers_of(const FileImage& image);

/// The bytes of an 8-bit RGBA PNG; `rgba` has 4 bytes per pixel, with straight alpha.
std::string png(int width, int height, std::span<const uint8_t> rgba);
/// The bytes of an OpenEXR file: float32 channels R G B A, and Z for the depth, bit for bit.
std::string exr(const ImageView& image);

/// Whether write_image can write to this path: it ends in .png or .exr, or is "-" (PNG). Reports it if not. Call it
/// before rendering.
bool check_image_path(const std::string& path, support::Diagnostics& diagnostics);

/// Writes a PNG (8 bits, encoded) or an OpenEXR file (floats as they are), by the path's ending; "-" is a PNG
/// on standard output. The file is written whole or not at all.
bool write_image(const std::string& path, const ImageView& image, Encoding encoding, float exposure,
                 support::Diagnostics& diagnostics);

/// The header of an image file: enough to know how much memory the image takes.
struct ImageHeader {
  int width = 0;  ///< both from 1 to max_size
  int height = 0;
  bool bytes = false;  ///< the image will be in FileImage::bytes
  /// Its numbers are integers of 8 or 16 bits, not floats.
  bool integers = false;
};

/// A result, or the reason why there is none: "it is tiled".
template <class T>
struct Read {
  std::optional<T> found;
  std::string reason;
};

/// For PNG, JPEG, Radiance HDR and OpenEXR, which are told by their first bytes. Refuses more than 8192 pixels a side.
Read<ImageHeader> read_header(std::string_view bytes);
/// Also refuses what read_header does, before it decompresses anything.
Read<FileImage> decode_image(std::string_view bytes);

/// The bytes of an image file. Reports a file that cannot be read, or has more than 2 GiB, at `where`.
std::optional<std::string> read_image_file(const std::string& path, support::Diagnostics& diagnostics,
                                           const support::Span& where);

/// The header of an image; `name` is its name in messages. Reports at `where` what is not an image, or is too large.
std::optional<ImageHeader> read_header(const std::string& name, std::string_view bytes,
                                       support::Diagnostics& diagnostics, const support::Span& where);
/// The image. Also reports damaged data, and warns about numbers that were not finite.
std::optional<FileImage> read_image(const std::string& name, std::string_view bytes,
                                    support::Diagnostics& diagnostics, const support::Span& where);
/// The same for a file on disk.
std::optional<FileImage> read_image(const std::string& path, support::Diagnostics& diagnostics,
                                    const support::Span& where = {});

// The formats that decode_image chooses among.

/// Why an image of this size is not read; empty if it is.
std::string refuse_size(int64_t width, int64_t height);

/// Whether the bytes begin like a file of the format.
bool is_exr(std::string_view bytes);
Read<ImageHeader> read_exr_header(std::string_view bytes);
Read<FileImage> decode_exr(std::string_view bytes);
bool is_hdr(std::string_view bytes);
Read<ImageHeader> read_hdr_header(std::string_view bytes);
Read<FileImage> decode_hdr(std::string_view bytes);
bool is_png(std::string_view bytes);
Read<ImageHeader> read_png_header(std::string_view bytes);
Read<FileImage> decode_png(std::string_view bytes);
bool is_jpeg(std::string_view bytes);
Read<ImageHeader> read_jpeg_header(std::string_view bytes);
Read<FileImage> decode_jpeg(std::string_view bytes);

}  // namespace isoshade::scene
