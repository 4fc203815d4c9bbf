// SPDX-License-Identifier: Apache-2.0
// Reads the triangle records of lower/frame_layout.h; their pixel grid.
#pragma once

#include <cstdint>

#include "compiler/functions/triangle_setup.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::raster {

/// One record. Always inlined, because code for several instruction sets reads it.
struct Triangle {
  const int32_t* words;

  ISOSHADE_INLINE int x(int vertex) const { return words[lower::triangle_word::position + 2 * vertex]; }
  ISOSHADE_INLINE int y(int vertex) const { return words[lower::triangle_word::position + 2 * vertex + 1]; }
  ISOSHADE_INLINE float depth(int vertex) const {
    return lanes::from_bits_normal(words[lower::triangle_word::depth + vertex]);
  }
  ISOSHADE_INLINE bool wide() const {
    return words[lower::triangle_word::object] & lower::triangle_flag::wide;
  }
  ISOSHADE_INLINE bool over() const {
    return words[lower::triangle_word::object] & lower::triangle_flag::over;
  }
  ISOSHADE_INLINE bool cutout() const {
    return words[lower::triangle_word::object] & lower::triangle_flag::cutout;
  }
  ISOSHADE_INLINE bool blended() const {
    return words[lower::triangle_word::object] & lower::triangle_flag::blended;
  }
  ISOSHADE_INLINE bool keeps_depth() const {
    return words[lower::triangle_word::object] & lower::triangle_flag::keeps_depth;
  }
  /// The first word of its object's record.
  ISOSHADE_INLINE int object() const {
    return words[lower::triangle_word::object] >> lower::triangle_flag::bits;
  }
};

ISOSHADE_INLINE Triangle triangle_at(const int32_t* triangles, int index) {
  return {triangles + static_cast<int64_t>(index) * lower::triangle_word::stride};
}

/// How many of the triangles come before the first that is blended.
inline int opaque_count(const int32_t* triangles, int count) {
  int begin = 0, end = count;
  while (begin < end) {
    const int middle = begin + (end - begin) / 2;
    if (triangle_at(triangles, middle).blended())
      end = middle;
    else
      begin = middle + 1;
  }
  return begin;
}

using functions::BoxOf, functions::centres_between, functions::greatest, functions::least;
using Box = BoxOf<int>;

/// The pixels of a window.
ISOSHADE_INLINE Box box_at(int x, int y, int width, int height) {
  return {x, y, x + width - 1, y + height - 1};
}

ISOSHADE_INLINE Box bounds(Triangle t) {
  return centres_between(least(least(t.x(0), t.x(1)), t.x(2)), least(least(t.y(0), t.y(1)), t.y(2)),
                         greatest(greatest(t.x(0), t.x(1)), t.x(2)),
                         greatest(greatest(t.y(0), t.y(1)), t.y(2)));
}

/// The edge function of vertices `from` and `to` at pixel centre (x, y) is step_x * x + step_y * y + at_origin, divided
/// by 256 and rounded down; every pixel step is a multiple of 256, so the division is exact. It is not negative where
/// the pixel is on the inner side of the edge, or on the edge if that is a top or a left one.
struct Edge {
  int64_t at_origin;
  int step_x, step_y;
};

ISOSHADE_INLINE Edge edge_between(Triangle t, int from, int to) {
  const int dx = t.x(to) - t.x(from);
  const int dy = t.y(to) - t.y(from);
  const bool top_or_left = dy < 0 || (dy == 0 && dx > 0);
  const int64_t exact =
      static_cast<int64_t>(dx) * (128 - t.y(from)) - static_cast<int64_t>(dy) * (128 - t.x(from));
  return {(exact - (top_or_left ? 0 : 1)) >> 8, -dy, dx};
}

/// The three edges of a triangle, to decide which boxes it misses.
struct Edges {
  Edge all[3];

  ISOSHADE_INLINE explicit Edges(Triangle t)
      : all{edge_between(t, 0, 1), edge_between(t, 1, 2), edge_between(t, 2, 0)} {}

  /// False if all pixels of the box are on the outer side of one edge.
  ISOSHADE_INLINE bool reach(const Box& box) const {
    for (const Edge& edge : all) {
      const int64_t x = edge.step_x > 0 ? box.x1 : box.x0, y = edge.step_y > 0 ? box.y1 : box.y0;
      if (edge.at_origin + edge.step_x * x + edge.step_y * y < 0) return false;
    }
    return true;
  }
};

}  // namespace isoshade::raster
