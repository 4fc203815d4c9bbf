// SPDX-License-Identifier: Apache-2.0
// Where the vertices of a view lie on the pixel grid, and which planes they lie outside of.
#pragma once

#include <cstdint>

#include "runtime/raster/triangle.h"

namespace isoshade::raster {

/// A position in clip space.
struct Point {
  float x, y, z, w;
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
inline constexpr Plane planes[] = {near_plane, far_plane, right_plane, left_plane, bottom_plane, top_plane};
inline constexpr Outside unusable = 64;  ///< not finite, or too near to the eye for the division

using functions::Decision, functions::decide;
using Culling = functions::CullingOf<int>;

/// A vertex outside of a plane has `x` = not_inside and its Outside as `y`.
using Corner = functions::CornerOf<int32_t>;
inline constexpr int32_t not_inside = 1 << 30;

inline constexpr float units = functions::units_of_pixel;
inline constexpr float farthest = functions::farthest_position;

class Viewport {
 public:
  Viewport() = default;
  Viewport(int width, int height);

  ISOSHADE_INLINE Box pixels() const { return pixels_; }

  /// Not negative inside.
  double distance(Plane plane, const Point& p) const;
  Outside classify(const Point& p) const;

  /// Where classify() gives 0, but not everywhere where it does: the guard planes are taken a little nearer, so that no
  /// rounding in float can lead beyond those that classify() computes in double.
  template <class F>
  ISOSHADE_INLINE lanes::bool_of<F> is_well_inside(F x, F y, F z, F w) const {
    return functions::is_inside(x, y, z, w, {F(near_.right), F(near_.left), F(near_.bottom), F(near_.top)});
  }
  /// What is_well_inside() compares with.
  const functions::GuardPlanes<float>& near_planes() const { return near_; }
  /// A little farther than those of classify(): no rounding in float can lead from beyond these to this side of those.
  functions::GuardPlanes<float> far_planes() const;

  /// Whether a point in front of the eye can be divided by its w.
  static bool is_divisible(const Point& p);

  /// For a point inside all planes; otherwise the result has no meaning.
  template <class F>
  ISOSHADE_INLINE functions::CornerOf<lanes::int_of<F>> project(F x, F y, F z, F w) const {
    return functions::project(x, y, z, w, F(half_width_), F(half_height_));
  }
  Corner project(const Point& p) const { return project<float>(p.x, p.y, p.z, p.w); }

 private:
  Box pixels_{};
  float half_width_ = 0, half_height_ = 0;
  double right_ = 0, left_ = 0, bottom_ = 0, top_ = 0;  ///< the guard planes: x or y in units of w
  functions::GuardPlanes<float> near_{};                ///< a little nearer
};

}  // namespace isoshade::raster
