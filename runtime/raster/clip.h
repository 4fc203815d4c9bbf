// SPDX-License-Identifier: Apache-2.0
// From clip space to triangles on the pixel grid: clipping, the division, snapping, culling. Done once on the
// host for every backend, so that all of them rasterise the same integers.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compiler/interface/pass_state.h"

namespace isoshade::raster {

/// The largest image that positions in 1/256 pixel reach.
inline constexpr int max_image_size = 8192;
/// How far positions reach to the left of and above the image, in pixels.
inline constexpr int max_before_image = 2048;

/// One object after its vertex stage.
struct Surface {
  std::span<const float>
      clip;  ///< x y z w of each vertex; y up; z = w is the near plane, z = 0 infinitely far
  std::span<const uint32_t> indices;  ///< triples of vertices, each below clip.size() / 4
  uint32_t first_vertex = 0;          ///< where the records of its vertices begin in `vertices`
  /// Triangles are front-facing where their vertices turn counter-clockwise in the image.
  interface::PassState state;
  int object = 0;  ///< the first word of its record in the array of objects
};

/// Appends the surface's triangles to `triangles` (records of lower/frame_layout.h), in the order of its
/// indices, and to `vertices` the records of the vertices that clipping makes. Width and height are 1 to 8192
/// pixels.
///
/// Left out are triangles that are culled, have no area, cover no pixel centre of the image, or have a vertex
/// that is not finite. What lies beyond the near plane, more than 2048 pixels left of or above the image's
/// first pixel, or more than 8190 pixels (or the image's size, if greater) right of or below it, is clipped
/// away. Triangles that share an edge share the two ends of what is left of it.
void clip_and_snap(const Surface& surface, int width, int height, std::vector<float>& vertices,
                   std::vector<int32_t>& triangles);

}  // namespace isoshade::raster
