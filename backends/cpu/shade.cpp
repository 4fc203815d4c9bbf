// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/shade.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "backends/shared.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/raster/triangle.h"

namespace isoshade::cpu {
namespace {

using raster::tile_pixels;
using raster::tile_size;

constexpr int nothing = -1;  ///< no triangle

/// The index in the image, which has the size of the window, of a pixel of the target.
size_t place_in_image(const DrawJob& job, int x, int y) {
  const raster::Box& area = job.grid.area;
  return static_cast<size_t>(y - area.y0) * static_cast<size_t>(job.image.width) +
         static_cast<size_t>(x - area.x0);
}

/// The triangles of a tile's list that are opaque.
std::span<const int32_t> opaque_of(const DrawJob& job, std::span<const int32_t> listed) {
  if (listed.empty() || listed.back() < job.opaque) return listed;
  return listed.first(static_cast<size_t>(std::ranges::lower_bound(listed, job.opaque) - listed.begin()));
}

void fill_background(DrawJob& job, int x, int y, int width, int height) {
  for (int row = 0; row < height; ++row) {
    const size_t first = place_in_image(job, x, y + row);
    if (job.view.target.has_color) {
      float* color = job.image.rgba.data() + 4 * first;
      for (int i = 0; i < width; ++i) std::copy_n(job.view.background, 4, color + 4 * i);
    }
    std::fill_n(job.image.depth.data() + first, width, 0.0f);
  }
}

}  // namespace

void TilePainter::paint(DrawJob& job, int tile) {
  x_ = job.grid.x(tile);
  y_ = job.grid.y(tile);
  const int width = std::min(tile_size, job.grid.area.x1 + 1 - x_);
  const int height = std::min(tile_size, job.grid.area.y1 + 1 - y_);
  collect(job, tile);
  if (runs_.empty())
    fill_background(job, x_, y_, width, height);
  else
    paint_opaque(job, width, height);
  if (static_cast<size_t>(job.opaque) * lower::triangle_word::stride < job.triangles.size())
    blend(job, tile, width, height);
}

void TilePainter::paint_opaque(DrawJob& job, int width, int height) {
  write_depth(job, width, height);
  if (!job.view.target.has_color) return;
  if (width < tile_size || height < tile_size)
    for (int i = 0; i < tile_pixels; ++i)
      if (raster::tile_x(i) >= width || raster::tile_y(i) >= height) tile_.triangles[i] = nothing;
  segment();
  list_pixels();
  shade(job);
  write_color(job, width, height);
}

void TilePainter::collect(const DrawJob& job, int tile) {
  runs_.clear();
  for (const raster::Bins& bins : job.bins) {
    const std::span<const int32_t> listed = opaque_of(job, bins.of(tile));
    if (listed.empty()) continue;
    if (runs_.empty()) tile_.clear();
    rasterize(job, listed);
    for (const int32_t triangle : listed) {
      const int object = raster::triangle_at(job.triangles.data(), triangle).object();
      if (runs_.empty() || runs_.back().object != object) runs_.push_back({triangle, object, 0});
    }
  }
}

void TilePainter::rasterize(const DrawJob& job, std::span<const int32_t> listed) {
  const int32_t* const triangles = job.triangles.data();
  if (job.frame.cutouts.empty()) return raster::rasterize_tile(triangles, listed, x_, y_, tile_);
  while (!listed.empty()) {
    const raster::Triangle first = raster::triangle_at(triangles, listed.front());
    size_t count = 1;
    for (; count < listed.size(); ++count) {
      const raster::Triangle next = raster::triangle_at(triangles, listed[count]);
      if (next.cutout() != first.cutout() || (first.cutout() && next.object() != first.object())) break;
    }
    if (first.cutout())
      cut_out(job, listed.first(count), first);
    else
      raster::rasterize_tile(triangles, listed.first(count), x_, y_, tile_);
    listed = listed.subspan(count);
  }
}

void TilePainter::cut_out(const DrawJob& job, std::span<const int32_t> listed, const raster::Triangle& first) {
  if (!candidates_) candidates_ = std::make_unique<raster::Candidates>();
  raster::Candidates& found = *candidates_;
  const int object = first.object();
  const Kernel& kernel = *job.kernels[backends::cutout_program_of(job.frame, object)];
  while (!listed.empty()) {
    const int taken =
        raster::list_candidates(job.triangles.data(), listed, x_, y_, job.grid.area, tile_, found);
    if (found.count > 0) kernel.cutout(job.buffers, object, found.count, found.x, found.y, found.triangle, found.drawn);
    raster::draw_candidates(found, first.over(), tile_);
    listed = listed.subspan(static_cast<size_t>(taken));
  }
}

void TilePainter::blend(DrawJob& job, int tile, int width, int height) {
  const int32_t* const triangles = job.triangles.data();
  bool is_clear = !runs_.empty(), changes_depth = false;
  for (const raster::Bins& bins : job.bins) {
    std::span<const int32_t> listed = bins.of(tile).subspan(opaque_of(job, bins.of(tile)).size());
    if (!listed.empty() && !std::exchange(is_clear, true)) tile_.clear();
    while (!listed.empty()) {
      const raster::Triangle first = raster::triangle_at(triangles, listed.front());
      size_t count = 1;
      while (count < listed.size() && raster::triangle_at(triangles, listed[count]).object() == first.object()) ++count;
      blend_object(job, listed.first(count), first);
      changes_depth = changes_depth || !first.keeps_depth();
      listed = listed.subspan(count);
    }
  }
  if (changes_depth) write_depth(job, width, height);
}

void TilePainter::blend_object(DrawJob& job, std::span<const int32_t> listed, const raster::Triangle& first) {
  if (!candidates_) candidates_ = std::make_unique<raster::Candidates>();
  raster::Candidates& found = *candidates_;
  const int object = first.object();
  while (!listed.empty()) {
    const int taken =
        raster::list_candidates(job.triangles.data(), listed, x_, y_, job.grid.area, tile_, found);
    if (!first.cutout())
      std::fill_n(found.drawn, found.count, 1);
    else if (found.count > 0)
      job.kernels[backends::cutout_program_of(job.frame, object)]->cutout(job.buffers, object, found.count, found.x,
                                                                          found.y, found.triangle, found.drawn);
    blend_candidates(job, found, first);
    listed = listed.subspan(static_cast<size_t>(taken));
  }
}

// The candidates of a pixel are blended in their order: the first of each pixel, then the second of each, and so on.
void TilePainter::blend_candidates(DrawJob& job, const raster::Candidates& found, const raster::Triangle& first) {
  size_t count = 0;
  for (int i = 0; i < found.count; ++i) {
    if (found.drawn[i] == 0) continue;
    const auto layer = static_cast<size_t>(layers_at_[found.place[i]]++);
    if (layer == count && ++count > layers_.size()) layers_.emplace_back();
    layers_[layer].push_back(i);
  }
  for (int i = 0; i < found.count; ++i) layers_at_[found.place[i]] = 0;
  const Kernel& kernel = *job.kernels[backends::pixel_program_of(job.frame, first.object())];
  for (std::vector<int>& layer : std::span(layers_).first(count)) {
    int next = 0;
    for (const int i : layer) {
      const int place = found.place[i];
      if (!first.keeps_depth()) {
        // A candidate before this one may have been drawn there.
        if (!first.over() && !(found.depth[i] > tile_.depth[place])) continue;
        tile_.depth[place] = found.depth[i];
      }
      pixel_x_[next] = found.x[i];
      pixel_y_[next] = found.y[i];
      pixel_triangle_[next] = found.triangle[i];
      std::copy_n(job.image.rgba.data() + 4 * place_in_image(job, found.x[i], found.y[i]), 4, color_ + 4 * next);
      ++next;
    }
    layer.clear();
    if (next == 0) continue;
    kernel.blend(job.buffers, first.object(), job.frame.light_count, next, pixel_x_, pixel_y_, pixel_triangle_, color_);
    for (int i = 0; i < next; ++i)
      std::copy_n(color_ + 4 * i, 4, job.image.rgba.data() + 4 * place_in_image(job, pixel_x_[i], pixel_y_[i]));
  }
}

int TilePainter::run_of(int triangle) const {
  const auto after = std::upper_bound(runs_.begin(), runs_.end(), triangle,
                                      [](int t, const Run& run) { return t < run.first_triangle; });
  return static_cast<int>(after - runs_.begin()) - 1;
}

void TilePainter::segment() {
  segments_.clear();
  int begin = 0, run = nothing, last_triangle = nothing;
  const auto end_at = [&](int i) {
    if (run == nothing || begin == i) return;
    segments_.push_back({begin, i, run});
    runs_[static_cast<size_t>(run)].pixels += i - begin;
  };
  for (int i = 0; i < tile_pixels; ++i) {
    const int triangle = tile_.triangles[i];
    if (triangle == last_triangle) continue;  // the common case: neighbours mostly show one triangle
    last_triangle = triangle;
    const int next = triangle == nothing ? nothing : run_of(triangle);
    if (next == run) continue;
    end_at(i);
    begin = i;
    run = next;
  }
  end_at(tile_pixels);
}

void TilePainter::list_pixels() {
  int begin = 0;
  for (Run& run : runs_) begin += std::exchange(run.pixels, begin);
  for (const Segment& segment : segments_) {
    int& next = runs_[static_cast<size_t>(segment.run)].pixels;
    int place = next;
    for (int i = segment.begin; i < segment.end; ++i, ++place) {
      place_[i] = place;
      pixel_x_[place] = x_ + raster::tile_x(i);
      pixel_y_[place] = y_ + raster::tile_y(i);
      pixel_triangle_[place] = tile_.triangles[i];
    }
    next = place;
  }
}

// One call takes pixels of one object, so that its parameters are uniform.
void TilePainter::shade(const DrawJob& job) {
  int begin = 0;
  for (const Run& run : runs_) {
    if (run.pixels == begin) continue;
    const Kernel& kernel = *job.kernels[backends::pixel_program_of(job.frame, run.object)];
    kernel.pixel(job.buffers, run.object, job.frame.light_count, run.pixels - begin, pixel_x_ + begin,
                 pixel_y_ + begin, pixel_triangle_ + begin, color_ + 4 * begin);
    begin = run.pixels;
  }
}

void TilePainter::write_depth(DrawJob& job, int width, int height) const {
  for (int y = 0; y < height; ++y) {
    float* depth = job.image.depth.data() + place_in_image(job, x_, y_ + y);
    for (int x = 0; x < width; x += raster::block_size) {
      // The pixels of a block's row are stored one after the other.
      const int count = std::min(raster::block_size, width - x);
      std::copy_n(tile_.depth + raster::tile_index(x, y), count, depth + x);
    }
  }
}

void TilePainter::write_color(DrawJob& job, int width, int height) const {
  for (int y = 0; y < height; ++y) {
    const size_t first = place_in_image(job, x_, y_ + y);
    for (int x = 0; x < width; ++x) {
      const int i = raster::tile_index(x, y);
      const float* color = tile_.triangles[i] == nothing ? job.view.background : color_ + 4 * place_[i];
      std::memcpy(job.image.rgba.data() + 4 * (first + static_cast<size_t>(x)), color, 4 * sizeof(float));
    }
  }
}

}  // namespace isoshade::cpu
