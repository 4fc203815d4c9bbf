// SPDX-License-Identifier: Apache-2.0
// Which triangles each tile of an image has to look at.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/raster/triangle.h"

namespace isoshade::raster {

/// The tiles of a part of an image, row by row; those at its right and bottom ends may reach beyond it.
struct TileGrid {
  Box area;  ///< in pixels of the image; not empty
  int columns, rows;

  explicit TileGrid(const Box& area);
  int count() const { return columns * rows; }
  /// The first pixel of a tile.
  int x(int tile) const;
  int y(int tile) const;
};

/// Of a part of the triangles. Different parts can be sorted at the same time; a tile then takes the bins of
/// each part in turn.
class Bins {
 public:
  Bins() = default;
  /// Sorts `count` records of lower/frame_layout.h from the index `first` on.
  Bins(std::span<const int32_t> triangles, int first, int count, const TileGrid& grid);

  /// The indices of those triangles that may cover a pixel of the tile, in their order.
  std::span<const int32_t> of(int tile) const {
    return std::span(triangles_).subspan(begins_[tile], begins_[tile + 1] - begins_[tile]);
  }

 private:
  std::vector<uint32_t> begins_;  ///< in triangles_, of each tile, and the end
  std::vector<int32_t> triangles_;
};

}  // namespace isoshade::raster
