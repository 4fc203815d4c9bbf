// SPDX-License-Identifier: Apache-2.0
#include "runtime/raster/clip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "compiler/lower/frame_layout.h"
#include "runtime/lanes/lanes.h"
#include "runtime/raster/triangle.h"

namespace isoshade::raster {
namespace {

constexpr int vertex_stride = lower::vertex_word::stride;
constexpr uint32_t not_yet_stored = ~0u;
constexpr float units = 256.0f;         // a pixel
constexpr float farthest = 2097152.0f;  // 2^21: the largest position in a record, in units
// The guard band in pixels. It is narrower before the first pixel: lavapipe computes the edge functions of triangles
// that end in the first 64 x 64 pixels with 39 bits, too few for some that begin beyond -2832. (Windows that begin
// elsewhere have a margin for that, see backends/vulkan/limits.h.)
constexpr float guard_before = max_before_image;
constexpr float guard = 8190.0f;

struct Point {
  float x, y, z, w;
};

/// A vertex as it stands in a record.
struct Corner {
  int32_t x, y;
  int32_t depth, inverse_w;  ///< float bits
};

/// A bit for each plane that a vertex lies outside of.
using Outside = uint8_t;
enum Plane : Outside {
  near_plane = 1,
  far_plane = 2,
  right_plane = 4,
  left_plane = 8,
  bottom_plane = 16,
  top_plane = 32
};
constexpr Plane planes[] = {near_plane, far_plane, right_plane, left_plane, bottom_plane, top_plane};
constexpr Outside unusable = 64;  ///< not finite, or too near to the eye for the division

bool finite(float x) { return (lanes::bits_nonnan(x) & lanes::exponent_bits) != lanes::exponent_bits; }

/// In double, so that a far end does not cancel a near one a million times smaller; equal values give that value.
float mix(float a, float b, double t) { return static_cast<float>(a * (1.0 - t) + b * t); }

/// To nearest, ties to even; |x| <= 2^21.
int32_t round_to_int(float x) {
  constexpr float to_whole = 12582912.0f;  // 1.5 * 2^23: its neighbours are whole numbers
  return lanes::to_int((x + to_whole) - to_whole);
}

class Viewport {
 public:
  Viewport(int width, int height)
      : width_(width),
        height_(height),
        half_width_(lanes::to_float(width) * 0.5f),
        half_height_(lanes::to_float(height) * 0.5f),
        right_(beyond(std::max(guard, lanes::to_float(width)) - half_width_, half_width_)),
        left_(beyond(guard_before + half_width_, half_width_)),
        bottom_(beyond(std::max(guard, lanes::to_float(height)) - half_height_, half_height_)),
        top_(beyond(guard_before + half_height_, half_height_)) {}

  Box pixels() const { return {0, 0, width_ - 1, height_ - 1}; }

  /// Not negative inside.
  double distance(Plane plane, const Point& p) const {
    switch (plane) {
      case near_plane: return static_cast<double>(p.w) - p.z;
      case far_plane: return p.z;
      case right_plane: return right_ * p.w - p.x;
      case left_plane: return left_ * p.w + p.x;
      case bottom_plane: return bottom_ * p.w + p.y;
      case top_plane: return top_ * p.w - p.y;
    }
    return 0;
  }

  Outside classify(const Point& p) const {
    if (!finite(p.x) || !finite(p.y) || !finite(p.z) || !finite(p.w)) return unusable;
    Outside outside = 0;
    for (const Plane plane : planes)
      if (distance(plane, p) < 0.0) outside |= plane;
    if (outside == 0 && !divisible(p)) return unusable;
    return outside;
  }

  static bool divisible(const Point& p) { return p.w > 0.0f && finite(1.0f / p.w); }

  /// For a point inside all planes; otherwise the result has no meaning.
  Corner project(const Point& p) const {
    const float x = p.x / p.w * half_width_ + half_width_;
    const float y = half_height_ - p.y / p.w * half_height_;
    const float z = p.z / p.w;
    const float above = z > 0.0f ? z : 0.0f;
    return {round_to_int(limit(x * units)), round_to_int(limit(y * units)),
            lanes::bits_nonnan(above < 1.0f ? above : 1.0f), lanes::bits(1.0f / p.w)};
  }

 private:
  static double beyond(float pixels, float half) { return static_cast<double>(pixels) / half; }
  /// Limits positions that rounding left slightly outside, and NaN.
  static float limit(float x) {
    const float above = x > -farthest ? x : -farthest;
    return above < farthest ? above : farthest;
  }

  int width_, height_;
  float half_width_, half_height_;
  double right_, left_, bottom_, top_;  ///< the guard planes: x or y in units of w
};

struct ClipVertex {
  Point point;
  uint32_t index;  ///< in the array of vertices, or not_yet_stored
  std::array<float, vertex_stride> attributes;
};

/// A triangle cut by six planes has nine corners. Rounding can make one edge cross a plane twice; in the worst case
/// each plane then adds half as many corners: 3, 4, 6, 9, 13, 19, 28.
constexpr int most_corners = 28;

struct Polygon {
  std::array<ClipVertex, most_corners> vertices;
  int count = 0;
  void add(const ClipVertex& vertex) { vertices[count++] = vertex; }
};

/// Where the edge from `in` to `out` meets the plane. Always called in that direction, so that both triangles at an
/// edge get the same vertex.
ClipVertex cut(Plane plane, const ClipVertex& in, double in_distance, const ClipVertex& out,
               double out_distance) {
  const double t = in_distance / (in_distance - out_distance);
  ClipVertex result;
  result.index = not_yet_stored;
  result.point = {mix(in.point.x, out.point.x, t), mix(in.point.y, out.point.y, t),
                  mix(in.point.z, out.point.z, t), mix(in.point.w, out.point.w, t)};
  // On the near plane z equals w exactly, because depth is 1 there. The one that is constant along the edge is exact.
  if (plane == near_plane) {
    if (in.point.w == out.point.w)
      result.point.z = result.point.w;
    else
      result.point.w = result.point.z;
  }
  for (int i = 0; i < vertex_stride; ++i)
    result.attributes[i] = lanes::from_bits_normal(lanes::bits(mix(in.attributes[i], out.attributes[i], t)));
  return result;
}

Polygon clip(const Viewport& viewport, Plane plane, const Polygon& polygon) {
  Polygon result;
  for (int i = 0; i < polygon.count; ++i) {
    const ClipVertex& a = polygon.vertices[i];
    const ClipVertex& b = polygon.vertices[i + 1 < polygon.count ? i + 1 : 0];
    const double a_distance = viewport.distance(plane, a.point);
    const double b_distance = viewport.distance(plane, b.point);
    const bool a_inside = a_distance >= 0.0;
    const bool b_inside = b_distance >= 0.0;
    if (a_inside) result.add(a);
    if (a_inside && !b_inside) result.add(cut(plane, a, a_distance, b, b_distance));
    if (b_inside && !a_inside) result.add(cut(plane, b, b_distance, a, a_distance));
  }
  return result;
}

class Assembler {
 public:
  Assembler(const Surface& surface, int width, int height, std::vector<float>& vertices,
            std::vector<int32_t>& triangles)
      : surface_(surface), viewport_(width, height), vertices_(vertices), triangles_(triangles) {}

  void run() {
    // Once a vertex, so that triangles that share it agree to the bit.
    const size_t count = surface_.clip.size() / 4;
    corners_.resize(count);
    outside_.resize(count);
    for (size_t i = 0; i < count; ++i) {
      corners_[i] = viewport_.project(point(i));
      outside_[i] = viewport_.classify(point(i));
    }
    for (size_t i = 0; i + 2 < surface_.indices.size(); i += 3) triangle(surface_.indices.subspan(i, 3));
  }

 private:
  Point point(size_t vertex) const {
    const float* p = surface_.clip.data() + 4 * vertex;
    return {p[0], p[1], p[2], p[3]};
  }

  void triangle(std::span<const uint32_t> indices) {
    const Outside a = outside_[indices[0]], b = outside_[indices[1]], c = outside_[indices[2]];
    if ((a | b | c) & unusable) return;
    if (a & b & c) return;
    if ((a | b | c) != 0) return clipped(indices, a | b | c);
    const uint32_t first = surface_.first_vertex;
    emit({corners_[indices[0]], corners_[indices[1]], corners_[indices[2]]},
         {first + indices[0], first + indices[1], first + indices[2]});
  }

  void clipped(std::span<const uint32_t> indices, Outside outside) {
    Polygon polygon;
    for (const uint32_t index : indices) {
      ClipVertex vertex{point(index), surface_.first_vertex + index, {}};
      std::copy_n(vertices_.begin() + static_cast<ptrdiff_t>(vertex.index) * vertex_stride, vertex_stride,
                  vertex.attributes.begin());
      polygon.add(vertex);
    }
    for (const Plane plane : planes)
      if (outside & plane) polygon = clip(viewport_, plane, polygon);

    std::array<Corner, most_corners> corners;
    for (int i = 0; i < polygon.count; ++i) {
      const Point& p = polygon.vertices[i].point;
      if (!finite(p.x) || !finite(p.y) || !finite(p.z) || !Viewport::divisible(p)) return;
      corners[i] = viewport_.project(p);
    }
    for (int i = 0; i < polygon.count; ++i) store(polygon.vertices[i]);
    for (int i = 2; i < polygon.count; ++i)
      emit({corners[0], corners[i - 1], corners[i]},
           {polygon.vertices[0].index, polygon.vertices[i - 1].index, polygon.vertices[i].index});
  }

  void store(ClipVertex& vertex) {
    if (vertex.index != not_yet_stored) return;
    vertex.index = static_cast<uint32_t>(vertices_.size() / vertex_stride);
    vertices_.insert(vertices_.end(), vertex.attributes.begin(), vertex.attributes.end());
  }

  bool is_culled(bool front) const {
    switch (surface_.state.cull) {
      case interface::Cull::none: return false;
      case interface::Cull::back: return !front;
      case interface::Cull::front: return front;
    }
    return false;
  }

  static int32_t depth_flag(interface::DepthTest test) {
    switch (test) {
      case interface::DepthTest::nearer: return 0;
      case interface::DepthTest::always: return lower::triangle_flag::over;
    }
    return 0;
  }

  static int32_t blend_flags(const Surface& surface) {
    if (!surface.blended) return 0;
    switch (surface.state.depth_write) {
      case interface::DepthWrite::off: return lower::triangle_flag::blended | lower::triangle_flag::keeps_depth;
      case interface::DepthWrite::on: return lower::triangle_flag::blended;
    }
    return 0;
  }

  /// `area`: of the triangle, doubled, in square units; positive.
  void move_away(std::array<Corner, 3>& corners, int64_t area) const {
    const DepthBias& bias = surface_.bias;
    const auto depth = [&](int i) { return static_cast<double>(lanes::from_bits_normal(corners[i].depth)); };
    const double z0 = depth(0), z1 = depth(1) - z0, z2 = depth(2) - z0;
    const double x1 = corners[1].x - corners[0].x, x2 = corners[2].x - corners[0].x;
    const double y1 = corners[1].y - corners[0].y, y2 = corners[2].y - corners[0].y;
    const double pixel = static_cast<double>(units) / static_cast<double>(area);
    const double across = std::abs(z1 * y2 - z2 * y1) * pixel, down = std::abs(z2 * x1 - z1 * x2) * pixel;
    const double slope = bias.slope * (across + down) + bias.constant;
    for (int i = 0; i < 3; ++i) {
      const double z = depth(i);
      const double moved = z - (slope + bias.relative * z);  // may be negative, or the triangle would tilt
      corners[i].depth = lanes::bits_nonnan(lanes::from_bits_normal(lanes::bits(static_cast<float>(moved))));
    }
  }

  void emit(std::array<Corner, 3> corners, std::array<uint32_t, 3> indices) {
    const auto& [a, b, c] = corners;
    const int64_t area =
        static_cast<int64_t>(b.x - a.x) * (c.y - a.y) - static_cast<int64_t>(b.y - a.y) * (c.x - a.x);
    if (area == 0) return;
    const bool front = (area < 0) != surface_.mirrored;  // y points down
    if (is_culled(front)) return;
    if (area < 0) {
      std::swap(corners[1], corners[2]);
      std::swap(indices[1], indices[2]);
    }
    const auto [left, right] = std::minmax({a.x, b.x, c.x});
    const auto [top, bottom] = std::minmax({a.y, b.y, c.y});
    if (centres_between(left, top, right, bottom).within(viewport_.pixels()).empty()) return;
    // The longest edge along an axis spans the bounds.
    const bool wide = right - left >= 1 << 15 || bottom - top >= 1 << 15;

    if (surface_.bias.is_set()) move_away(corners, std::abs(area));

    namespace word = lower::triangle_word;
    namespace flag = lower::triangle_flag;
    std::array<int32_t, word::stride> record;
    for (int i = 0; i < 3; ++i) {
      record[word::vertex + i] = static_cast<int32_t>(indices[i]);
      record[word::position + 2 * i] = corners[i].x;
      record[word::position + 2 * i + 1] = corners[i].y;
      record[word::depth + i] = corners[i].depth;
      record[word::inverse_w + i] = corners[i].inverse_w;
    }
    record[word::object] =
        (surface_.object << flag::bits) | depth_flag(surface_.state.depth) | (wide ? flag::wide : 0) |
        (front ? 0 : flag::back) | (surface_.cutout ? flag::cutout : 0) | blend_flags(surface_);
    triangles_.insert(triangles_.end(), record.begin(), record.end());
  }

  const Surface& surface_;
  const Viewport viewport_;
  std::vector<float>& vertices_;
  std::vector<int32_t>& triangles_;
  std::vector<Corner> corners_;
  std::vector<Outside> outside_;
};

}  // namespace

void clip_and_snap(const Surface& surface, int width, int height, std::vector<float>& vertices,
                   std::vector<int32_t>& triangles) {
  const lanes::FpGuard guard_floats;
  Assembler(surface, width, height, vertices, triangles).run();
}

}  // namespace isoshade::raster
