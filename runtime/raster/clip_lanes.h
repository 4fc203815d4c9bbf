// SPDX-License-Identifier: Apache-2.0
// Vertices and triangles of clip.cpp, W at a time. See tile_lanes.h for the rules of such files.
#pragma once

#include "runtime/raster/clip_kernels.h"
#include "runtime/raster/transpose.h"

namespace isoshade::raster::detail {

/// Reads and writes W vertices.
template <int W>
ISOSHADE_INLINE void project_group(const Viewport& viewport, const float* clip, Corner* corners) {
  using Float = lanes::Float<W, 1>;
  using Int = lanes::Int<W, 1>;
  using Bool = lanes::Bool<W, 1>;
  Int words[4];
  load_quads<W>([&](int i) __attribute__((always_inline)) { return clip + 4 * i; }, words);
  const Float x = from_bits_normal(words[0]), y = from_bits_normal(words[1]), z = from_bits_normal(words[2]),
              w = from_bits_normal(words[3]);
  const functions::CornerOf<Int> corner = viewport.project(x, y, z, w);
  const Int result[4] = {corner.x, corner.y, corner.depth, corner.inverse_w};
  store_quads<W>(result, [&](int i) __attribute__((always_inline)) { return corners + i; });
  const Bool inside = viewport.is_well_inside(x, y, z, w);
  if (all(inside)) return;
  int is_inside[W];
  lanes::store_lanes(is_inside, select(inside, Int(1), Int(0)));
  for (int i = 0; i < W; ++i) {
    if (is_inside[i] != 0) continue;
    const float* p = clip + 4 * i;
    if (const Outside outside = viewport.classify({p[0], p[1], p[2], p[3]})) corners[i] = {not_inside, outside, 0, 0};
  }
}

template <int W>
ISOSHADE_INLINE void project_vertices(const Viewport& viewport, const float* clip, int count, Corner* corners) {
  int first = 0;
  for (; first + W <= count; first += W) project_group<W>(viewport, clip + 4 * first, corners + first);
  if (first == count) return;
  float last_clip[4 * W];
  Corner last[W];
  for (int i = 0; i < W; ++i)
    for (int k = 0; k < 4; ++k) last_clip[4 * i + k] = clip[4 * (first + i < count ? first + i : first) + k];
  project_group<W>(viewport, last_clip, last);
  for (int i = 0; first + i < count; ++i) corners[first + i] = last[i];
}

/// Decides about W triangles, of which the first `count` exist, and appends them to `kept`. `first`: the number of the
/// first one.
template <int W>
ISOSHADE_INLINE uint16_t* decide_group(const Corner* corners, const uint32_t* indices, int first, int count,
                                       const Culling& culling, uint16_t* kept) {
  using Int = lanes::Int<W, 1>;
  using Bool = lanes::Bool<W, 1>;
  Int x[3], y[3];
  for (int k = 0; k < 3; ++k)
    load_pairs<W>([&](int i) __attribute__((always_inline)) { return corners + indices[3 * i + k]; }, x[k], y[k]);
  const Box& pixels = culling.pixels;
  const Decision<Int> decision = decide(x, y,
                                        {Bool(culling.turned),
                                         Bool(culling.straight),
                                         {Int(pixels.x0), Int(pixels.y0), Int(pixels.x1), Int(pixels.y1)}});
  const Int lane = lanes::lane_index<Int>();
  Int flags = select(decision.turned, Int(kept_flag::turned), Int(0)) |
              select(decision.wide, Int(kept_flag::wide), Int(0));
  Bool is_kept = decision.kept;
  const Bool cut = (x[0] == Int(not_inside)) | (x[1] == Int(not_inside)) | (x[2] == Int(not_inside));
  if (any(cut)) {
    Int outside[3];
    for (int k = 0; k < 3; ++k) outside[k] = select(x[k] == Int(not_inside), y[k], Int(0));
    const Bool dropped = ((outside[0] & outside[1] & outside[2]) != Int(0)) |
                         (((outside[0] | outside[1] | outside[2]) & Int(unusable)) != Int(0));
    is_kept = select(cut, !dropped, is_kept);
    flags = select(cut, Int(kept_flag::cut), flags);
  }
  int entries[W], is_listed[W];
  lanes::store_lanes(entries, shift_left(lane + Int(first), kept_flag::bits) | flags);
  lanes::store_lanes(is_listed, select(is_kept & (lane < Int(count)), Int(1), Int(0)));
  for (int i = 0; i < W; ++i) {
    *kept = static_cast<uint16_t>(entries[i]);
    kept += is_listed[i];
  }
  return kept;
}

template <int W>
ISOSHADE_INLINE int decide_triangles(const Corner* corners, const uint32_t* indices, int count, const Culling& culling,
                                     uint16_t* kept) {
  uint16_t* next = kept;
  int first = 0;
  for (; first + W <= count; first += W)
    next = decide_group<W>(corners, indices + 3 * first, first, W, culling, next);
  if (first < count) {
    uint32_t last[3 * W];
    for (int i = 0; i < 3 * W; ++i) last[i] = indices[3 * first + i < 3 * count ? 3 * first + i : 3 * first];
    next = decide_group<W>(corners, last, first, count - first, culling, next);
  }
  return static_cast<int>(next - kept);
}

}  // namespace isoshade::raster::detail
