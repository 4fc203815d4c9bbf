// SPDX-License-Identifier: Apache-2.0
#include "runtime/raster/reference.h"

#include <algorithm>

#include "compiler/functions/interpolation.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::raster {
namespace {

namespace word = lower::triangle_word;

struct Position {
  int x, y;
};

/// Whether the pixel centre lies on the inner side of the edge. A centre on an edge belongs to the triangle whose left
/// or top edge it is.
bool inside(Position from, Position to, Position centre) {
  const int64_t dx = to.x - from.x;
  const int64_t dy = to.y - from.y;
  const int64_t edge = dx * (centre.y - from.y) - dy * (centre.x - from.x);
  const bool left = dy < 0;
  const bool top = dy == 0 && dx > 0;
  return edge > 0 || (edge == 0 && (left || top));
}

template <class Visit>
void cover(const int32_t* record, const Box& area, const Visit& visit) {
  Position corner[3];
  float z[3];
  for (int i = 0; i < 3; ++i) {
    corner[i] = {record[word::position + 2 * i], record[word::position + 2 * i + 1]};
    z[i] = lanes::from_bits(record[word::depth + i]);
  }
  const bool wide = record[word::object] & lower::triangle_flag::wide;

  const auto [left, right] = std::minmax({corner[0].x, corner[1].x, corner[2].x});
  const auto [top, bottom] = std::minmax({corner[0].y, corner[1].y, corner[2].y});
  const int first_x = std::max(area.x0, left >> 8), last_x = std::min(area.x1, right >> 8);
  const int first_y = std::max(area.y0, top >> 8), last_y = std::min(area.y1, bottom >> 8);
  for (int y = first_y; y <= last_y; ++y)
    for (int x = first_x; x <= last_x; ++x) {
      const Position centre{256 * x + 128, 256 * y + 128};
      if (!inside(corner[0], corner[1], centre) || !inside(corner[1], corner[2], centre) ||
          !inside(corner[2], corner[0], centre))
        continue;
      const auto edges = functions::edge_functions<float>(corner[0].x, corner[0].y, corner[1].x, corner[1].y,
                                                          corner[2].x, corner[2].y, wide, centre.x, centre.y);
      visit(x, y, functions::interpolate_depth<float>(edges, z[0], z[1], z[2]));
    }
}

void draw(const int32_t* record, int id, const Box& area, std::span<int32_t> ids, std::span<float> depth,
          const IsDrawn& is_drawn) {
  const bool over = record[word::object] & lower::triangle_flag::over;
  const bool cutout = record[word::object] & lower::triangle_flag::cutout;
  const auto width = static_cast<size_t>(area.x1 - area.x0 + 1);
  cover(record, area, [&](int x, int y, float nearness) {
    const size_t pixel = static_cast<size_t>(y - area.y0) * width + static_cast<size_t>(x - area.x0);
    if (!over && !(nearness > depth[pixel])) return;
    if (cutout && !is_drawn(id, x, y)) return;
    depth[pixel] = nearness;
    ids[pixel] = id;
  });
}

}  // namespace

void rasterize_reference(std::span<const int32_t> triangles, const Box& area, std::span<int32_t> ids,
                         std::span<float> depth, const IsDrawn& is_drawn) {
  const lanes::FpGuard guard_floats;
  std::fill(ids.begin(), ids.end(), -1);
  std::fill(depth.begin(), depth.end(), 0.0f);
  const int count = static_cast<int>(triangles.size() / word::stride);
  for (int i = 0; i < count; ++i)
    draw(triangles.data() + static_cast<size_t>(i) * word::stride, i, area, ids, depth, is_drawn);
}

void for_each_covered(const int32_t* triangle, const Box& area,
                      const std::function<void(int x, int y, float depth)>& visit) {
  const lanes::FpGuard guard_floats;
  cover(triangle, area, visit);
}

}  // namespace isoshade::raster
