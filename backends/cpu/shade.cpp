// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/shade.h"

#include <algorithm>
#include <climits>
#include <cstring>
#include <utility>

#include "backends/resolve.h"
#include "backends/shared.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/raster/triangle.h"

namespace isoshade::cpu {
namespace {

using raster::tile_pixels;
using raster::tile_size;

constexpr int nothing = -1;  ///< no triangle

/// The triangles of a tile's list that are opaque.
std::span<const int32_t> opaque_of(const DrawJob& job, std::span<const int32_t> listed) {
  if (listed.empty() || listed.back() < job.opaque) return listed;
  return listed.first(static_cast<size_t>(std::ranges::lower_bound(listed, job.opaque) - listed.begin()));
}

/// Copies a row of pixels to each row of an image.
void copy_rows(const float* from, size_t from_stride, float* to, size_t to_stride, size_t count, int rows) {
  for (int y = 0; y < rows; ++y)
    std::memcpy(to + static_cast<size_t>(y) * to_stride, from + static_cast<size_t>(y) * from_stride, count * sizeof(float));
}

void fill_color(const float (&color)[4], float* row, int width) {
  for (int x = 0; x < width; ++x) std::memcpy(row + 4 * x, color, sizeof color);
}

}  // namespace

TilePainter::Canvas TilePainter::canvas_of(const DrawJob& job, int tile) {
  x_ = job.grid.x(tile);
  y_ = job.grid.y(tile);
  const raster::Box& area = job.grid.area;
  const int width = std::min(tile_size, area.x1 + 1 - x_), height = std::min(tile_size, area.y1 + 1 - y_);
  if (job.side > 1) {
    if (!samples_) samples_ = std::make_unique<Samples>();
    return {samples_->color, samples_->depth, static_cast<size_t>(width), width, height};
  }
  const auto stride = static_cast<size_t>(job.width);
  const size_t first = static_cast<size_t>(y_ - area.y0) * stride + static_cast<size_t>(x_ - area.x0);
  return {job.view.target.has_color ? job.color + 4 * first : nullptr, job.depth + first, stride, width, height};
}

bool TilePainter::paint(const DrawJob& job, int tile) {
  canvas_ = canvas_of(job, tile);
  collect(job, tile);
  const bool is_opaque = static_cast<size_t>(job.opaque) * lower::triangle_word::stride == job.triangles.size();
  if (runs_.empty() && job.side > 1 && is_opaque && job.posts.empty()) {
    fill_pixels(job);
    return true;
  }
  if (runs_.empty())
    leave_blank(job, tile);
  else
    paint_opaque(job);
  if (job.blank != nullptr) job.blank[tile] = runs_.empty() && is_opaque;
  if (!is_opaque) blend(job, tile);
  if (!job.view.target.has_color) return true;
  bool finite = is_finite();
  for (const TilePost& post : job.posts) finite = process(post, job) && finite;
  if (job.side > 1) resolve(job);
  return finite;
}

void TilePainter::leave_blank(const DrawJob& job, int tile) const {
  if (job.blank == nullptr || job.blank[tile] == 0) fill_background(job);
}

void TilePainter::fill_background(const DrawJob& job) const {
  for (int y = 0; y < canvas_.height; ++y) {
    if (job.view.target.has_color) fill_color(job.view.background, canvas_.color + 4 * canvas_.index(0, y), canvas_.width);
    std::fill_n(canvas_.depth + canvas_.index(0, y), canvas_.width, 0.0f);
  }
}

void TilePainter::fill_pixels(const DrawJob& job) const {
  const int x = (x_ - job.grid.area.x0) / job.side, y = (y_ - job.grid.area.y0) / job.side;
  for (int row = 0; row < canvas_.height / job.side; ++row) {
    const size_t first = static_cast<size_t>(y + row) * static_cast<size_t>(job.width) + static_cast<size_t>(x);
    fill_color(job.background, job.color + 4 * first, canvas_.width / job.side);
    std::fill_n(job.depth + first, canvas_.width / job.side, 0.0f);
  }
}

/// Runs a post over the samples of the tile, in place. Returns whether what it made is finite.
bool TilePainter::process(const TilePost& post, const DrawJob& job) {
  namespace word = lower::image_word;
  BufferView buffers[std::size(lower::frame_buffers)];
  std::copy_n(post.buffers, std::size(lower::frame_buffers), buffers);
  BufferView& layers = buffers[static_cast<size_t>(lower::FrameBuffer::layers)];
  if (job.side > 1) {
    records_.assign(post.records.begin(), post.records.end());
    buffers[static_cast<size_t>(lower::FrameBuffer::layer_records)].data = records_.data();
    layers = {samples_->color, sizeof(Samples) / sizeof(float)};
  }
  const auto first_of = [&](int image) -> int32_t& {
    return records_[static_cast<size_t>((1 + image) * word::stride + word::first)];
  };
  for (int y = 0; y < canvas_.height; ++y) {
    if (job.side > 1) {
      // A program finds its sample by its place in the whole picture: each row of it would begin there.
      const int64_t place = static_cast<int64_t>(y_ + y) * job.view.target.width + x_;
      const auto row = static_cast<int64_t>(canvas_.index(0, y));
      first_of(0) = static_cast<int32_t>((samples_->depth - samples_->color) + row - place);
      first_of(1) = static_cast<int32_t>(4 * (row - place));
    }
    post.kernel.post(buffers, x_, y_ + y, canvas_.width, canvas_.color + 4 * canvas_.index(0, y));
  }
  return is_finite();
}

void TilePainter::resolve(const DrawJob& job) {
  backends::resolve(canvas_.color, canvas_.depth, canvas_.width, canvas_.height, job.side);
  const auto columns = static_cast<size_t>(canvas_.width / job.side), stride = static_cast<size_t>(job.width);
  const int rows = canvas_.height / job.side;
  const size_t first = static_cast<size_t>((y_ - job.grid.area.y0) / job.side) * stride +
                       static_cast<size_t>((x_ - job.grid.area.x0) / job.side);
  copy_rows(canvas_.color, 4 * columns, job.color + 4 * first, 4 * stride, 4 * columns, rows);
  copy_rows(canvas_.depth, columns, job.depth + first, stride, columns, rows);
}

bool TilePainter::is_finite() const {
  for (int y = 0; y < canvas_.height; ++y)
    if (!backends::is_finite({canvas_.color + 4 * canvas_.index(0, y), size_t{4} * static_cast<size_t>(canvas_.width)}))
      return false;
  return true;
}

void TilePainter::paint_opaque(const DrawJob& job) {
  write_depth();
  if (!job.view.target.has_color) return;
  if (canvas_.width < tile_size || canvas_.height < tile_size)
    for (int i = 0; i < tile_pixels; ++i)
      if (raster::tile_x(i) >= canvas_.width || raster::tile_y(i) >= canvas_.height) tile_.triangles[i] = nothing;
  segment();
  list_pixels();
  shade(job);
  write_color(job);
}

void TilePainter::collect(const DrawJob& job, int tile) {
  runs_.clear();
  const std::span<const int32_t> listed = opaque_of(job, job.bins.of(tile));
  if (listed.empty()) return;
  tile_.clear();
  rasterize(job, listed);
  for (const int32_t triangle : listed) {
    const int object = raster::triangle_at(job.triangles.data(), triangle).object();
    if (runs_.empty() || runs_.back().object != object) runs_.push_back({triangle, object, 0});
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

void TilePainter::blend(const DrawJob& job, int tile) {
  const int32_t* const triangles = job.triangles.data();
  std::span<const int32_t> listed = job.bins.of(tile).subspan(opaque_of(job, job.bins.of(tile)).size());
  if (listed.empty()) return;
  if (runs_.empty()) tile_.clear();
  bool changes_depth = false;
  while (!listed.empty()) {
    const raster::Triangle first = raster::triangle_at(triangles, listed.front());
    size_t count = 1;
    while (count < listed.size() && raster::triangle_at(triangles, listed[count]).object() == first.object()) ++count;
    blend_object(job, listed.first(count), first);
    changes_depth = changes_depth || !first.keeps_depth();
    listed = listed.subspan(count);
  }
  if (changes_depth) write_depth();
}

void TilePainter::blend_object(const DrawJob& job, std::span<const int32_t> listed, const raster::Triangle& first) {
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
void TilePainter::blend_candidates(const DrawJob& job, const raster::Candidates& found, const raster::Triangle& first) {
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
      std::copy_n(color_at(found.x[i], found.y[i]), 4, color_ + 4 * next);
      ++next;
    }
    layer.clear();
    if (next == 0) continue;
    kernel.blend(job.buffers, first.object(), job.frame.light_count, next, pixel_x_, pixel_y_, pixel_triangle_, color_);
    for (int i = 0; i < next; ++i)
      std::copy_n(color_ + 4 * i, 4, color_at(pixel_x_[i], pixel_y_[i]));
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
  int run_first = nothing, run_end = 0;  // the triangles of the run, or `nothing` alone
  const auto end_at = [&](int i) {
    if (run == nothing || begin == i) return;
    segments_.push_back({begin, i, run});
    runs_[static_cast<size_t>(run)].pixels += i - begin;
  };
  for (int i = 0; i < tile_pixels; ++i) {
    const int triangle = tile_.triangles[i];
    // The common cases: neighbours mostly show one triangle, or one object.
    if (triangle == last_triangle) continue;
    last_triangle = triangle;
    if (triangle >= run_first && triangle < run_end) continue;
    end_at(i);
    begin = i;
    run = triangle == nothing ? nothing : run_of(triangle);
    const auto next = static_cast<size_t>(run + 1);
    run_first = run == nothing ? nothing : runs_[static_cast<size_t>(run)].first_triangle;
    run_end = run == nothing ? 0 : next < runs_.size() ? runs_[next].first_triangle : INT_MAX;
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

void TilePainter::write_depth() const {
  for (int y = 0; y < canvas_.height; ++y) {
    float* depth = canvas_.depth + canvas_.index(0, y);
    for (int x = 0; x < canvas_.width; x += raster::block_size) {
      // The pixels of a block's row are stored one after the other.
      const int count = std::min(raster::block_size, canvas_.width - x);
      std::copy_n(tile_.depth + raster::tile_index(x, y), count, depth + x);
    }
  }
}

void TilePainter::write_color(const DrawJob& job) const {
  for (int y = 0; y < canvas_.height; ++y) {
    float* row = canvas_.color + 4 * canvas_.index(0, y);
    for (int x = 0; x < canvas_.width; x += raster::block_size) {
      const int first = raster::tile_index(x, y);
      const int count = std::min(raster::block_size, canvas_.width - x);
      if (count == raster::block_size && is_one_piece(first)) {
        std::memcpy(row + 4 * x, color_ + 4 * place_[first], 4 * raster::block_size * sizeof(float));
        continue;
      }
      for (int i = 0; i < count; ++i) {
        const float* color =
            tile_.triangles[first + i] == nothing ? job.view.background : color_ + 4 * place_[first + i];
        std::memcpy(row + 4 * (x + i), color, 4 * sizeof(float));
      }
    }
  }
}

/// Whether the pixels of a block's row are all covered and their colors lie one after the other.
bool TilePainter::is_one_piece(int first) const {
  bool whole = true;
  for (int i = 0; i < raster::block_size; ++i)
    whole &= tile_.triangles[first + i] != nothing && place_[first + i] == place_[first] + i;
  return whole;
}

}  // namespace isoshade::cpu
