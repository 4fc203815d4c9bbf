// SPDX-License-Identifier: Apache-2.0
// The visible pixels of a tile, sorted by the object that they show: a call of a program takes pixels of one object.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "backends/backend.h"
#include "backends/cpu/canvas.h"
#include "runtime/raster/tile.h"

namespace isoshade::cpu {

class SortedPixels {
 public:
  /// Consecutive triangles of one object in a tile's list.
  struct Run {
    int first_triangle;
    int object;
    int begin = 0, end = 0;  ///< its visible pixels
  };

  /// Lists the runs of a tile whose triangles are `listed`, in ascending order.
  void begin(const int32_t* triangles, std::span<const int32_t> listed);
  /// Sorts the pixels of the tile whose first sample is (x, y). `by_blocks` (Skip::tiles): blocks that one object covers,
  /// or nothing, are taken as a whole.
  void sort(const raster::Tile& tile, int x, int y, bool by_blocks, backends::TileCounts& counts);
  std::span<const Run> runs() const { return runs_; }
  /// Writes color to where each pixel lies, and the background where there is none.
  void write(const raster::Tile& tile, const float (&background)[4], const Canvas& canvas) const;

  // Of each pixel.
  int x[raster::tile_pixels], y[raster::tile_pixels], triangle[raster::tile_pixels];
  alignas(64) float color[4 * raster::tile_pixels];

 private:
  static constexpr int block_count = (raster::tile_size / raster::block_size) * (raster::tile_size / raster::block_size);
  static constexpr int block_pixels = raster::block_size * raster::block_size;

  /// What a block of the tile shows.
  enum class Shown : uint8_t { several, nothing, one_object };
  /// Pixels [begin, end) of the tile's storage, which show triangles of one run.
  struct Segment {
    int begin, end;
    int run;
  };
  /// The triangles [first, end) of a run; of `nothing` that number alone.
  struct Range {
    int run, first, end;
    bool has(int triangle) const { return triangle >= first && triangle < end; }
  };

  Range range_of(int triangle) const;
  void find_segments(const raster::Tile& tile, int begin, int end);
  void find_blocks(const raster::Tile& tile, backends::TileCounts& counts);
  void append(int begin, int end, int run);
  void list_pixels(const raster::Tile& tile, int x, int y);
  void write_row(const raster::Tile& tile, const float (&background)[4], int first, int count, float* row) const;
  bool is_one_piece(const raster::Tile& tile, int first) const;

  std::vector<Run> runs_;
  std::vector<Segment> segments_;
  Shown shown_[block_count];
  /// The index in color of each visible pixel of the tile; where a block shows one object, only of its first pixel.
  int place_[raster::tile_pixels];
};

}  // namespace isoshade::cpu
