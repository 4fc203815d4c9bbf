// SPDX-License-Identifier: Apache-2.0
// The parts of clip.cpp that work in lanes.
#pragma once

#include <cstdint>

#include "runtime/raster/viewport.h"

namespace isoshade::raster::detail {

/// Writes the corners of `count` vertices, 4 floats each.
using ProjectVertices = void (*)(const Viewport& viewport, const float* clip, int count, Corner* corners);

/// A triangle that is drawn, or cut and then drawn: its number from the first of its chunk on, and these flags.
namespace kept_flag {
inline constexpr int turned = 1;  ///< as in Decision
inline constexpr int wide = 2;
inline constexpr int cut = 4;  ///< a vertex lies outside of a plane; then the others have no meaning
inline constexpr int bits = 3;
}  // namespace kept_flag
inline constexpr int chunk_triangles = 1 << (16 - kept_flag::bits);  ///< that numbers of 16 bits can count

/// Lists those of at most chunk_triangles triangles that are kept, in their order; returns how many. There is room for
/// one more in `kept` than there are triangles.
using DecideTriangles = int (*)(const Corner* corners, const uint32_t* indices, int count, const Culling& culling,
                                uint16_t* kept);

#define ISOSHADE_CLIP_KERNELS(W)                                                                                 \
  void project_vertices_##W(const Viewport& viewport, const float* clip, int count, Corner* corners);            \
  int decide_triangles_##W(const Corner* corners, const uint32_t* indices, int count, const Culling& culling,    \
                           uint16_t* kept);
ISOSHADE_CLIP_KERNELS(4)
ISOSHADE_CLIP_KERNELS(8)
ISOSHADE_CLIP_KERNELS(16)
#undef ISOSHADE_CLIP_KERNELS

struct ClipKernels {
  ProjectVertices project;
  DecideTriangles decide;
};
/// Those of a number of lanes that the machine has.
inline ClipKernels clip_kernels(int lanes) {
  switch (lanes) {
    case 16: return {project_vertices_16, decide_triangles_16};
    case 8: return {project_vertices_8, decide_triangles_8};
    default: return {project_vertices_4, decide_triangles_4};
  }
}

}  // namespace isoshade::raster::detail
