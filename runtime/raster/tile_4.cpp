// SPDX-License-Identifier: Apache-2.0
#include "runtime/raster/tile_lanes.h"

namespace isoshade::raster::detail {

void rasterize_tile_4(const int32_t* triangles, const int32_t* which, int count, int x, int y, Tile& tile) {
  rasterize<4>(triangles, which, count, x, y, tile);
}

}  // namespace isoshade::raster::detail
