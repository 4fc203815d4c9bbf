// SPDX-License-Identifier: Apache-2.0
// One tile of a view: which triangle each pixel shows, then its color.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "backends/backend.h"
#include "backends/cpu/kernel.h"
#include "runtime/raster/bins.h"
#include "runtime/raster/tile.h"

namespace isoshade::cpu {

/// A window of a view while it is drawn.
struct DrawJob {
  const backends::Frame& frame;
  const backends::View& view;
  raster::TileGrid grid;  ///< over the window
  std::span<const int32_t> triangles;
  int opaque;  ///< how many of them; those that are blended follow
  const BufferView* buffers;
  /// One for each program of the frame; null for those that no triangle needs.
  std::span<const Kernel* const> kernels;
  std::vector<raster::Bins> bins;  ///< one for each part of the triangles, in their order
  backends::Image& image;
};

/// Draws tiles one after the other. One for each thread: it holds several hundred kilobytes.
class TilePainter {
 public:
  void paint(DrawJob& job, int tile);

 private:
  /// Consecutive triangles of one object in a tile's list.
  struct Run {
    int first_triangle;
    int object;
    int pixels;  ///< the number of visible ones; list_pixels() turns it into the index of the next one
  };
  /// Pixels [begin, end) of the tile's storage, which show triangles of one run.
  struct Segment {
    int begin, end;
    int run;
  };

  void collect(const DrawJob& job, int tile);
  void paint_opaque(DrawJob& job, int width, int height);
  void blend(DrawJob& job, int tile, int width, int height);
  /// Draws blended triangles of one object.
  void blend_object(DrawJob& job, std::span<const int32_t> listed, const raster::Triangle& first);
  /// Blends the candidates that are drawn.
  void blend_candidates(DrawJob& job, const raster::Candidates& found, const raster::Triangle& first);
  void rasterize(const DrawJob& job, std::span<const int32_t> listed);
  /// Draws triangles of one object that has a cut-out.
  void cut_out(const DrawJob& job, std::span<const int32_t> listed, const raster::Triangle& first);
  void segment();
  void list_pixels();
  void shade(const DrawJob& job);
  void write_color(DrawJob& job, int width, int height) const;
  void write_depth(DrawJob& job, int width, int height) const;
  int run_of(int triangle) const;

  int x_ = 0, y_ = 0;  ///< the tile's first pixel
  raster::Tile tile_;
  std::unique_ptr<raster::Candidates> candidates_;  ///< made when a tile first has a cut-out
  std::vector<Run> runs_;
  std::vector<Segment> segments_;
  std::vector<std::vector<int>> layers_;  ///< candidates, a pixel at most once in each

  // The visible pixels, ordered by run.
  int pixel_x_[raster::tile_pixels], pixel_y_[raster::tile_pixels], pixel_triangle_[raster::tile_pixels];
  alignas(64) float color_[4 * raster::tile_pixels];
  /// The index in color_ of each visible pixel of the tile.
  int place_[raster::tile_pixels];
  int layers_at_[raster::tile_pixels] = {};  ///< of each pixel in storage: used and left at 0 by blend_candidates()
};

}  // namespace isoshade::cpu
