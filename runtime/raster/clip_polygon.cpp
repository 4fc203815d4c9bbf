// SPDX-License-Identifier: Apache-2.0
#include "runtime/raster/clip_polygon.h"

#include "runtime/lanes/lanes.h"

namespace isoshade::raster {
namespace {

/// In double, so that a far end does not cancel a near one a million times smaller; equal values give that value.
float mix(float a, float b, double t) { return static_cast<float>(a * (1.0 - t) + b * t); }

/// Where the edge from `in` to `out` meets the plane. Always called in that direction, so that both triangles at an
/// edge get the same vertex.
ClipVertex cut(Plane plane, const ClipVertex& in, double in_distance, const ClipVertex& out,
               double out_distance) {
  const double t = in_distance / (in_distance - out_distance);
  ClipVertex result;
  result.index = made_by_clipping;
  result.point = {mix(in.point.x, out.point.x, t), mix(in.point.y, out.point.y, t),
                  mix(in.point.z, out.point.z, t), mix(in.point.w, out.point.w, t)};
  // On the near plane z equals w exactly, because depth is 1 there. The one that is constant along the edge is exact.
  if (plane == near_plane) {
    if (in.point.w == out.point.w)
      result.point.z = result.point.w;
    else
      result.point.w = result.point.z;
  }
  for (size_t i = 0; i < result.attributes.size(); ++i)
    result.attributes[i] = lanes::from_bits_normal(lanes::bits(mix(in.attributes[i], out.attributes[i], t)));
  return result;
}

Polygon cut(const Viewport& viewport, Plane plane, const Polygon& polygon) {
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

bool finite(float x) { return (lanes::bits_nonnan(x) & lanes::exponent_bits) != lanes::exponent_bits; }

}  // namespace

bool clip(const Viewport& viewport, Outside outside, Polygon& polygon) {
  for (const Plane plane : planes)
    if (outside & plane) polygon = cut(viewport, plane, polygon);
  for (int i = 0; i < polygon.count; ++i) {
    const Point& p = polygon.vertices[i].point;
    if (!finite(p.x) || !finite(p.y) || !finite(p.z) || !Viewport::is_divisible(p)) return false;
    polygon.corners[i] = viewport.project(p);
  }
  return true;
}

}  // namespace isoshade::raster
