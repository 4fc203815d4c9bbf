// SPDX-License-Identifier: Apache-2.0
// Cuts a triangle by the planes that its vertices lie outside of.
#pragma once

#include <array>
#include <cstdint>

#include "compiler/lower/frame_layout.h"
#include "runtime/raster/viewport.h"

namespace isoshade::raster {

struct ClipVertex {
  Point point;
  int32_t index;  ///< of its record; made_by_clipping if it has none yet
  std::array<float, lower::vertex_word::stride> attributes;
};
inline constexpr int32_t made_by_clipping = INT32_MIN;

/// A triangle cut by six planes has nine corners. Rounding can make one edge cross a plane twice; in the worst case
/// each plane then adds half as many corners: 3, 4, 6, 9, 13, 19, 28.
inline constexpr int most_corners = 28;

struct Polygon {
  std::array<ClipVertex, most_corners> vertices;
  std::array<Corner, most_corners> corners;  ///< where the vertices lie on the grid, once all planes have cut
  int count = 0;
  void add(const ClipVertex& vertex) { vertices[count++] = vertex; }
};

/// Cuts the polygon by the planes of `outside` and projects its vertices. False if one is not finite, or too near to the
/// eye for the division.
bool clip(const Viewport& viewport, Outside outside, Polygon& polygon);

}  // namespace isoshade::raster
