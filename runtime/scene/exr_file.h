// SPDX-License-Identifier: Apache-2.0
// What an OpenEXR file says of itself, read without the OpenEXR library: what it says is checked before memory is taken
// for it, and before the library sees any of it.
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

/// As in the file.
enum class PixelType : uint8_t { uint, half, single };
enum class Compression : uint8_t { none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa, dwab };

struct Channel {
  std::string name;
  PixelType type = PixelType::half;
  uint8_t linear = 0;
  int32_t x_sampling = 1, y_sampling = 1;
};

/// Both corners belong to it.
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

/// The channels that make an image, by their numbers; -1: none.
struct Picture {
  std::array<int, 3> colors{-1, -1, -1};  ///< of a grey image the same thrice
  int alpha = -1;
  int depth = -1;
};

struct Part {
  bool deep = false;
  std::vector<Channel> channels;  ///< by name
  Compression compression = Compression::none;
  Window data, display;
  std::optional<Tiles> tiles;  ///< none: rows
  std::optional<Chromaticities> chromaticities;
  int64_t chunk_count = 0;  ///< of all levels
  Picture picture;          ///< of the part that Contents::part names
};

struct Contents {
  bool multipart = false;
  std::vector<Part> parts;
  size_t part = 0;    ///< the one that is read
  size_t tables = 0;  ///< where the offset tables of the parts begin

  const Part& read_part() const { return parts[part]; }
};

/// Reads the headers, chooses a part, and refuses what is not read.
///
/// Of several parts that is the first with the channels R, G and B, or Y for grey; where no part has them, the first with
/// a layer that does ("diffuse.R", "diffuse.G", "diffuse.B"), and of its layers the first by name. Deep parts are left
/// out.
Read<Contents> read_contents(std::string_view bytes);

/// Rows of a chunk that is no tile.
int rows_per_chunk(Compression compression);

}  // namespace isoshade::scene::exr_file
