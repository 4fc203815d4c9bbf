// SPDX-License-Identifier: Apache-2.0
// One tile of a view: which triangle each pixel shows, then its color.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "backends/backend.h"
#include "backends/cpu/canvas.h"
#include "backends/cpu/kernel.h"
#include "backends/cpu/sorted_pixels.h"
#include "runtime/raster/bins.h"
#include "runtime/raster/tile.h"

namespace isoshade::cpu {

/// A program of Stage::post that is run over each tile.
struct TilePost {
  const Kernel& kernel;
  const BufferView* buffers;
  std::span<const int32_t> records;  ///< lower::FrameBuffer::layer_records, for the whole picture
  bool keeps_background_plain;                ///< ScreenPass::keeps_background_plain
};

/// What each pixel of an empty tile becomes.
struct EmptyPixel {
  float color[4];
  bool is_finite;  ///< before and after each post
};
/// Nothing if the posts do not make the same of all pixels. The caller holds an FpGuard.
std::optional<EmptyPixel> empty_pixel(const backends::View& view, std::span<const TilePost> posts, int side);

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
  bool skips_tiles;                 ///< Skip::tiles
  /// Null: the posts are run over empty tiles, too.
  const EmptyPixel* empty;
  /// Of each tile: whether the image shows that it is empty already. Null if `empty` is.
  uint8_t* filled;
  /// Of the window in pixels, which is so wide; no color if the target has none.
  float* color;
  float* depth;
  int width;
  const raster::Bins& bins;
};

/// Draws tiles one after the other. One for each thread: it holds several hundred kilobytes.
class TilePainter {
 public:
  /// Returns whether every number of the color was finite, before and after each post.
  bool paint(const DrawJob& job, int tile);
  /// Of all tiles so far.
  const backends::TileCounts& counts() const { return counts_; }

 private:
  /// The samples of a tile, row by row, if a pixel has several.
  struct Samples {
    alignas(64) float color[4 * raster::tile_pixels];
    alignas(64) float depth[raster::tile_pixels];
  };

  void collect(const DrawJob& job, int tile);
  /// In the image, or in samples_ if a pixel has several.
  Canvas canvas_of(const DrawJob& job, int tile);
  bool paint_empty(const DrawJob& job, int tile);
  void paint_opaque(const DrawJob& job);
  void fill_background(const DrawJob& job) const;
  /// Writes EmptyPixel to the image.
  void fill_pixels(const DrawJob& job) const;
  /// Runs the posts and makes pixels of samples. Returns as paint().
  bool finish(const DrawJob& job);
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
  void shade(const DrawJob& job);
  void write_depth() const;
  /// The color of a sample of the target.
  float* color_at(int x, int y) const { return canvas_.color + 4 * canvas_.index(x - x_, y - y_); }

  int x_ = 0, y_ = 0;  ///< the tile's first sample in the target
  Canvas canvas_;
  std::unique_ptr<Samples> samples_;
  std::vector<int32_t> records_;
  raster::Tile tile_;
  std::unique_ptr<raster::Candidates> candidates_;  ///< made when a tile first has a cut-out
  SortedPixels pixels_;
  std::vector<std::vector<int>> layers_;  ///< candidates, a pixel at most once in each
  backends::TileCounts counts_;
  int layers_at_[raster::tile_pixels] = {};  ///< of each pixel in storage: used and left at 0 by blend_candidates()
};

}  // namespace isoshade::cpu
