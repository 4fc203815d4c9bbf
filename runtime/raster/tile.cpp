// SPDX-License-Identifier: Apache-2.0
#include "runtime/raster/tile.h"

#include <algorithm>

namespace isoshade::raster {

void Tile::clear() {
  std::fill_n(triangles, tile_pixels, -1);
  std::fill_n(depth, tile_pixels, 0.0f);
}

int rasterizer_lanes() {
  static const int lanes = [] {
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
      return 16;
    return __builtin_cpu_supports("avx2") ? 8 : 4;
  }();
  return lanes;
}

void rasterize_tile(const int32_t* triangles, std::span<const int32_t> which, int x, int y, Tile& tile) {
  const int count = static_cast<int>(which.size());
  switch (rasterizer_lanes()) {
    case 16: return detail::rasterize_tile_16(triangles, which.data(), count, x, y, tile);
    case 8: return detail::rasterize_tile_8(triangles, which.data(), count, x, y, tile);
    default: return detail::rasterize_tile_4(triangles, which.data(), count, x, y, tile);
  }
}

int list_candidates(const int32_t* triangles, std::span<const int32_t> which, int x, int y, const Box& area,
                    Tile& tile, Candidates& candidates) {
  const int count = static_cast<int>(which.size());
  candidates.count = 0;
  switch (rasterizer_lanes()) {
    case 16: return detail::list_candidates_16(triangles, which.data(), count, x, y, area, tile, candidates);
    case 8: return detail::list_candidates_8(triangles, which.data(), count, x, y, area, tile, candidates);
    default: return detail::list_candidates_4(triangles, which.data(), count, x, y, area, tile, candidates);
  }
}

void draw_candidates(const Candidates& candidates, bool over, Tile& tile) {
  for (int i = 0; i < candidates.count; ++i) {
    const int place = candidates.place[i];
    // A candidate before this one may have been drawn there.
    if (candidates.drawn[i] == 0 || !(over || candidates.depth[i] > tile.depth[place])) continue;
    tile.depth[place] = candidates.depth[i];
    tile.triangles[place] = candidates.triangle[i];
  }
}

}  // namespace isoshade::raster
