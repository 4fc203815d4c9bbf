// SPDX-License-Identifier: Apache-2.0
#include "runtime/raster/reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "compiler/functions/interpolation.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/lanes/lanes.h"
#include "runtime/raster/clip_polygon.h"

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

/// Clips the triangles of a surface, one after the other.
class ReferenceClipper {
 public:
  ReferenceClipper(const Surface& surface, int width, int height, std::vector<float>& vertices,
                   std::vector<int32_t>& triangles)
      : surface_(surface), viewport_(width, height), vertices_(vertices), triangles_(triangles) {}

  void triangle(std::span<const uint32_t> indices) {
    Outside any = 0, all = static_cast<Outside>(~0u);
    Polygon polygon;
    for (const uint32_t index : indices) {
      const float* p = surface_.clip.data() + size_t{4} * index;
      ClipVertex vertex{{p[0], p[1], p[2], p[3]}, static_cast<int32_t>(surface_.first_vertex + index), {}};
      const auto record = vertices_.begin() + static_cast<ptrdiff_t>(vertex.index) * lower::vertex_word::stride;
      std::copy_n(record, lower::vertex_word::stride, vertex.attributes.begin());
      polygon.add(vertex);
      const Outside outside = viewport_.classify(vertex.point);
      any |= outside;
      all &= outside;
    }
    if ((any & unusable) || all != 0 || !clip(viewport_, any, polygon)) return;
    for (int i = 0; i < polygon.count; ++i) store(polygon.vertices[static_cast<size_t>(i)]);
    for (size_t i = 2; i < static_cast<size_t>(polygon.count); ++i) emit(polygon, {0, i - 1, i});
  }

 private:
  void store(ClipVertex& vertex) {
    if (vertex.index != made_by_clipping) return;
    vertex.index = static_cast<int32_t>(vertices_.size() / lower::vertex_word::stride);
    vertices_.insert(vertices_.end(), vertex.attributes.begin(), vertex.attributes.end());
  }

  void emit(const Polygon& polygon, std::array<size_t, 3> which) {
    const auto corner = [&](size_t k) -> const Corner& { return polygon.corners[which[k]]; };
    const Corner a = corner(0), b = corner(1), c = corner(2);
    const int64_t area =
        static_cast<int64_t>(b.x - a.x) * (c.y - a.y) - static_cast<int64_t>(b.y - a.y) * (c.x - a.x);
    const bool front = (area < 0) != surface_.mirrored;  // y points down
    if (area == 0 || surface_.state.cull == (front ? interface::Cull::front : interface::Cull::back)) return;
    if (area < 0) std::swap(which[1], which[2]);
    const auto [left, right] = std::minmax({a.x, b.x, c.x});
    const auto [top, bottom] = std::minmax({a.y, b.y, c.y});
    if (centres_between(left, top, right, bottom).within(viewport_.pixels()).empty()) return;
    const bool wide = right - left >= 1 << 15 || bottom - top >= 1 << 15;
    namespace flag = lower::triangle_flag;
    std::array<int32_t, word::stride> record{};
    std::array<float, 3> z;
    for (size_t k = 0; k < 3; ++k) {
      record[word::vertex + k] = polygon.vertices[which[k]].index;
      record[word::position + 2 * k] = corner(k).x;
      record[word::position + 2 * k + 1] = corner(k).y;
      z[k] = lanes::from_bits_normal(corner(k).depth);
      record[word::inverse_w + k] = corner(k).inverse_w;
    }
    const bool over = surface_.state.depth == interface::DepthTest::always;
    const bool keeps_depth = surface_.blended && surface_.state.depth_write == interface::DepthWrite::off;
    record[word::object] = (surface_.object << flag::bits) | (over ? flag::over : 0) | (wide ? flag::wide : 0) |
                           (front ? 0 : flag::back) | (surface_.cutout ? flag::cutout : 0) |
                           (surface_.blended ? flag::blended : 0) | (keeps_depth ? flag::keeps_depth : 0);
    if (surface_.bias.is_set()) {
      const auto difference = [](int32_t a, int32_t b) { return static_cast<float>(a - b); };
      const float z1 = z[1] - z[0], z2 = z[2] - z[0];
      const float x1 = difference(corner(1).x, corner(0).x), x2 = difference(corner(2).x, corner(0).x);
      const float y1 = difference(corner(1).y, corner(0).y), y2 = difference(corner(2).y, corner(0).y);
      // Rounded as functions::edge_wide does.
      const int64_t doubled = std::abs(area), part = int64_t{1} << 23;
      const float pixel = units / (static_cast<float>(doubled / part) * static_cast<float>(part) +
                                   static_cast<float>(doubled % part));
      const float slope = std::abs(z1 * y2 - z2 * y1) * pixel + std::abs(z2 * x1 - z1 * x2) * pixel;
      for (float& depth : z)
        depth = depth - (surface_.bias.slope * slope + surface_.bias.constant + surface_.bias.relative * depth);
    }
    for (size_t k = 0; k < 3; ++k) record[word::depth + k] = lanes::bits(z[k]);
    triangles_.insert(triangles_.end(), record.begin(), record.end());
  }

  const Surface& surface_;
  const Viewport viewport_;
  std::vector<float>& vertices_;
  std::vector<int32_t>& triangles_;
};

}  // namespace

void clip_reference(const Surface& surface, int width, int height, std::vector<float>& vertices,
                    std::vector<int32_t>& triangles) {
  const lanes::FpGuard guard_floats;
  ReferenceClipper clipper(surface, width, height, vertices, triangles);
  for (size_t i = 0; i + 2 < surface.indices.size(); i += 3) clipper.triangle(surface.indices.subspan(i, 3));
}

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
