// SPDX-License-Identifier: Apache-2.0
#include "runtime/raster/bins.h"

#include <algorithm>
#include <utility>

#include "compiler/lower/frame_layout.h"
#include "runtime/raster/tile.h"
#include "runtime/raster/triangle.h"

namespace isoshade::raster {
namespace {

constexpr size_t least_part = 2048;  ///< triangles that are worth a task

constexpr int tiles_over(int first, int last) { return (last - first) / tile_size + 1; }

}  // namespace

TileGrid::TileGrid(const Box& over)
    : area(over), columns(tiles_over(over.x0, over.x1)), rows(tiles_over(over.y0, over.y1)) {}

int TileGrid::x(int tile) const { return area.x0 + tile % columns * tile_size; }
int TileGrid::y(int tile) const { return area.y0 + tile / columns * tile_size; }

void Bins::list(std::span<const int32_t> triangles, int first, int count, const TileGrid& grid, Part& part) {
  part.entries.clear();
  part.places.assign(static_cast<size_t>(grid.count()), 0);
  const auto enter = [&](int tile, int triangle) {
    ++part.places[static_cast<size_t>(tile)];
    part.entries.push_back({tile, triangle});
  };
  for (int i = first; i < first + count; ++i) {
    const Triangle triangle = triangle_at(triangles.data(), i);
    const Box box = bounds(triangle).within(grid.area);
    if (box.empty()) continue;
    const Box tiles{(box.x0 - grid.area.x0) / tile_size, (box.y0 - grid.area.y0) / tile_size,
                    (box.x1 - grid.area.x0) / tile_size, (box.y1 - grid.area.y0) / tile_size};
    if (tiles.x0 == tiles.x1 && tiles.y0 == tiles.y1) {
      enter(tiles.y0 * grid.columns + tiles.x0, i);
      continue;
    }
    const Edges edges(triangle);
    for (int y = tiles.y0; y <= tiles.y1; ++y)
      for (int x = tiles.x0; x <= tiles.x1; ++x) {
        const int tile = y * grid.columns + x;
        if (edges.reach(box_at(grid.x(tile), grid.y(tile), tile_size, tile_size))) enter(tile, i);
      }
  }
}

void Bins::sort(std::span<const int32_t> triangles, const TileGrid& grid, threads::Workers& workers) {
  const size_t count = triangles.size() / lower::triangle_word::stride;
  const size_t tasks = std::min(count / least_part + 1, static_cast<size_t>(2 * workers.count()));
  if (parts_.size() < tasks) parts_.resize(tasks);
  const std::span parts = std::span(parts_).first(tasks);
  workers.for_each(tasks, [&](size_t i) {
    const size_t first = count * i / tasks, end = count * (i + 1) / tasks;
    list(triangles, static_cast<int>(first), static_cast<int>(end - first), grid, parts[i]);
  });

  // A tile takes the triangles of each part in turn.
  begins_.resize(static_cast<size_t>(grid.count()) + 1);
  uint32_t next = 0;
  for (size_t tile = 0; tile < static_cast<size_t>(grid.count()); ++tile) {
    begins_[tile] = next;
    for (Part& part : parts) next += std::exchange(part.places[tile], next);
  }
  begins_.back() = next;

  triangles_.resize(next);
  workers.for_each(tasks, [&](size_t i) {
    Part& part = parts[i];
    for (const Entry& entry : part.entries)
      triangles_[part.places[static_cast<size_t>(entry.tile)]++] = entry.triangle;
  });
}

std::vector<int32_t> triangles_within(std::span<const int32_t> triangles, const Box& area) {
  constexpr size_t stride = lower::triangle_word::stride;
  std::vector<int32_t> selected;
  for (size_t i = 0; i < triangles.size() / stride; ++i) {
    const Triangle triangle = triangle_at(triangles.data(), static_cast<int>(i));
    if (bounds(triangle).within(area).empty() || !Edges(triangle).reach(area)) continue;
    selected.insert(selected.end(), triangle.words, triangle.words + stride);
  }
  return selected;
}

}  // namespace isoshade::raster
