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

namespace image_record = interface::image_record;
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

/// Where an image of a post begins in its layers.
int32_t& first_of(std::span<int32_t> records, int image) {
  return records[static_cast<size_t>(image * lower::image_word::stride + lower::image_word::first)];
}

/// The arrays of a post with layers and records of its own.
void copy_buffers(const TilePost& post, const std::vector<int32_t>& records, const BufferView& layers,
                  BufferView (&buffers)[std::size(lower::frame_buffers)]) {
  std::copy_n(post.buffers, std::size(lower::frame_buffers), buffers);
  buffers[static_cast<size_t>(lower::FrameBuffer::layer_records)].data = records.data();
  buffers[static_cast<size_t>(lower::FrameBuffer::layers)] = layers;
}

}  // namespace

std::optional<EmptyPixel> empty_pixel(const backends::View& view, std::span<const TilePost> posts, int side) {
  float color[4];
  std::copy_n(view.background, 4, color);
  bool finite = backends::is_finite(color);
  for (const TilePost& post : posts) {
    if (!post.keeps_background_plain) return std::nullopt;
    const float sample[] = {0.0f, color[0], color[1], color[2], color[3]};  // the depth first
    std::vector<int32_t> records(post.records.begin(), post.records.end());
    first_of(records, image_record::depth) = 0;
    first_of(records, image_record::color) = 1;
    BufferView buffers[std::size(lower::frame_buffers)];
    copy_buffers(post, records, {sample, std::size(sample)}, buffers);
    post.kernel.post(buffers, 0, 0, 1, color);
    finite = backends::is_finite(color) && finite;
  }
  EmptyPixel pixel{{}, finite};
  backends::resolve_color(color, side, pixel.color);
  return pixel;
}

Canvas TilePainter::canvas_of(const DrawJob& job, int tile) {
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
  ++counts_.tiles;
  canvas_ = canvas_of(job, tile);
  if (job.skips_tiles && job.bins.of(tile).empty()) return paint_empty(job, tile);
  if (job.filled != nullptr) job.filled[tile] = 0;
  collect(job, tile);
  paint_opaque(job);
  blend(job, tile);
  return finish(job);
}

bool TilePainter::paint_empty(const DrawJob& job, int tile) {
  ++counts_.empty;
  if (job.empty == nullptr) {
    fill_background(job);
    return finish(job);
  }
  if (std::exchange(job.filled[tile], 1) != 0)
    ++counts_.kept;
  else
    fill_pixels(job);
  return job.empty->is_finite;
}

bool TilePainter::finish(const DrawJob& job) {
  if (!job.view.target.has_color) return true;
  bool finite = is_finite();
  for (const TilePost& post : job.posts) finite = process(post, job) && finite;
  if (job.side > 1) resolve(job);
  return finite;
}

void TilePainter::fill_background(const DrawJob& job) const {
  for (int y = 0; y < canvas_.height; ++y) {
    fill_color(job.view.background, canvas_.width, canvas_.color + 4 * canvas_.index(0, y));
    std::fill_n(canvas_.depth + canvas_.index(0, y), canvas_.width, 0.0f);
  }
}

void TilePainter::fill_pixels(const DrawJob& job) const {
  const int x = (x_ - job.grid.area.x0) / job.side, y = (y_ - job.grid.area.y0) / job.side;
  const int width = canvas_.width / job.side;
  for (int row = 0; row < canvas_.height / job.side; ++row) {
    const size_t first = static_cast<size_t>(y + row) * static_cast<size_t>(job.width) + static_cast<size_t>(x);
    if (job.color != nullptr) fill_color(job.empty->color, width, job.color + 4 * first);
    std::fill_n(job.depth + first, width, 0.0f);
  }
}

/// Runs a post over the samples of the tile, in place. Returns whether what it made is finite.
bool TilePainter::process(const TilePost& post, const DrawJob& job) {
  BufferView own[std::size(lower::frame_buffers)];
  const BufferView* buffers = post.buffers;
  if (job.side > 1) {
    records_.assign(post.records.begin(), post.records.end());
    copy_buffers(post, records_, {samples_->color, sizeof(Samples) / sizeof(float)}, own);
    buffers = own;
  }
  for (int y = 0; y < canvas_.height; ++y) {
    if (job.side > 1) {
      // A program finds its sample by its place in the whole picture: each row of it would begin there.
      const int64_t place = static_cast<int64_t>(y_ + y) * job.view.target.width + x_;
      const auto row = static_cast<int64_t>(canvas_.index(0, y));
      first_of(records_, image_record::depth) = static_cast<int32_t>((samples_->depth - samples_->color) + row - place);
      first_of(records_, image_record::color) = static_cast<int32_t>(4 * (row - place));
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
  pixels_.sort(tile_, x_, y_, job.skips_tiles, counts_);
  shade(job);
  pixels_.write(tile_, job.view.background, canvas_);
}

void TilePainter::collect(const DrawJob& job, int tile) {
  const std::span<const int32_t> listed = opaque_of(job, job.bins.of(tile));
  tile_.clear();
  rasterize(job, listed);
  pixels_.begin(job.triangles.data(), listed);  // their records are in the cache now
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
      pixels_.x[next] = found.x[i];
      pixels_.y[next] = found.y[i];
      pixels_.triangle[next] = found.triangle[i];
      std::copy_n(color_at(found.x[i], found.y[i]), 4, pixels_.color + 4 * next);
      ++next;
    }
    layer.clear();
    if (next == 0) continue;
    kernel.blend(job.buffers, first.object(), job.frame.light_count, next, pixels_.x, pixels_.y, pixels_.triangle,
                 pixels_.color);
    for (int i = 0; i < next; ++i)
      std::copy_n(pixels_.color + 4 * i, 4, color_at(pixels_.x[i], pixels_.y[i]));
  }
}

// One call takes pixels of one object, so that its parameters are uniform.
void TilePainter::shade(const DrawJob& job) {
  for (const SortedPixels::Run& run : pixels_.runs()) {
    if (run.begin == run.end) continue;
    const Kernel& kernel = *job.kernels[backends::pixel_program_of(job.frame, run.object)];
    kernel.pixel(job.buffers, run.object, job.frame.light_count, run.end - run.begin, pixels_.x + run.begin,
                 pixels_.y + run.begin, pixels_.triangle + run.begin, pixels_.color + 4 * run.begin);
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

}  // namespace isoshade::cpu
