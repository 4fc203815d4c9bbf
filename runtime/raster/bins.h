// SPDX-License-Identifier: Apache-2.0
// Sorts triangles into the tiles of an image.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/raster/triangle.h"

namespace isoshade::raster {

/// The tiles of a window, row by row; those at its right and bottom edges may extend beyond it.
struct TileGrid {
  Box area;  ///< the window in pixels of the image; not empty
  int columns, rows;

  explicit TileGrid(const Box& area);
  int count() const { return columns * rows; }
  /// The first pixel of a tile.
  int x(int tile) const;
  int y(int tile) const;
};

/// The bins of a part of the triangles. Parts can be sorted in parallel; a tile then takes the bins of each part in
/// turn.
class Bins {
 public:
  Bins() = default;
  /// Sorts `count` records of lower/frame_layout.h from the index `first` on.
  Bins(std::span<const int32_t> triangles, int first, int count, const TileGrid& grid);

  /// The indices of the triangles that may cover a pixel of the tile, in their order.
  std::span<const int32_t> of(int tile) const {
    return std::span(triangles_).subspan(begins_[tile], begins_[tile + 1] - begins_[tile]);
  }

 private:
  std::vector<uint32_t> begins_;  ///< where the indices of each tile begin in triangles_, and the end
  std::vector<int32_t> triangles_;
};

}  // namespace isoshade::raster
