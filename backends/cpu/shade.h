// SPDX-License-Identifier: Apache-2.0
// One tile of a frame: visible surfaces, then their colours.
#pragma once

#include <span>
#include <vector>

#include "backends/backend.h"
#include "backends/cpu/kernel.h"
#include "runtime/raster/bins.h"
#include "runtime/raster/tile.h"

namespace isoshade::cpu {

/// A frame while it is drawn.
struct DrawJob {
  const backends::Frame& frame;
  raster::TileGrid grid;  ///< over the part of the frame that is drawn
  std::span<const int32_t> triangles;
  const BufferView* buffers;
  /// Of each program of the frame; null for those that no object has.
  std::span<const Kernel* const> kernels;
  std::vector<raster::Bins> bins;  ///< of consecutive parts of the triangles
  backends::Image& image;
};

/// What a thread needs to draw tiles; several hundred kilobytes.
class TilePainter {
 public:
  void paint(DrawJob& job, int tile);

 private:
  /// Triangles of one object that follow each other in a tile's list.
  struct Run {
    int first_triangle;
    int object;
    int pixels;  ///< how many are visible; later where the next one goes
  };
  /// Pixels [begin, end) of the tile's storage that show triangles of one run.
  struct Segment {
    int begin, end;
    int run;
  };

  void collect(const DrawJob& job, int tile);
  void segment();
  void list_pixels();
  void shade(const DrawJob& job);
  void write(DrawJob& job, int width, int height) const;
  int run_of(int triangle) const;

  int x_ = 0, y_ = 0;  ///< the tile's first pixel
  raster::Tile tile_;
  std::vector<Run> runs_;
  std::vector<Segment> segments_;

  // Visible pixels, those of each run together.
  int pixel_x_[raster::tile_pixels], pixel_y_[raster::tile_pixels], pixel_triangle_[raster::tile_pixels];
  alignas(64) float color_[4 * raster::tile_pixels];
  /// Where the colour of each visible pixel of the tile is.
  int place_[raster::tile_pixels];
};

}  // namespace isoshade::cpu
