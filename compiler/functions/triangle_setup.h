// SPDX-License-Identifier: Apache-2.0
// From clip space to a triangle on the pixel grid: division, snapping, culling, moving of depth. Shared by the host, by one
// triangle or in lanes, and by the setup stage, which does it on a device. Always inlined on the host, because code for
// several instruction sets uses it.
//
// Positions are integers in 1/256 pixel, y down, |x|, |y| <= 2^21; pixel i has its centre at 256 * i + 128.
#pragma once

#include "compiler/functions/interpolation.h"

namespace isoshade::functions {

inline constexpr float units_of_pixel = 256.0f;
inline constexpr float farthest_position = 2097152.0f;  ///< 2^21, in units

template <class T>
ISOSHADE_INLINE T least(T a, T b) {
  return select(b < a, b, a);
}
template <class T>
ISOSHADE_INLINE T greatest(T a, T b) {
  return select(a < b, b, a);
}

/// A rectangle of pixels, both ends included; empty if an end lies before its beginning. For int, or one in each lane.
template <class Int>
struct BoxOf {
  Int x0, y0, x1, y1;
  ISOSHADE_INLINE bool_of<Int> empty() const { return (x1 < x0) | (y1 < y0); }
  ISOSHADE_INLINE BoxOf within(const BoxOf& other) const {
    return {greatest(x0, other.x0), greatest(y0, other.y0), least(x1, other.x1), least(y1, other.y1)};
  }
};

/// The pixels whose centres lie between positions, both included.
template <class Int>
ISOSHADE_INLINE BoxOf<Int> centres_between(Int left, Int top, Int right, Int bottom) {
  return {shift_right_signed(left + Int(127), 8), shift_right_signed(top + Int(127), 8),
          shift_right_signed(right - Int(128), 8), shift_right_signed(bottom - Int(128), 8)};
}

/// To nearest, ties to even; |x| <= 2^21.
template <class F>
ISOSHADE_INLINE int_of<F> round_to_int(F x) {
  const F to_whole(12582912.0f);  // 1.5 * 2^23: its neighbours are whole numbers
  return to_int((x + to_whole) - to_whole);
}

/// A vertex as it stands in a triangle record.
template <class Int>
struct CornerOf {
  Int x, y;
  Int depth, inverse_w;  ///< float bits
};

/// Limits positions that rounding left slightly outside, and NaN.
template <class F>
ISOSHADE_INLINE F limited_position(F x) {
  const F far(farthest_position), near(-farthest_position);
  const F above = select(x > near, x, near);
  return select(above < far, above, far);
}

/// For a point in clip space inside all planes; otherwise the result has no meaning. The halves are those of the image,
/// in pixels.
template <class F>
ISOSHADE_INLINE CornerOf<int_of<F>> project(F x, F y, F z, F w, F half_width, F half_height) {
  const F right = x / w * half_width + half_width;
  const F down = half_height - y / w * half_height;
  const F depth = z / w;
  const F above = select(depth > F(0.0f), depth, F(0.0f));
  return {round_to_int(limited_position(right * F(units_of_pixel))),
          round_to_int(limited_position(down * F(units_of_pixel))),
          bits_nonnan(select(above < F(1.0f), above, F(1.0f))), bits(F(1.0f) / w)};
}

/// The guard planes: x or y in units of w.
template <class F>
struct GuardPlanes {
  F right, left, bottom, top;
};

/// Whether a point lies in front of the eye and inside all planes. A comparison with NaN is false; x and y are finite
/// then, because they lie between finite numbers and not on infinity.
template <class F>
ISOSHADE_INLINE bool_of<F> is_inside(F x, F y, F z, F w, const GuardPlanes<F>& planes) {
  return (w > F(0.0f)) & (w < F(infinity)) & (z >= F(0.0f)) & (z <= w) & (x < planes.right * w) &
         (negate(x) < planes.left * w) & (negate(y) < planes.bottom * w) & (y < planes.top * w);
}

/// Which triangles a surface does without.
template <class Int>
struct CullingOf {
  bool_of<Int>
      turned;  ///< those whose vertices turn counter-clockwise on the pixel grid, whose y points down
  bool_of<Int> straight;  ///< those whose vertices turn clockwise
  BoxOf<Int> pixels;      ///< those that cover no pixel centre of these
};

/// What decides about a triangle whose vertices are inside all planes.
template <class Int>
struct Decision {
  bool_of<Int> kept;    ///< it is drawn
  bool_of<Int> turned;  ///< its vertices turn counter-clockwise on the grid
  bool_of<Int> wide;    ///< an edge spans 2^15 or more along an axis
};

template <class Int>
ISOSHADE_INLINE Decision<Int> decide(const Int (&x)[3], const Int (&y)[3], const CullingOf<Int>& culling) {
  using Bool = bool_of<Int>;
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
  const Bool culled = select(turned, culling.turned, culling.straight);
  const Bool empty = centres_between(left, top, right, bottom).within(culling.pixels).empty();
  return {Bool(has_area & !Bool(culled | empty)), turned, wide};
}

/// How far the depth of a triangle is moved away from the viewer, as depth.
template <class F>
struct DepthBiasOf {
  F slope;     ///< times the sum of what the depth changes by from a pixel to the next, along x and along y
  F relative;  ///< times the depth
  F constant;
};

/// The depths of a triangle's corners, moved away; they may be negative, or the triangle would tilt. Of a triangle that has
/// an area. Error: as if each depth were off by 2 ULP.
template <class F>
ISOSHADE_INLINE void move_depth(const int_of<F> (&x)[3], const int_of<F> (&y)[3], F (&depth)[3],
                                const DepthBiasOf<F>& bias) {
  const F z1 = depth[1] - depth[0], z2 = depth[2] - depth[0];
  const F x1 = to_float(x[1] - x[0]), x2 = to_float(x[2] - x[0]);
  const F y1 = to_float(y[1] - y[0]), y2 = to_float(y[2] - y[0]);
  const F area = edge_wide<F>(x[0], y[0], x[1], y[1], x[2], y[2]);  // doubled, in square units
  const F pixel = F(units_of_pixel) / abs(area);
  const F across = abs(z1 * y2 - z2 * y1) * pixel, down = abs(z2 * x1 - z1 * x2) * pixel;
  const F slope = bias.slope * (across + down) + bias.constant;
  for (F& z : depth) z = z - (slope + bias.relative * z);
}

}  // namespace isoshade::functions
