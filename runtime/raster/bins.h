// SPDX-License-Identifier: Apache-2.0
// Which triangles each tile of an image has to look at.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace isoshade::raster {

/// The tiles of an image, row by row; those at its right and bottom ends may reach beyond it.
struct TileGrid {
  int columns, rows;

  TileGrid(int width, int height);
  int count() const { return columns * rows; }
};

/// Of a part of the triangles. Different parts can be sorted at the same time; a tile then takes the bins of
/// each part in turn.
class Bins {
 public:
  Bins() = default;
  /// Sorts `count` records of lower/frame_layout.h from the index `first` on.
  Bins(std::span<const int32_t> triangles, int first, int count, int width, int height);

  /// The indices of those triangles that may cover a pixel of the tile, in their order.
  std::span<const int32_t> of(int tile) const {
    return std::span(triangles_).subspan(begins_[tile], begins_[tile + 1] - begins_[tile]);
  }

 private:
  std::vector<uint32_t> begins_;  ///< in triangles_, of each tile, and the end
  std::vector<int32_t> triangles_;
};

}  // namespace isoshade::raster
