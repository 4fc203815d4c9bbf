// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/sorted_pixels.h"

#include <algorithm>
#include <climits>
#include <cstring>
#include <utility>

#include "runtime/lanes/lanes.h"
#include "runtime/raster/triangle.h"

namespace isoshade::cpu {
namespace {

using raster::block_size;
using raster::tile_pixels;

constexpr int nothing = -1;  ///< no triangle

/// Whether all pixels of a block show triangles of [first, end).
bool are_within(const int32_t* triangles, int count, int first, int end) {
  using Ints = lanes::Int<4, 1>;
  auto outside = lanes::Bool<4, 1>(false);
  for (int i = 0; i < count; i += 4) {
    const Ints shown = lanes::load_lanes<Ints>(triangles + i);
    outside = outside | (shown < Ints(first)) | (shown >= Ints(end));
  }
  return !any(outside);
}

/// The colors of a block's row. Pixel by pixel, or compilers call memcpy.
void copy_row(const float* from, float* to) {
  for (int i = 0; i < block_size; ++i) std::memcpy(to + 4 * i, from + 4 * i, 4 * sizeof(float));
}

}  // namespace

void SortedPixels::begin(const int32_t* triangles, std::span<const int32_t> listed) {
  runs_.clear();
  for (const int32_t number : listed) {
    const int object = raster::triangle_at(triangles, number).object();
    if (runs_.empty() || runs_.back().object != object) runs_.push_back({number, object});
  }
}

SortedPixels::Range SortedPixels::range_of(int number) const {
  if (number == nothing) return {nothing, nothing, nothing + 1};
  const auto after = std::upper_bound(runs_.begin(), runs_.end(), number,
                                      [](int t, const Run& run) { return t < run.first_triangle; });
  const auto run = static_cast<int>(after - runs_.begin()) - 1;
  return {run, runs_[static_cast<size_t>(run)].first_triangle, after == runs_.end() ? INT_MAX : after->first_triangle};
}

void SortedPixels::append(int begin, int end, int run) {
  if (run == nothing || begin == end) return;
  segments_.push_back({begin, end, run});
  runs_[static_cast<size_t>(run)].end += end - begin;
}

void SortedPixels::find_segments(const raster::Tile& tile, int begin, int end) {
  int last = tile.triangles[begin];
  Range range = range_of(last);
  for (int i = begin + 1; i < end; ++i) {
    const int shown = tile.triangles[i];
    // The common cases: neighbours mostly show one triangle, or one object.
    if (shown == last) continue;
    last = shown;
    if (range.has(shown)) continue;
    append(begin, i, range.run);
    begin = i;
    range = range_of(shown);
  }
  append(begin, end, range.run);
}

void SortedPixels::find_blocks(const raster::Tile& tile, backends::TileCounts& counts) {
  Range range = range_of(nothing);
  for (int b = 0; b < block_count; ++b) {
    const int begin = b * block_pixels, end = begin + block_pixels;
    const int32_t* triangles = tile.triangles + begin;
    if (!range.has(*triangles)) range = range_of(*triangles);
    if (!are_within(triangles, block_pixels, range.first, range.end)) {
      shown_[b] = Shown::several;
      find_segments(tile, begin, end);
      ++counts.blocks;
    } else if (range.run == nothing) {
      shown_[b] = Shown::nothing;
    } else {
      shown_[b] = Shown::one_object;
      append(begin, end, range.run);
      ++counts.blocks;
      ++counts.blocks_of_one_object;
    }
  }
}

void SortedPixels::sort(const raster::Tile& tile, int first_x, int first_y, bool by_blocks, backends::TileCounts& counts) {
  segments_.clear();
  if (by_blocks) {
    find_blocks(tile, counts);
  } else {
    std::ranges::fill(shown_, Shown::several);
    find_segments(tile, 0, tile_pixels);
  }
  list_pixels(tile, first_x, first_y);
}

void SortedPixels::list_pixels(const raster::Tile& tile, int first_x, int first_y) {
  int next = 0;
  for (Run& run : runs_) {
    run.begin = next;
    next += std::exchange(run.end, next);
  }
  for (const Segment& segment : segments_) {
    int& place = runs_[static_cast<size_t>(segment.run)].end;
    if (shown_[segment.begin / block_pixels] == Shown::one_object) {
      place_[segment.begin] = place;
      const int left = first_x + raster::tile_x(segment.begin), top = first_y + raster::tile_y(segment.begin);
      for (int i = 0; i < block_pixels; ++i) {
        x[place + i] = left + i % block_size;
        y[place + i] = top + i / block_size;
      }
      std::copy_n(tile.triangles + segment.begin, block_pixels, triangle + place);
      place += block_pixels;
      continue;
    }
    for (int i = segment.begin; i < segment.end; ++i, ++place) {
      place_[i] = place;
      x[place] = first_x + raster::tile_x(i);
      y[place] = first_y + raster::tile_y(i);
      triangle[place] = tile.triangles[i];
    }
  }
}

void SortedPixels::write(const raster::Tile& tile, const float (&background)[4], const Canvas& canvas) const {
  for (int top = 0; top < canvas.height; ++top) {
    float* const row = canvas.color + 4 * canvas.index(0, top);
    for (int left = 0; left < canvas.width; left += block_size) {
      const int first = raster::tile_index(left, top), count = std::min(block_size, canvas.width - left);
      float* const to = row + 4 * left;
      switch (shown_[first / block_pixels]) {
        case Shown::several: write_row(tile, background, first, count, to); break;
        case Shown::nothing: fill_color(background, count, to); break;
        case Shown::one_object:
          // All of its pixels lie in the window, as others show nothing.
          copy_row(color + 4 * (place_[first & -block_pixels] + first % block_pixels), to);
          break;
      }
    }
  }
}

void SortedPixels::write_row(const raster::Tile& tile, const float (&background)[4], int first, int count, float* row) const {
  if (count == block_size && is_one_piece(tile, first)) {
    copy_row(color + 4 * place_[first], row);
    return;
  }
  for (int i = 0; i < count; ++i) {
    const float* const from = tile.triangles[first + i] == nothing ? background : color + 4 * place_[first + i];
    std::memcpy(row + 4 * i, from, 4 * sizeof(float));
  }
}

/// Whether the pixels of a block's row are all covered and their colors lie one after the other.
bool SortedPixels::is_one_piece(const raster::Tile& tile, int first) const {
  bool whole = true;
  for (int i = 0; i < block_size; ++i)
    whole &= tile.triangles[first + i] != nothing && place_[first + i] == place_[first] + i;
  return whole;
}

}  // namespace isoshade::cpu
