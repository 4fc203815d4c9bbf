// SPDX-License-Identifier: Apache-2.0
#include "runtime/raster/bins.h"

#include "runtime/raster/tile.h"
#include "runtime/raster/triangle.h"

namespace isoshade::raster {
namespace {

/// Whether some pixel of the tile is on the inner side of the edge.
bool reaches(const Edge& edge, int tile_x, int tile_y) {
  const int64_t x = tile_x * tile_size + (edge.step_x > 0 ? tile_size - 1 : 0);
  const int64_t y = tile_y * tile_size + (edge.step_y > 0 ? tile_size - 1 : 0);
  return edge.at_origin + edge.step_x * x + edge.step_y * y >= 0;
}

}  // namespace

TileGrid::TileGrid(int width, int height)
    : columns((width + tile_size - 1) / tile_size), rows((height + tile_size - 1) / tile_size) {}

Bins::Bins(std::span<const int32_t> triangles, int first, int count, int width, int height) {
  struct Entry {
    int tile;
    int triangle;
  };
  std::vector<Entry> entries;
  entries.reserve(static_cast<size_t>(count) + count / 4);

  const TileGrid grid(width, height);
  begins_.assign(static_cast<size_t>(grid.count()) + 1, 0);
  const auto enter = [&](int tile, int triangle) {
    ++begins_[static_cast<size_t>(tile) + 1];
    entries.push_back({tile, triangle});
  };
  for (int i = first; i < first + count; ++i) {
    const Triangle triangle = triangle_at(triangles.data(), i);
    const Box box = bounds(triangle).within({0, 0, width - 1, height - 1});
    if (box.empty()) continue;
    const Box tiles{box.x0 / tile_size, box.y0 / tile_size, box.x1 / tile_size, box.y1 / tile_size};
    if (tiles.x0 == tiles.x1 && tiles.y0 == tiles.y1) {
      enter(tiles.y0 * grid.columns + tiles.x0, i);
      continue;
    }
    const Edge edges[] = {edge_between(triangle, 0, 1), edge_between(triangle, 1, 2),
                          edge_between(triangle, 2, 0)};
    for (int y = tiles.y0; y <= tiles.y1; ++y)
      for (int x = tiles.x0; x <= tiles.x1; ++x)
        if (reaches(edges[0], x, y) && reaches(edges[1], x, y) && reaches(edges[2], x, y))
          enter(y * grid.columns + x, i);
  }

  for (size_t tile = 1; tile < begins_.size(); ++tile) begins_[tile] += begins_[tile - 1];
  std::vector<uint32_t> next(begins_.begin(), begins_.end() - 1);
  triangles_.resize(entries.size());
  for (const Entry& entry : entries) triangles_[next[entry.tile]++] = entry.triangle;
}

}  // namespace isoshade::raster
