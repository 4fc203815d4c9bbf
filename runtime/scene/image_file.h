// SPDX-License-Identifier: Apache-2.0
// Image files. The table in image_file.cpp has a row for each format.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
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

/// The compressions of OpenEXR, numbered as in its files. The view of `lossless_compressions` names those that are written.
enum class ExrCompression : uint8_t { none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa, dwab };
inline constexpr std::pair<std::string_view, ExrCompression> lossless_compressions[] = {
    {"none", ExrCompression::none}, {"rle", ExrCompression::rle}, {"zips", ExrCompression::zips},
    {"zip", ExrCompression::zip},   {"piz", ExrCompression::piz}};

/// How an image is written. Each format reads what concerns it.
struct WriteOptions {
  Encoding encoding = Encoding::srgb;  ///< of the formats with 8 bits, and exposure too
  float exposure = 1;
  ExrCompression compression = ExrCompression::zip;
  int quality = 90;  ///< of JPEG: 1 to 100
  int threads = 0;   ///< 0: one for each core; the bytes of the file do not depend on it
};

/// Rows from top to bottom, 4 bytes per pixel, with straight alpha. The view does not own the data.
struct ByteView {
  int width = 0;
  int height = 0;
  std::span<const uint8_t> rgba;
};

struct ImageHeader;
template <class T>
struct Read;

/// A file format. Its functions may be null: Radiance HDR is only read. Exactly one of the writers of a format is not null
/// if it is written.
struct ImageFormat {
  std::string_view name;       ///< the ending of file names without its dot, and what --format takes
  std::string_view alias;      ///< another ending; empty: none
  std::string_view title;      ///< in messages
  bool keeps_alpha = true;     ///< if it is written
  bool (*is)(std::string_view bytes) = nullptr;  ///< whether a file begins like one of the format
  Read<ImageHeader> (*read_header)(std::string_view bytes) = nullptr;
  Read<FileImage> (*decode)(std::string_view bytes) = nullptr;
  std::string (*write_bytes)(const ByteView& image, const WriteOptions& options) = nullptr;   ///< 8 bits, encoded
  std::string (*write_floats)(const ImageView& image, const WriteOptions& options) = nullptr;  ///< floats as they are

  bool is_written() const { return write_bytes != nullptr || write_floats != nullptr; }
};

std::span<const ImageFormat> image_formats();

/// The format of the image to be written to this path: the one of this name (an entry of the table, which must not
/// contradict the ending of the path), or if it is empty that of the ending. "-" without a name is PNG. Reports what is
/// not known, and returns null. Call it before rendering.
const ImageFormat* output_format(const std::string& path, const std::string& name, support::Diagnostics& diagnostics);

/// The endings of the formats that are written: ".png, .exr or .jpg".
std::string written_endings();

/// Encodes an image for a format with write_bytes. If the format has no alpha, warns about pixels that are not opaque;
/// they become those of the image over black. `name` names the image in the warning.
std::vector<uint8_t> encode_for(const ImageFormat& format, const ImageView& image, const WriteOptions& options,
                                const std::string& name, support::Diagnostics& diagnostics);

/// Writes an image in a format that is_written(); "-" is standard output. The file is written whole or not at all.
bool write_image(const std::string& path, const ImageFormat& format, const ImageView& image,
                 const WriteOptions& options, support::Diagnostics& diagnostics);
/// The same in the format of the path's ending, which it reports if it is not known.
bool write_image(const std::string& path, const ImageView& image, const WriteOptions& options,
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

/// For all formats that are read, which are told by their first bytes. Refuses more than 8192 pixels a side.
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

// What the rows of the table are made of.

/// Why an image of this size is not read; empty if it is.
std::string refuse_size(int64_t width, int64_t height);

bool is_exr(std::string_view bytes);
Read<ImageHeader> read_exr_header(std::string_view bytes);
Read<FileImage> decode_exr(std::string_view bytes);
/// Float32 channels R G B A, and Z for the depth, bit for bit.
std::string exr(const ImageView& image, ExrCompression compression = ExrCompression::zip, int threads = 0);

bool is_hdr(std::string_view bytes);
Read<ImageHeader> read_hdr_header(std::string_view bytes);
Read<FileImage> decode_hdr(std::string_view bytes);

bool is_png(std::string_view bytes);
Read<ImageHeader> read_png_header(std::string_view bytes);
Read<FileImage> decode_png(std::string_view bytes);
/// 8 bits; RGB if all pixels are opaque, otherwise RGBA. `rgba` has 4 bytes per pixel, with straight alpha.
std::string png(int width, int height, std::span<const uint8_t> rgba, int threads = 0);

bool is_jpeg(std::string_view bytes);
Read<ImageHeader> read_jpeg_header(std::string_view bytes);
Read<FileImage> decode_jpeg(std::string_view bytes);
/// Baseline JPEG in YCbCr. From a quality of 90 on, colours have the full resolution, otherwise half of it.
std::string jpeg(const ByteView& image, int quality);

bool is_pnm(std::string_view bytes);
Read<ImageHeader> read_pnm_header(std::string_view bytes);
Read<FileImage> decode_pnm(std::string_view bytes);
std::string ppm(const ByteView& image);

bool is_pfm(std::string_view bytes);
Read<ImageHeader> read_pfm_header(std::string_view bytes);
Read<FileImage> decode_pfm(std::string_view bytes);
std::string pfm(const ImageView& image);

// The parts of PNG files, which animations have too.

/// The signature and the header.
std::string png_head(int width, int height, bool has_alpha);
/// A zlib stream of the rows in parts, of which each may be an IDAT.
std::vector<std::string> png_data(int width, int height, std::span<const uint8_t> rgba, bool has_alpha, int threads);
/// A chunk: its length, type, data and CRC.
std::string png_chunk(std::string_view type, std::string_view data);

}  // namespace isoshade::scene
