// SPDX-License-Identifier: Apache-2.0
#include "runtime/raster/viewport.h"

#include <algorithm>

#include "runtime/raster/clip.h"

namespace isoshade::raster {
namespace {

// The guard band in pixels. It is narrower before the first pixel: lavapipe computes the edge functions of triangles
// that end in the first 64 x 64 pixels with 39 bits, too few for some that begin beyond -2832. (Windows that begin
// elsewhere have a margin for that, see backends/vulkan/limits.h.)
constexpr float guard_before = max_before_image;
constexpr float guard = 8190.0f;

bool finite(float x) { return (lanes::bits_nonnan(x) & lanes::exponent_bits) != lanes::exponent_bits; }

double beyond(float pixels, float half) { return static_cast<double>(pixels) / half; }

/// A little nearer or farther: rounding, here and in the product with w, changes it by at most 2^-23 of it.
float moved(double plane, int direction) { return static_cast<float>(plane * (1 + direction * 0x1p-20)); }

}  // namespace

Viewport::Viewport(int width, int height)
    : pixels_(box_at(0, 0, width, height)),
      half_width_(lanes::to_float(width) * 0.5f),
      half_height_(lanes::to_float(height) * 0.5f),
      right_(beyond(std::max(guard, lanes::to_float(width)) - half_width_, half_width_)),
      left_(beyond(guard_before + half_width_, half_width_)),
      bottom_(beyond(std::max(guard, lanes::to_float(height)) - half_height_, half_height_)),
      top_(beyond(guard_before + half_height_, half_height_)),
      near_{moved(right_, -1), moved(left_, -1), moved(bottom_, -1), moved(top_, -1)} {}

functions::GuardPlanes<float> Viewport::far_planes() const {
  return {moved(right_, 1), moved(left_, 1), moved(bottom_, 1), moved(top_, 1)};
}

double Viewport::distance(Plane plane, const Point& p) const {
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

Outside Viewport::classify(const Point& p) const {
  if (!finite(p.x) || !finite(p.y) || !finite(p.z) || !finite(p.w)) return unusable;
  Outside outside = 0;
  for (const Plane plane : planes)
    if (distance(plane, p) < 0.0) outside |= plane;
  if (outside == 0 && !is_divisible(p)) return unusable;
  return outside;
}

bool Viewport::is_divisible(const Point& p) { return p.w > 0.0f && finite(1.0f / p.w); }

}  // namespace isoshade::raster
