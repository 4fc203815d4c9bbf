// SPDX-License-Identifier: Apache-2.0
// Sorts triangles into the tiles of an image.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compiler/support/memory.h"
#include "runtime/raster/triangle.h"
#include "runtime/threads/workers.h"

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

/// For each tile the triangles that may cover a pixel of it. Keeps its memory for the next image.
class Bins {
 public:
  /// Sorts all triangles (records of lower/frame_layout.h).
  void sort(std::span<const int32_t> triangles, const TileGrid& grid, threads::Workers& workers);

  /// The indices of the triangles that may cover a pixel of the tile, in their order.
  std::span<const int32_t> of(int tile) const {
    return std::span(triangles_).subspan(begins_[tile], begins_[tile + 1] - begins_[tile]);
  }

 private:
  struct Entry {
    int tile;
    int triangle;
  };
  /// Consecutive triangles, which one task sorts.
  struct Part {
    support::Array<Entry> entries;  ///< in the order of the triangles
    std::vector<uint32_t> places;   ///< for each tile: how many, then where in triangles_ the next one belongs
  };

  static void list(std::span<const int32_t> triangles, int first, int count, const TileGrid& grid, Part& part);

  std::vector<Part> parts_;
  support::Array<uint32_t> begins_;  ///< where the indices of each tile begin in triangles_, and the end
  support::Array<int32_t> triangles_;
};

/// Those that may cover a pixel of the area, in their order.
std::vector<int32_t> triangles_within(std::span<const int32_t> triangles, const Box& area);

}  // namespace isoshade::raster
