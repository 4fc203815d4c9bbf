// SPDX-License-Identifier: Apache-2.0
// The chunks of an OpenEXR file: blocks of rows, or tiles.
#pragma once

#include <string_view>
#include <vector>

#include "runtime/scene/exr_file.h"

namespace isoshade::scene::exr_file {

/// A chunk of the largest level of the part that is read.
struct Chunk {
  Window pixels;           ///< those of the data window that it has
  int column = 0;          ///< of the tile
  int row = 0;             ///< of the tile, or of the block of rows
  std::string_view bytes;  ///< in the file: its place, its size, and its data
};

/// All of them, from the top, tiles of a row from the left. Refuses a part that lacks a chunk, on any level: a truncated
/// file is no image. Refuses chunks without compression, by runs or by zlib, whose data unpack to fewer bytes than their
/// pixels have: OpenEXR 3.1 would take the missing pixels from memory that nothing has written. The data of the other
/// compressions are checked by OpenEXR.
Read<std::vector<Chunk>> find_chunks(std::string_view bytes, const Contents& contents);

}  // namespace isoshade::scene::exr_file
