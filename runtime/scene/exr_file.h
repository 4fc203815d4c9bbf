// SPDX-License-Identifier: Apache-2.0
// The headers and the chunk table of an OpenEXR file, read without the OpenEXR library: everything is checked before
// memory is allocated for it and before the library sees it.
// Source: "OpenEXR File Layout", openexr.com.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/scene/chromaticities.h"
#include "runtime/scene/image_file.h"

namespace isoshade::scene::exr_file {

/// Limits that keep hostile files harmless. Sides of the display window are limited by scene::max_size.
inline constexpr size_t max_parts = 1024;
inline constexpr size_t max_attributes = 4096;  ///< of a part
inline constexpr size_t max_channels = 1024;
inline constexpr int64_t max_data_side = 16'384;                ///< of the data window
inline constexpr int64_t max_chunks = 65'536;                   ///< of the largest level of a part
inline constexpr int64_t max_chunk_bytes = int64_t{128} << 20;  ///< unpacked
inline constexpr int32_t max_coordinate = int32_t{1} << 24;     ///< of windows, positive or negative

/// The values of the file.
enum class PixelType : uint8_t { uint, half, single };
using Compression = ExrCompression;

struct Channel {
  std::string name;
  PixelType type = PixelType::half;
  uint8_t linear = 0;
  int32_t x_sampling = 1, y_sampling = 1;
};

/// Includes both corners.
struct Window {
  int32_t min_x = 0, min_y = 0, max_x = 0, max_y = 0;
  int64_t width() const { return int64_t{max_x} - min_x + 1; }
  int64_t height() const { return int64_t{max_y} - min_y + 1; }
};

struct Tiles {
  uint32_t width = 0, height = 0;
  uint8_t level_mode = 0;  ///< 0: one level, 1: halved both ways, 2: halved each way
  bool round_up = false;   ///< the sides of smaller levels
};

/// The numbers of the channels of an image; -1: none.
struct Picture {
  std::array<int, 3> colors{-1, -1, -1};  ///< the same channel three times if the image is grey
  int alpha = -1;
  int depth = -1;
};

struct Part {
  bool deep = false;
  std::vector<Channel> channels;  ///< by name
  Compression compression = Compression::none;
  Window data, display;
  std::optional<Tiles> tiles;  ///< none: scanlines
  std::optional<Chromaticities> chromaticities;
  int64_t chunk_count = 0;  ///< of all levels
  Picture picture;          ///< only of the part Contents::part
};

struct Contents {
  bool multipart = false;
  std::vector<Part> parts;
  size_t part = 0;    ///< the one that is read
  size_t tables = 0;  ///< offset of the chunk tables of the parts

  const Part& read_part() const { return parts[part]; }
};

/// Reads the headers and chooses a part. Refuses files with unsupported features.
///
/// Chooses the first part with the channels R, G and B, or Y for grey. If there is none, chooses the first part with
/// such a layer ("diffuse.R", "diffuse.G", "diffuse.B"), and its first such layer by name. Skips deep parts.
Read<Contents> read_contents(std::string_view bytes);

/// The number of rows of a chunk of scanlines.
int rows_per_chunk(Compression compression);

// The chunks of the file: blocks of rows, or tiles.

/// A chunk of the largest level of the part that is read.
struct Chunk {
  Window pixels;           ///< of the data window
  int column = 0;          ///< of the tile
  int row = 0;             ///< of the tile, or of the block of rows
  std::string_view bytes;  ///< in the file: position, size and data
};

/// All chunks from top to bottom, tiles of a row from left to right. Refuses a part that lacks a chunk on any level, as
/// in a truncated file. Refuses uncompressed, run-length and zlib chunks whose data decompress to fewer bytes than
/// their pixels have: OpenEXR 3.1 would read the missing pixels from uninitialised memory. OpenEXR checks the data of
/// the other compressions.
Read<std::vector<Chunk>> find_chunks(std::string_view bytes, const Contents& contents);

// A check before the library decompresses a chunk: its data must contain every sample. OpenEXR 3.1 does not check it,
// and reads missing samples from uninitialised memory.

/// Whether the data contain all samples of these pixels. For PIZ, PXR24, B44 and B44A the library checks it.
bool data_fill(const Part& part, const Window& pixels, std::string_view data);

/// The number of samples along `pixels`: the first pixel has one, and every `sampling`-th from there.
int64_t samples(int64_t pixels, int64_t sampling);
/// The number of rows of these pixels that have samples of a channel.
int64_t sampled_rows(const Part& part, const Window& pixels, const Channel& channel);
int64_t bytes_of(PixelType type);

/// Whether zlib decompresses the data to exactly `size` bytes.
bool inflates_to(std::string_view data, int64_t size);

/// data_fill for DWAA and DWAB.
bool dwa_fills(const Part& part, const Window& pixels, std::string_view data);

}  // namespace isoshade::scene::exr_file
