// SPDX-License-Identifier: Apache-2.0
// One tile of a view: which triangle each pixel shows, then its color.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "backends/backend.h"
#include "backends/cpu/kernel.h"
#include "runtime/raster/bins.h"
#include "runtime/raster/tile.h"

namespace isoshade::cpu {

/// A program of Stage::post that is run over each tile.
struct TilePost {
  const Kernel& kernel;
  const BufferView* buffers;
  std::span<const int32_t> records;  ///< lower::FrameBuffer::layer_records, for the whole picture
};

/// A window of a view while it is drawn.
struct DrawJob {
  const backends::Frame& frame;
  const backends::View& view;
  raster::TileGrid grid;  ///< over the window, in samples
  std::span<const int32_t> triangles;
  int opaque;  ///< how many of them; those that are blended follow
  const BufferView* buffers;
  /// One for each program of the frame; null for those that no triangle needs.
  std::span<const Kernel* const> kernels;
  int side;                         ///< samples of a pixel along each axis
  std::span<const TilePost> posts;  ///< over each sample
  float background[4];              ///< of the image: the mean of the view's
  /// Of the window in pixels, which is so wide; no color if the target has none.
  float* color;
  float* depth;
  int width;
  /// Of each tile: whether the image holds nothing there already. Null if that is not known.
  uint8_t* blank;
  const raster::Bins& bins;
};

/// Draws tiles one after the other. One for each thread: it holds several hundred kilobytes.
class TilePainter {
 public:
  /// Returns whether every number of the color was finite, before and after each post.
  bool paint(const DrawJob& job, int tile);

 private:
  /// Where the samples of the tile are drawn: in the image, or in samples_ if a pixel has several. At the tile's first one.
  struct Canvas {
    float* color = nullptr;
    float* depth = nullptr;
    size_t stride = 0;  ///< samples from a row to the next
    int width = 0, height = 0;

    size_t index(int x, int y) const { return static_cast<size_t>(y) * stride + static_cast<size_t>(x); }
  };
  /// The samples of a tile, row by row, if a pixel has several.
  struct Samples {
    alignas(64) float color[4 * raster::tile_pixels];
    alignas(64) float depth[raster::tile_pixels];
  };
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
  Canvas canvas_of(const DrawJob& job, int tile);
  void paint_opaque(const DrawJob& job);
  /// Writes the image of an empty tile, unless it is there already.
  void leave_blank(const DrawJob& job, int tile) const;
  void fill_background(const DrawJob& job) const;
  /// Writes the image of an empty tile whose samples nothing processes.
  void fill_pixels(const DrawJob& job) const;
  bool process(const TilePost& post, const DrawJob& job);
  void resolve(const DrawJob& job);
  bool is_finite() const;
  void blend(const DrawJob& job, int tile);
  /// Draws blended triangles of one object.
  void blend_object(const DrawJob& job, std::span<const int32_t> listed, const raster::Triangle& first);
  /// Blends the candidates that are drawn.
  void blend_candidates(const DrawJob& job, const raster::Candidates& found, const raster::Triangle& first);
  void rasterize(const DrawJob& job, std::span<const int32_t> listed);
  /// Draws triangles of one object that has a cut-out.
  void cut_out(const DrawJob& job, std::span<const int32_t> listed, const raster::Triangle& first);
  void segment();
  void list_pixels();
  void shade(const DrawJob& job);
  void write_color(const DrawJob& job) const;
  bool is_one_piece(int first) const;
  void write_depth() const;
  /// The color of a sample of the target.
  float* color_at(int x, int y) const { return canvas_.color + 4 * canvas_.index(x - x_, y - y_); }
  int run_of(int triangle) const;

  int x_ = 0, y_ = 0;  ///< the tile's first sample in the target
  Canvas canvas_;
  std::unique_ptr<Samples> samples_;
  std::vector<int32_t> records_;
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
