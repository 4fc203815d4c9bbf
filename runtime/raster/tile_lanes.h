// SPDX-License-Identifier: Apache-2.0
// The rasteriser of a tile, for W lanes. One file for each instruction set includes it. It calls only functions that
// are inlined or templates over W, because the linker must not share code between instruction sets.
#pragma once

#include "compiler/functions/interpolation.h"
#include "runtime/raster/tile.h"
#include "runtime/raster/triangle.h"

namespace isoshade::raster::detail {

/// Draws triangles; with `lists`, lists what it would draw in the area instead.
template <int W, bool lists>
class TileRasterizer {
  using Float = lanes::Float<W, 1>;
  using Int = lanes::Int<W, 1>;
  using Bool = lanes::Bool<W, 1>;

  static constexpr int blocks = tile_size / block_size;
  static constexpr int block_pixels = block_size * block_size;
  // A register holds consecutive pixels of a block: two rows of it, one row, or half a row.
  static constexpr int rows = W > block_size ? W / block_size : 1;
  static constexpr int columns = W < block_size ? W : block_size;
  // Where an edge function is this large, the whole block is inside: steps are below 2^23.
  static constexpr int64_t far_inside = 1 << 30;

 public:
  ISOSHADE_INLINE TileRasterizer(int x, int y, Tile& tile, Box area = {}, Candidates* candidates = nullptr)
      : x_(x), y_(y), tile_(tile), area_(area), candidates_(candidates) {
    const Int lane = lanes::lane_index<Int>();
    column_ = lane & 7;
    row_ = shift_right(lane, 3);
  }

  ISOSHADE_INLINE void draw(Triangle triangle, int id) {
    const Box tile_box{x_, y_, x_ + tile_size - 1, y_ + tile_size - 1};
    const Box box = bounds(triangle).within(tile_box);
    if (box.empty()) return;

    triangle_ = triangle;
    number_ = id;
    id_ = Int(id);
    wide_ = triangle.wide();
    over_ = triangle.over();
    for (int k = 0; k < 3; ++k) {
      edges_[k] = edge_between(triangle, k, k == 2 ? 0 : k + 1);
      lane_steps_[k] = Int(edges_[k].step_x) * column_ + Int(edges_[k].step_y) * row_;
    }
    const int first_column = (box.x0 - x_) / block_size, last_column = (box.x1 - x_) / block_size;
    const int first_row = (box.y0 - y_) / block_size, last_row = (box.y1 - y_) / block_size;
    for (int row = first_row; row <= last_row; ++row) {
      const int top = y_ + row * block_size;
      const int begin = greatest(box.y0 - top, 0);
      const int end = least(box.y1 - top, block_size - 1) + 1;
      for (int column = first_column; column <= last_column; ++column)
        block(x_ + column * block_size, top, begin, end, (row * blocks + column) * block_pixels);
    }
  }

 private:
  /// Draws rows [begin, end) of the block whose first pixel is (x, y) in the image and `storage` in the tile.
  ISOSHADE_INLINE void block(int x, int y, int begin, int end, int storage) {
    int at_block[3];
    for (int k = 0; k < 3; ++k) {
      const Edge& edge = edges_[k];
      const int64_t first =
          edge.at_origin + static_cast<int64_t>(edge.step_x) * x + static_cast<int64_t>(edge.step_y) * y;
      const int64_t most = first + (block_size - 1) * (static_cast<int64_t>(greatest(edge.step_x, 0)) +
                                                       greatest(edge.step_y, 0));
      if (most < 0) return;
      at_block[k] = static_cast<int>(least(first, far_inside));
    }
    for (int row = begin & -rows; row < end; row += rows)
      for (int column = 0; column < block_size; column += columns) {
        Int outside = lane_steps_[0] + at(at_block, 0, column, row);
        outside = outside | (lane_steps_[1] + at(at_block, 1, column, row));
        outside = outside | (lane_steps_[2] + at(at_block, 2, column, row));
        const Bool covered = outside >= Int(0);
        if (any(covered)) test(covered, x + column, y + row, storage + row * block_size + column);
      }
  }

  ISOSHADE_INLINE Int at(const int* at_block, int k, int column, int row) const {
    return Int(at_block[k] + edges_[k].step_x * column + edges_[k].step_y * row);
  }

  /// The depth test for the covered lanes.
  ISOSHADE_INLINE void test(Bool covered, int x, int y, int storage) {
    const Int px = shift_left(column_ + Int(x), 8) + Int(128);
    const Int py = shift_left(row_ + Int(y), 8) + Int(128);
    const Triangle& t = triangle_;
    const auto weights =
        functions::edge_functions<Float>(t.x(0), t.y(0), t.x(1), t.y(1), t.x(2), t.y(2), wide_, px, py);
    const Float depth =
        functions::interpolate_depth<Float>(weights, Float(t.depth(0)), Float(t.depth(1)), Float(t.depth(2)));

    const Float former = lanes::load_lanes<Float>(tile_.depth + storage);
    const Bool seen = covered & (over_ | (depth > former));
    if (!any(seen)) return;
    if constexpr (lists) return list(seen, depth, x, y, storage);
    lanes::store_lanes(tile_.depth + storage, select(seen, depth, former));
    const Int former_id = lanes::load_lanes<Int>(tile_.triangles + storage);
    lanes::store_lanes(tile_.triangles + storage, select(seen, id_, former_id));
  }

  ISOSHADE_INLINE void list(Bool seen, Float depth, int x, int y, int storage) {
    int is_seen[W];
    float depths[W];
    lanes::store_lanes(is_seen, select(seen, Int(1), Int(0)));
    lanes::store_lanes(depths, depth);
    for (int lane = 0; lane < W; ++lane) {
      const int at_x = x + (lane & 7), at_y = y + (lane >> 3);
      if (is_seen[lane] == 0 || at_x > area_.x1 || at_y > area_.y1) continue;
      const int next = candidates_->count++;
      candidates_->place[next] = storage + lane;
      candidates_->x[next] = at_x;
      candidates_->y[next] = at_y;
      candidates_->triangle[next] = number_;
      candidates_->depth[next] = depths[lane];
    }
  }

  int x_, y_;
  Tile& tile_;
  Box area_;
  Candidates* candidates_;
  int number_ = 0;
  Int column_, row_;  ///< of each lane in its register

  Triangle triangle_;
  Int id_;
  Bool wide_;
  Bool over_;
  Edge edges_[3];
  Int lane_steps_[3];
};

template <int W>
ISOSHADE_INLINE void rasterize(const int32_t* triangles, const int32_t* which, int count, int x, int y,
                               Tile& tile) {
  TileRasterizer<W, false> rasterizer(x, y, tile);
  for (int i = 0; i < count; ++i) rasterizer.draw(triangle_at(triangles, which[i]), which[i]);
}

template <int W>
ISOSHADE_INLINE int list(const int32_t* triangles, const int32_t* which, int count, int x, int y, const Box& area,
                         Tile& tile, Candidates& candidates) {
  TileRasterizer<W, true> rasterizer(x, y, tile, area, &candidates);
  int next = 0;
  while (next < count && candidates.count + tile_pixels <= Candidates::capacity) {
    rasterizer.draw(triangle_at(triangles, which[next]), which[next]);
    ++next;
  }
  return next;
}

}  // namespace isoshade::raster::detail
