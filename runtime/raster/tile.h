// SPDX-License-Identifier: Apache-2.0
// Visibility in one tile of an image: for each pixel the nearest triangle and its depth.
#pragma once

#include <cstdint>
#include <span>

#include "runtime/raster/triangle.h"

namespace isoshade::raster {

inline constexpr int tile_size = 64;  ///< pixels each way
inline constexpr int block_size = 8;
inline constexpr int tile_pixels = tile_size * tile_size;

/// Stored in blocks of 8x8 pixels, so that neighbours in the image are neighbours in memory: the blocks row by row, and
/// the pixels of a block row by row.
struct Tile {
  alignas(64) int32_t triangles[tile_pixels];  ///< indices of the triangles, -1 where there is none
  alignas(64) float depth[tile_pixels];        ///< 0 where there is none

  void clear();
};

/// The pixel of the tile that is the i-th in storage.
constexpr int tile_x(int i) { return (i >> 6 & 7) * block_size + (i & 7); }
constexpr int tile_y(int i) { return (i >> 9) * block_size + (i >> 3 & 7); }
constexpr int tile_index(int x, int y) {
  return (y / block_size * (tile_size / block_size) + x / block_size) * 64 + y % block_size * 8 +
         x % block_size;
}

/// Draws the triangles (records of lower/frame_layout.h) whose indices are in `which`, in this order, into the tile
/// whose first pixel is (x, y). A pixel keeps the triangle with the greatest depth above 0 (of equal ones the first
/// drawn); a triangle with triangle_flag::over takes every pixel that it covers. The caller holds an FpGuard.
void rasterize_tile(const int32_t* triangles, std::span<const int32_t> which, int x, int y, Tile& tile);

/// Pixels of a tile that triangles cover and that no nearer triangle covers yet; cut-outs decide whether they are drawn.
struct Candidates {
  static constexpr int capacity = 2 * tile_pixels;
  int count = 0;
  int32_t place[capacity];  ///< in the storage of the tile
  int32_t x[capacity], y[capacity], triangle[capacity];
  float depth[capacity];
  int32_t drawn[capacity];  ///< what the cut-out decides: 0 or 1
};

/// Lists the candidates of triangles, in their order, in the part of the tile that lies in `area`. The triangles have the
/// same depth test and do not see each other. Returns how many of them fit; at least one.
int list_candidates(const int32_t* triangles, std::span<const int32_t> which, int x, int y, const Box& area,
                    Tile& tile, Candidates& candidates);
/// Draws the candidates that are `drawn`, by the depth test of their triangles.
void draw_candidates(const Candidates& candidates, bool over, Tile& tile);

/// The number of lanes that `rasterize_tile` uses on this machine: 4, 8 or 16.
int rasterizer_lanes();

namespace detail {
/// The same at a given number of lanes, if the machine has them.
void rasterize_tile_4(const int32_t* triangles, const int32_t* which, int count, int x, int y, Tile& tile);
void rasterize_tile_8(const int32_t* triangles, const int32_t* which, int count, int x, int y, Tile& tile);
void rasterize_tile_16(const int32_t* triangles, const int32_t* which, int count, int x, int y, Tile& tile);
int list_candidates_4(const int32_t* triangles, const int32_t* which, int count, int x, int y, const Box& area,
                      Tile& tile, Candidates& candidates);
int list_candidates_8(const int32_t* triangles, const int32_t* which, int count, int x, int y, const Box& area,
                      Tile& tile, Candidates& candidates);
int list_candidates_16(const int32_t* triangles, const int32_t* which, int count, int x, int y, const Box& area,
                       Tile& tile, Candidates& candidates);
}  // namespace detail

}  // namespace isoshade::raster
