// SPDX-License-Identifier: Apache-2.0
// The rasteriser of a tile, for W lanes. One file for each instruction set includes it. It calls only functions that
// are inlined or templates over W, because the linker must not share code between instruction sets.
//
// Triangles are set up W at a time, one in each lane. If the box of one has only a few pixels, it is also interpolated in
// its lane, pixel after pixel. Otherwise a register holds pixels of one triangle.
//
// A pixel is covered if no edge function is negative there, after 1 is subtracted from those of edges that are neither top
// nor left ones. Edge functions are exact: in 32 bits for triangles of a small span, in two words for others. Rounded once,
// they are the floats of functions::edge_functions().
//
// The rasteriser keeps the farthest depth of each block, and leaves out triangles behind it before it sets up their edges.
// No pixel changes by that. All steps of interpolate_depth() are monotonic, so its result is at most the one for three
// depths m, where m is the greatest of the vertices' depths and 0. Rounding is in a product, two sums and a quotient above
// and in two sums below: that result is at most m (1 + 2^-24)^4 / (1 - 2^-24)^2 < m (1 + 2^-21). (No product underflows,
// because edge functions are whole numbers.)
#pragma once

#include "compiler/functions/interpolation.h"
#include "runtime/raster/tile.h"
#include "runtime/raster/transpose.h"
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
  /// The edge functions of triangles that span less fit into 32 bits in all blocks that the triangles reach.
  static constexpr int small_span = 1 << 14;
  /// The most pixels in the box of a triangle that is interpolated in its lane.
  static constexpr int few_pixels = 4;
  /// After so many triangles in a block its farthest depth is computed again.
  static constexpr int renewal = 8;

  enum Kind : int { left_out, few, small, large };

 public:
  ISOSHADE_INLINE TileRasterizer(const int32_t* triangles, int x, int y, Tile& tile, Box area = {},
                                 Candidates* candidates = nullptr)
      : triangles_(triangles), x_(x), y_(y), tile_(tile), area_(area), candidates_(candidates) {
    const Int lane = lanes::lane_index<Int>();
    column_ = lane & 7;
    row_ = shift_right(lane, 3);
    for (int b = 0; b < blocks * blocks; ++b) {
      farthest_[b] = 0.0f;
      age_[b] = renewal - 1;
    }
  }

  /// Draws the triangles `which` in their order; returns how many, which are all unless it lists them.
  ISOSHADE_INLINE int draw(const int32_t* which, int count) {
    int next = 0;
    while (next + W <= count) {
      const int drawn = group(which + next, W);
      next += drawn;
      if (drawn < W) return next;
    }
    if (next == count) return next;
    int32_t last[W];
    for (int i = 0; i < W; ++i) last[i] = which[next + i < count ? next + i : next];
    return next + group(last, count - next);
  }

 private:
  /// W triangles, as lanes.
  struct Corners {
    Int x[3], y[3];
    Float depth[3];
    Int flags;
  };
  /// Their edge functions.
  struct EdgeLanes {
    Int at_first;  ///< at the first pixel of the box, less `rounding`
    Int rounding, step_x, step_y;
  };

  ISOSHADE_INLINE Corners load(const int32_t* which) const {
    namespace word = lower::triangle_word;
    const auto record = [&](int i, int first) __attribute__((always_inline)) {
      return triangles_ + static_cast<int64_t>(which[i]) * word::stride + first;
    };
    static_assert(word::position % 4 == 0 && word::depth == word::position + 6);
    Corners c;
    Int words[4], unused;
    load_quads<W>([&](int i) __attribute__((always_inline)) { return record(i, word::position); }, words);
    c.x[0] = words[0], c.y[0] = words[1], c.x[1] = words[2], c.y[1] = words[3];
    load_quads<W>([&](int i) __attribute__((always_inline)) { return record(i, word::position + 4); }, words);
    c.x[2] = words[0], c.y[2] = words[1];
    c.depth[0] = from_bits_normal(words[2]), c.depth[1] = from_bits_normal(words[3]);
    load_pairs<W>([&](int i) __attribute__((always_inline)) { return record(i, word::depth + 2); }, words[0], unused);
    c.depth[2] = from_bits_normal(words[0]);
    load_pairs<W>([&](int i) __attribute__((always_inline)) { return record(i, word::object - 1); }, unused, c.flags);
    return c;
  }

  /// The three edge functions at a pixel of the tile in each lane.
  ISOSHADE_INLINE void set_up(const Corners& c, Int x, Int y, EdgeLanes (&edges)[3]) const {
    const Int px = shift_left(x + Int(x_), 8) + Int(128), py = shift_left(y + Int(y_), 8) + Int(128);
    for (int k = 0; k < 3; ++k) {
      const int to = k == 2 ? 0 : k + 1;
      const Int dx = c.x[to] - c.x[k], dy = c.y[to] - c.y[k];
      const Bool top_or_left = (dy < Int(0)) | ((dy == Int(0)) & (dx > Int(0)));
      EdgeLanes& edge = edges[k];
      edge.rounding = select(top_or_left, Int(0), Int(1));
      edge.at_first = dx * (py - c.y[k]) - dy * (px - c.x[k]) - edge.rounding;
      edge.step_x = shift_left(Int(0) - dy, 8);
      edge.step_y = shift_left(dx, 8);
    }
  }

  /// Draws W triangles, of which the first `count` exist. Returns how many of them were drawn or left out.
  ISOSHADE_INLINE int group(const int32_t* which, int count) {
    const Corners c = load(which);
    const Int left = least(least(c.x[0], c.x[1]), c.x[2]), right = greatest(greatest(c.x[0], c.x[1]), c.x[2]);
    const Int top = least(least(c.y[0], c.y[1]), c.y[2]), bottom = greatest(greatest(c.y[0], c.y[1]), c.y[2]);
    BoxOf<Int> box = centres_between(left, top, right, bottom);
    box.x0 = greatest(box.x0 - Int(x_), Int(0)), box.x1 = least(box.x1 - Int(x_), Int(tile_size - 1));
    box.y0 = greatest(box.y0 - Int(y_), Int(0)), box.y1 = least(box.y1 - Int(y_), Int(tile_size - 1));

    const Bool over = (c.flags & Int(lower::triangle_flag::over)) != Int(0);
    const Float greatest_depth = greatest(greatest(greatest(c.depth[0], c.depth[1]), c.depth[2]), Float(0.0f));
    const Float nearest = greatest_depth * Float(1.0f + 0x1p-20f);
    const Bool exists = (!box.empty()) & (lanes::lane_index<Int>() < Int(count));
    // One that is drawn over what is nearer may bring others of its group to light.
    const Bool drawn = any(over & exists) ? exists : exists & !is_hidden(box, nearest);
    if (!any(drawn)) return count;

    const Int width = box.x1 - box.x0 + Int(1), pixels = width * (box.y1 - box.y0 + Int(1));
    const Bool is_small = (right - left < Int(small_span)) & (bottom - top < Int(small_span));
    const Bool is_few = drawn & is_small & !over & (pixels <= Int(few_pixels));
    EdgeLanes edges[3];
    set_up(c, box.x0, box.y0, edges);
    if (any(is_few)) interpolate_few(c, box, edges, select(is_few, pixels, Int(0)));

    int kinds[W], counts[W];
    const Int kind = select(is_few, Int(few), select(is_small, Int(small), Int(large)));
    lanes::store_lanes(kinds, select(drawn, kind, Int(left_out)));
    lanes::store_lanes(counts, pixels);
    if (any(drawn & !is_few)) {
      lanes::store_lanes(x0_, box.x0), lanes::store_lanes(x1_, box.x1);
      lanes::store_lanes(y0_, box.y0), lanes::store_lanes(y1_, box.y1);
      lanes::store_lanes(nearest_, select(over, Float(2.0f), nearest));
      for (int k = 0; k < 3; ++k) {
        lanes::store_lanes(at_first_[k], edges[k].at_first);
        lanes::store_lanes(rounding_[k], edges[k].rounding);
      }
    }
    for (int i = 0; i < count; ++i) {
      if constexpr (lists)
        if (candidates_->count + tile_pixels > Candidates::capacity) return i;
      switch (static_cast<Kind>(kinds[i])) {
        case left_out: break;
        case few: draw_few(i, counts[i], which[i]); break;
        case small:
          begin(which[i]);
          draw_small(i);
          break;
        case large:
          begin(which[i]);
          draw_large(i);
          break;
      }
    }
    return count;
  }

  /// Whether the box reaches at most two blocks each way, and all of these are nearer.
  ISOSHADE_INLINE Bool is_hidden(const BoxOf<Int>& box, Float nearest) const {
    const lanes::FloatBuffer farthest{farthest_, blocks * blocks};
    const Int x0 = shift_right(box.x0, 3), x1 = shift_right(box.x1, 3);
    const Int y0 = shift_right(box.y0, 3), y1 = shift_right(box.y1, 3);
    const Bool fits = (x1 - x0 < Int(2)) & (y1 - y0 < Int(2));
    const Int first = y0 * Int(blocks), last = y1 * Int(blocks);
    Float least_depth = least(lanes::load(farthest, first + x0), lanes::load(farthest, last + x1));
    if (any((x1 != x0) & (y1 != y0)))
      least_depth = least(least_depth, least(lanes::load(farthest, first + x1), lanes::load(farthest, last + x0)));
    return fits & (nearest <= least_depth);
  }

  // ---- Triangles of a few pixels.

  /// Computes the depths of pixels 0, 1, ... of each lane's box, rows top down; 0 where the triangle does not cover it.
  ISOSHADE_INLINE void interpolate_few(const Corners& c, const BoxOf<Int>& box, const EdgeLanes (&edges)[3], Int pixels) {
    Int x = box.x0, y = box.y0;
    Int value[3] = {edges[0].at_first, edges[1].at_first, edges[2].at_first};
    for (int s = 0; s < few_pixels; ++s) {
      const Bool exists = Int(s) < pixels;
      if (!any(exists)) return;
      const Bool covered = exists & ((value[0] | value[1] | value[2]) >= Int(0));
      const Float depth = interpolate(value[0] + edges[0].rounding, value[1] + edges[1].rounding,
                                      value[2] + edges[2].rounding, c.depth[0], c.depth[1], c.depth[2]);
      lanes::store_lanes(few_depth_[s], select(covered, depth, Float(0.0f)));
      lanes::store_lanes(few_place_[s], shift_left((y & 56) + shift_right(x, 3), 6) + shift_left(y & 7, 3) + (x & 7));
      const Bool ends_row = x == box.x1;
      const Int back = box.x1 - box.x0;
      for (int k = 0; k < 3; ++k)
        value[k] = value[k] + select(ends_row, edges[k].step_y - back * edges[k].step_x, edges[k].step_x);
      x = select(ends_row, box.x0, x + Int(1));
      y = y + select(ends_row, Int(1), Int(0));
    }
  }

  ISOSHADE_INLINE void draw_few(int lane, int pixels, int id) {
    for (int s = 0; s < pixels; ++s) {
      const int place = few_place_[s][lane];
      const float depth = few_depth_[s][lane], former = tile_.depth[place];
      const bool seen = depth > former;
      if constexpr (lists) {
        if (seen) list(x_ + tile_x(place), y_ + tile_y(place), place, id, depth);
      } else {
        tile_.depth[place] = seen ? depth : former;
        tile_.triangles[place] = seen ? id : tile_.triangles[place];
      }
    }
    const int first = few_place_[0][lane] / block_pixels, last = few_place_[pixels - 1][lane] / block_pixels;
    touch(first);
    if (last != first) touch(last);
  }

  // ---- Other triangles, one after the other.

  ISOSHADE_INLINE void begin(int id) {
    const Triangle triangle = triangle_at(triangles_, id);
    number_ = id;
    id_ = Int(id);
    is_over_ = triangle.over();
    over_ = is_over_;
    for (int k = 0; k < 3; ++k) {
      const int to = k == 2 ? 0 : k + 1;
      steps_x_[k] = triangle.y(k) - triangle.y(to);
      steps_y_[k] = triangle.x(to) - triangle.x(k);
      lane_steps_[k] = Int(steps_x_[k]) * column_ + Int(steps_y_[k]) * row_;
      depths_[k] = Float(triangle.depth(k));
    }
  }

  /// Calls draw(x, y, first row, last row + 1) for each block of the box that does not hide the triangle: the block's first
  /// pixel in the tile, and which of its rows belong to the box.
  template <class Draw>
  ISOSHADE_INLINE void for_each_block(int lane, const Draw& draw) {
    const int x0 = x0_[lane] & -block_size, x1 = x1_[lane], y0 = y0_[lane], y1 = y1_[lane];
    const float nearest = nearest_[lane];
    for (int y = y0 & -block_size; y <= y1; y += block_size) {
      const int begin = greatest(y0 - y, 0), end = least(y1 - y + 1, block_size);
      for (int x = x0; x <= x1; x += block_size)
        if (nearest > farthest_[y + x / block_size]) draw(x, y, begin, end);
    }
  }

  /// Edge functions of 32 bits.
  ISOSHADE_INLINE void draw_small(int lane) {
    Int lane_steps[3], row_steps[3];
    for (int k = 0; k < 3; ++k) {
      lane_steps[k] = shift_left(lane_steps_[k], 8);
      row_steps[k] = Int(steps_y_[k] * 256 * rows);
    }
    const Int rounding[3] = {Int(rounding_[0][lane]), Int(rounding_[1][lane]), Int(rounding_[2][lane])};
    const int x0 = x0_[lane], y0 = y0_[lane];
    for_each_block(lane, [&](int x, int y, int begin, int end) __attribute__((always_inline)) {
      begin &= -rows;
      int at_block[3];
      for (int k = 0; k < 3; ++k) {
        const int first = at_first_[k][lane] + 256 * (steps_x_[k] * (x - x0) + steps_y_[k] * (y - y0));
        if (first + 256 * (block_size - 1) * (greatest(steps_x_[k], 0) + greatest(steps_y_[k], 0)) < 0) return;
        at_block[k] = first + 256 * steps_y_[k] * begin;
      }
      const int storage = (y + x / block_size) * block_pixels;
      for (int column = 0; column < block_size; column += columns) {
        Int value[3];
        for (int k = 0; k < 3; ++k) value[k] = Int(at_block[k] + 256 * steps_x_[k] * column) + lane_steps[k];
        for (int row = begin; row < end; row += rows) {
          const Bool covered = (value[0] | value[1] | value[2]) >= Int(0);
          if (any(covered)) {
            const Float depth = interpolate(value[0] + rounding[0], value[1] + rounding[1], value[2] + rounding[2],
                                            depths_[0], depths_[1], depths_[2]);
            test(covered, depth, storage + row * block_size + column);
          }
          for (int k = 0; k < 3; ++k) value[k] = value[k] + row_steps[k];
        }
      }
      if (is_over_) farthest_[y + x / block_size] = 0.0f;
      touch(y + x / block_size);
    });
  }

  /// Edge functions of up to 46 bits, in two words: upper * 2^23 + lower.
  ISOSHADE_INLINE void draw_large(int lane) {
    const Triangle triangle = triangle_at(triangles_, number_);
    int64_t at_tile[3];
    Int lane_upper[3], lane_lower[3];
    for (int k = 0; k < 3; ++k) {
      at_tile[k] = static_cast<int64_t>(steps_y_[k]) * (256 * y_ + 128 - triangle.y(k)) +
                   static_cast<int64_t>(steps_x_[k]) * (256 * x_ + 128 - triangle.x(k)) - rounding_[k][lane];
      lane_upper[k] = shift_right_signed(lane_steps_[k], 15);
      lane_lower[k] = shift_left(lane_steps_[k] & Int(0x7fff), 8);
    }
    for_each_block(lane, [&](int x, int y, int begin, int end) __attribute__((always_inline)) {
      int64_t at_block[3];
      bool is_inside = true;
      for (int k = 0; k < 3; ++k) {
        const int64_t step_x = 256 * static_cast<int64_t>(steps_x_[k]), step_y = 256 * static_cast<int64_t>(steps_y_[k]);
        at_block[k] = at_tile[k] + step_x * x + step_y * y;
        if (at_block[k] + (block_size - 1) * (greatest(step_x, int64_t{0}) + greatest(step_y, int64_t{0})) < 0) return;
        is_inside &= at_block[k] + (block_size - 1) * (least(step_x, int64_t{0}) + least(step_y, int64_t{0})) >= 0;
      }
      const int storage = (y + x / block_size) * block_pixels;
      for (int row = begin & -rows; row < end; row += rows)
        for (int column = 0; column < block_size; column += columns) {
          Int upper[3], lower[3];
          for (int k = 0; k < 3; ++k) {
            const int64_t first =
                at_block[k] + 256 * (static_cast<int64_t>(steps_x_[k]) * column + static_cast<int64_t>(steps_y_[k]) * row);
            const Int sum = Int(static_cast<int>(first & 0x7fffff)) + lane_lower[k];
            upper[k] = Int(static_cast<int>(first >> 23)) + lane_upper[k] + shift_right(sum, 23);
            lower[k] = (sum & Int(0x7fffff)) + Int(rounding_[k][lane]);
          }
          const Bool covered = is_inside | ((upper[0] | upper[1] | upper[2]) >= Int(0));
          if (!is_inside && !any(covered)) continue;
          Float value[3];
          for (int k = 0; k < 3; ++k) value[k] = to_float(upper[k]) * Float(8388608.0f) + to_float(lower[k]);
          const Float depth = functions::interpolate_depth<Float>({value[1], value[2], value[0]}, depths_[0], depths_[1],
                                                                  depths_[2]);
          test(covered, depth, storage + row * block_size + column);
        }
      if (is_inside) age_[y + x / block_size] = renewal;
      if (is_over_) farthest_[y + x / block_size] = 0.0f;
      touch(y + x / block_size);
    });
  }

  /// `edge0`: the edge function of vertices 0 and 1, which belongs to vertex 2; and so on.
  ISOSHADE_INLINE static Float interpolate(Int edge0, Int edge1, Int edge2, Float z0, Float z1, Float z2) {
    return functions::interpolate_depth<Float>({to_float(edge1), to_float(edge2), to_float(edge0)}, z0, z1, z2);
  }

  /// The depth test for the covered lanes.
  ISOSHADE_INLINE void test(Bool covered, Float depth, int storage) {
    const Float former = lanes::load_lanes<Float>(tile_.depth + storage);
    const Bool seen = covered & (over_ | (depth > former));
    if (!any(seen)) return;
    if constexpr (lists) {
      int is_seen[W];
      float depths[W];
      lanes::store_lanes(is_seen, select(seen, Int(1), Int(0)));
      lanes::store_lanes(depths, depth);
      for (int i = 0; i < W; ++i)
        if (is_seen[i] != 0) list(x_ + tile_x(storage + i), y_ + tile_y(storage + i), storage + i, number_, depths[i]);
    } else {
      lanes::store_lanes(tile_.depth + storage, select(seen, depth, former));
      const Int former_id = lanes::load_lanes<Int>(tile_.triangles + storage);
      lanes::store_lanes(tile_.triangles + storage, select(seen, id_, former_id));
    }
  }

  ISOSHADE_INLINE void list(int x, int y, int place, int id, float depth) {
    if (x > area_.x1 || y > area_.y1) return;
    const int next = candidates_->count++;
    candidates_->place[next] = place;
    candidates_->x[next] = x;
    candidates_->y[next] = y;
    candidates_->triangle[next] = id;
    candidates_->depth[next] = depth;
  }

  /// Takes note that a triangle was drawn in the block.
  ISOSHADE_INLINE void touch(int block) {
    if (++age_[block] < renewal) return;
    age_[block] = 0;
    const float* depth = tile_.depth + block * block_pixels;
    Float least_depths = lanes::load_lanes<Float>(depth);
    for (int i = W; i < block_pixels; i += W) least_depths = least(least_depths, lanes::load_lanes<Float>(depth + i));
    float all[W];
    lanes::store_lanes(all, least_depths);
    float result = all[0];
    for (int i = 1; i < W; ++i) result = least(result, all[i]);
    farthest_[block] = result;
  }

  const int32_t* triangles_;
  int x_, y_;
  Tile& tile_;
  Box area_;
  Candidates* candidates_;
  Int column_, row_;  ///< of each lane in its register

  float farthest_[blocks * blocks];  ///< at most the least depth of each block
  int age_[blocks * blocks];         ///< triangles drawn in it since then

  // Of the triangles in the group that have a few pixels: these. Of others: their boxes in the tile, and their edges.
  float few_depth_[few_pixels][W];
  int few_place_[few_pixels][W];
  int x0_[W], y0_[W], x1_[W], y1_[W];
  float nearest_[W];  ///< no pixel is nearer; above 1 if the depth test always passes
  int at_first_[3][W], rounding_[3][W];

  // The triangle that is drawn.
  int number_ = 0;
  Int id_;
  bool is_over_ = false;
  Bool over_;
  int steps_x_[3], steps_y_[3];  ///< of edge functions, from a pixel to the next, divided by 256
  Int lane_steps_[3];            ///< from the first lane of a register to each, divided by 256
  Float depths_[3];
};

template <int W>
ISOSHADE_INLINE void rasterize(const int32_t* triangles, const int32_t* which, int count, int x, int y,
                               Tile& tile) {
  TileRasterizer<W, false>(triangles, x, y, tile).draw(which, count);
}

template <int W>
ISOSHADE_INLINE int list(const int32_t* triangles, const int32_t* which, int count, int x, int y, const Box& area,
                         Tile& tile, Candidates& candidates) {
  return TileRasterizer<W, true>(triangles, x, y, tile, area, &candidates).draw(which, count);
}

}  // namespace isoshade::raster::detail
