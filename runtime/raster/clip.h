// SPDX-License-Identifier: Apache-2.0
// From clip space to triangles on the pixel grid: clipping, division, snapping, culling. The host does this once for
// every backend, so that all of them rasterise the same integers.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compiler/interface/pass_state.h"

namespace isoshade::raster {

/// The largest side of an image that positions in 1/256 pixel can cover.
inline constexpr int max_image_size = 8192;
/// How far to the left of and above the image positions may lie, in pixels.
inline constexpr int max_before_image = 2048;

/// How far the depth of a triangle is moved away from the viewer, as depth.
struct DepthBias {
  float slope = 0;     ///< times the sum of what the depth changes by from a pixel to the next, along x and along y
  float relative = 0;  ///< times the depth
  float constant = 0;
  bool is_set() const { return slope > 0 || relative > 0 || constant > 0; }
};

/// One draw after its vertex stage.
struct Surface {
  std::span<const float>
      clip;  ///< x y z w of each vertex; y up; z = w is the near plane, z = 0 infinitely far
  std::span<const uint32_t> indices;  ///< triples of vertices, each below clip.size() / 4
  uint32_t first_vertex = 0;          ///< where the records of its vertices begin in `vertices`
  interface::PassState state;
  int object = 0;  ///< the first word of its record in the array of objects
  /// Triangles are front-facing where their vertices turn counter-clockwise in the image; if the surface is mirrored,
  /// clockwise.
  bool mirrored = false;
  bool cutout = false;   ///< its triangles get triangle_flag::cutout
  bool blended = false;  ///< its triangles get triangle_flag::blended, by `state.depth_write` with ::keeps_depth
  DepthBias bias = {};
};

/// Appends the surface's triangles to `triangles` (records of lower/frame_layout.h), in the order of its indices, and
/// the records of the vertices that clipping makes to `vertices`. Width and height are 1 to 8192 pixels.
///
/// Drops triangles that are culled, have no area, cover no pixel centre of the image, or have a vertex that is not
/// finite. Clips at the near and the far plane, 2048 pixels left of and above the image's first pixel, and 8190 pixels (or the
/// image's size, if greater) right of and below it. Triangles that share an edge share both ends of what clipping
/// leaves of it.
void clip_and_snap(const Surface& surface, int width, int height, std::vector<float>& vertices,
                   std::vector<int32_t>& triangles);

}  // namespace isoshade::raster
