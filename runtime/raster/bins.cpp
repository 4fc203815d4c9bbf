// SPDX-License-Identifier: Apache-2.0
#include "runtime/raster/bins.h"

#include "runtime/raster/tile.h"
#include "runtime/raster/triangle.h"

namespace isoshade::raster {
namespace {

constexpr int tiles_over(int first, int last) { return (last - first) / tile_size + 1; }

}  // namespace

TileGrid::TileGrid(const Box& over)
    : area(over), columns(tiles_over(over.x0, over.x1)), rows(tiles_over(over.y0, over.y1)) {}

int TileGrid::x(int tile) const { return area.x0 + tile % columns * tile_size; }
int TileGrid::y(int tile) const { return area.y0 + tile / columns * tile_size; }

Bins::Bins(std::span<const int32_t> triangles, int first, int count, const TileGrid& grid) {
  struct Entry {
    int tile;
    int triangle;
  };
  std::vector<Entry> entries;
  entries.reserve(static_cast<size_t>(count) + count / 4);

  begins_.assign(static_cast<size_t>(grid.count()) + 1, 0);
  const auto enter = [&](int tile, int triangle) {
    ++begins_[static_cast<size_t>(tile) + 1];
    entries.push_back({tile, triangle});
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

  for (size_t tile = 1; tile < begins_.size(); ++tile) begins_[tile] += begins_[tile - 1];
  std::vector<uint32_t> next(begins_.begin(), begins_.end() - 1);
  triangles_.resize(entries.size());
  for (const Entry& entry : entries) triangles_[next[entry.tile]++] = entry.triangle;
}

}  // namespace isoshade::raster
