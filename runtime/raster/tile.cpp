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

}  // namespace isoshade::raster
