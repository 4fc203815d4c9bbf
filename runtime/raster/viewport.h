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

/// A vertex as it stands in a triangle record; for float and int, or for lanes.
template <class Int>
struct CornerOf {
  Int x, y;
  Int depth, inverse_w;  ///< float bits
};
/// A vertex outside of a plane has `x` = not_inside and its Outside as `y`.
using Corner = CornerOf<int32_t>;
inline constexpr int32_t not_inside = 1 << 30;

inline constexpr float units = 256.0f;         ///< a pixel
inline constexpr float farthest = 2097152.0f;  ///< 2^21: the largest position in a record, in units

/// To nearest, ties to even; |x| <= 2^21.
template <class F>
ISOSHADE_INLINE lanes::int_of<F> round_to_int(F x) {
  using lanes::to_int;
  const float to_whole = 12582912.0f;  // 1.5 * 2^23: its neighbours are whole numbers
  return to_int((x + F(to_whole)) - F(to_whole));
}

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
    using lanes::negate;
    // A comparison with NaN is false. x and y are finite, because they lie between finite numbers and not on infinity.
    return (w > F(0.0f)) & (w < F(__builtin_inff())) & (z >= F(0.0f)) & (z <= w) & (x < F(well_right_) * w) &
           (negate(x) < F(well_left_) * w) & (negate(y) < F(well_bottom_) * w) & (y < F(well_top_) * w);
  }

  /// Whether a point in front of the eye can be divided by its w.
  static bool is_divisible(const Point& p);

  /// For a point inside all planes; otherwise the result has no meaning.
  template <class F>
  ISOSHADE_INLINE CornerOf<lanes::int_of<F>> project(F x, F y, F z, F w) const {
    using lanes::bits, lanes::bits_nonnan, lanes::select;
    const F half_width(half_width_), half_height(half_height_);
    const F right = x / w * half_width + half_width;
    const F down = half_height - y / w * half_height;
    const F depth = z / w;
    const F above = select(depth > F(0.0f), depth, F(0.0f));
    return {round_to_int(limit(right * F(units))), round_to_int(limit(down * F(units))),
            bits_nonnan(select(above < F(1.0f), above, F(1.0f))), bits(F(1.0f) / w)};
  }
  Corner project(const Point& p) const { return project<float>(p.x, p.y, p.z, p.w); }

 private:
  /// Limits positions that rounding left slightly outside, and NaN.
  template <class F>
  ISOSHADE_INLINE static F limit(F x) {
    using lanes::select;
    const F above = select(x > F(-farthest), x, F(-farthest));
    return select(above < F(farthest), above, F(farthest));
  }

  Box pixels_{};
  float half_width_ = 0, half_height_ = 0;
  double right_ = 0, left_ = 0, bottom_ = 0, top_ = 0;  ///< the guard planes: x or y in units of w
  float well_right_ = 0, well_left_ = 0, well_bottom_ = 0, well_top_ = 0;  ///< a little nearer
};

/// Which triangles a surface does without.
struct Culling {
  bool turned = false;    ///< those whose vertices turn counter-clockwise on the pixel grid, whose y points down
  bool straight = false;  ///< those whose vertices turn clockwise
  Box pixels{};           ///< those that cover no pixel centre of these
};

/// What decides about a triangle whose vertices are inside all planes; for int, or for lanes.
template <class Int>
struct Decision {
  lanes::bool_of<Int> kept;    ///< it is drawn
  lanes::bool_of<Int> turned;  ///< its vertices turn counter-clockwise on the grid
  lanes::bool_of<Int> wide;    ///< an edge spans 2^15 or more along an axis
};

template <class Int>
ISOSHADE_INLINE Decision<Int> decide(const Int (&x)[3], const Int (&y)[3], const Culling& culling) {
  using lanes::any, lanes::mul_hi, lanes::select, lanes::unsigned_less;
  using Bool = lanes::bool_of<Int>;
  const Int left = least(least(x[0], x[1]), x[2]), right = greatest(greatest(x[0], x[1]), x[2]);
  const Int top = least(least(y[0], y[1]), y[2]), bottom = greatest(greatest(y[0], y[1]), y[2]);
  // The longest edge along an axis spans the bounds.
  const Bool wide = Bool(right - left >= Int(1 << 15)) | Bool(bottom - top >= Int(1 << 15));
  // The doubled area in square units; its low 32 bits are all of it unless the triangle is wide.
  const Int first = (x[1] - x[0]) * (y[2] - y[0]), second = (y[1] - y[0]) * (x[2] - x[0]);
  const Int low = first - second;
  Bool turned = low < Int(0);
  Bool has_area = low != Int(0);
  if (any(wide)) {
    const Int borrow = select(unsigned_less(first, second), Int(1), Int(0));
    const Int high = mul_hi(x[1] - x[0], y[2] - y[0]) - mul_hi(y[1] - y[0], x[2] - x[0]) - borrow;
    turned = high < Int(0);
    has_area = (high | low) != Int(0);
  }
  const Bool culled = select(turned, Bool(culling.turned), Bool(culling.straight));
  const Box& pixels = culling.pixels;
  const Bool empty = centres_between(left, top, right, bottom)
                         .within({Int(pixels.x0), Int(pixels.y0), Int(pixels.x1), Int(pixels.y1)})
                         .empty();
  return {Bool(has_area & !(culled | empty)), turned, wide};
}

}  // namespace isoshade::raster
