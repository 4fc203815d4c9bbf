// SPDX-License-Identifier: Apache-2.0
// Triangles of the kinds that rasterisers get wrong, as records of lower/frame_layout.h.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "compiler/lower/frame_layout.h"

namespace isoshade::raster::shapes {

struct Position {
  int x, y;  ///< 1/256 pixel
};

inline constexpr const char* kinds[] = {"general", "small",      "subpixel", "sliver",
                                        "huge",    "on_centres", "quads",    "fans"};

class Shapes {
 public:
  Shapes(int width, int height, unsigned seed) : width_(width * 256), height_(height * 256), random_(seed) {}

  int between(int low, int high) {
    return low + static_cast<int>(random_() % static_cast<unsigned>(high - low + 1));
  }
  float fraction() { return static_cast<float>(random_() >> 8) / 16777216.0f; }

  /// About `count` triangles of a kind, some without area and wound either way.
  std::vector<std::array<Position, 3>> of(const std::string& kind, int count) {
    std::vector<std::array<Position, 3>> result;
    while (static_cast<int>(result.size()) < count) add(kind, result);
    return result;
  }

 private:
  Position point(int margin) {
    return {between(-margin, width_ + margin), between(-margin, height_ + margin)};
  }
  Position near(Position p, int distance) {
    return {p.x + between(-distance, distance), p.y + between(-distance, distance)};
  }
  Position on_grid(int grid, int offset) {
    const Position p = point(0);
    return {p.x / grid * grid + offset, p.y / grid * grid + offset};
  }

  void add(const std::string& kind, std::vector<std::array<Position, 3>>& out) {
    if (kind == "general") {
      out.push_back({point(width_ / 4), point(width_ / 4), point(width_ / 4)});
    } else if (kind == "small" || kind == "subpixel") {
      const Position p = point(0);
      const int size = kind == "small" ? 768 : 128;
      out.push_back({near(p, size), near(p, size), near(p, size)});
    } else if (kind == "sliver") {
      const Position p = point(width_ / 8), q = point(width_ / 8);
      out.push_back({p, q, near({p.x + (q.x - p.x) / 2, p.y + (q.y - p.y) / 2}, 3)});
    } else if (kind == "huge") {
      std::array<Position, 3> t;
      for (Position& p : t) p = {between(-8190 * 256, 8190 * 256), between(-8190 * 256, 8190 * 256)};
      out.push_back(t);
    } else if (kind == "on_centres") {
      std::array<Position, 3> t;
      for (Position& p : t) p = on_grid(between(0, 1) ? 128 : 256, between(0, 1) ? 128 : 0);
      out.push_back(t);
    } else if (kind == "quads") {
      const int grid = between(0, 1) ? 64 : 1;
      const Position p = on_grid(grid, 0), q = on_grid(grid, 0);
      out.push_back({p, Position{q.x, p.y}, q});
      out.push_back({p, q, Position{p.x, q.y}});
    } else {
      const std::vector<std::array<Position, 3>> closed = fan(point(0), between(5, 12), 256, std::max(512, width_ / 2));
      out.insert(out.end(), closed.begin(), closed.end());
    }
  }

 public:
  /// All around a centre.
  std::vector<std::array<Position, 3>> fan(Position centre, int count, int nearest, int farthest) {
    std::vector<Position> rim;
    for (int i = 0; i < count; ++i) {
      const double angle = 6.283185307179586 * i / count;
      const int radius = between(nearest, farthest);
      rim.push_back({centre.x + static_cast<int>(radius * std::cos(angle)),
                     centre.y + static_cast<int>(radius * std::sin(angle))});
    }
    std::vector<std::array<Position, 3>> result;
    for (int i = 0; i < count; ++i)
      result.push_back({centre, rim[static_cast<size_t>(i)], rim[static_cast<size_t>((i + 1) % count)]});
    return result;
  }

 private:
  int width_, height_;
  std::mt19937 random_;
};

/// Appends the record; false if the triangle has no area.
inline bool append(std::vector<int32_t>& triangles, std::array<Position, 3> t, std::array<float, 3> depth) {
  namespace word = lower::triangle_word;
  const int64_t area = static_cast<int64_t>(t[1].x - t[0].x) * (t[2].y - t[0].y) -
                       static_cast<int64_t>(t[1].y - t[0].y) * (t[2].x - t[0].x);
  if (area == 0) return false;
  if (area < 0) std::swap(t[1], t[2]);
  std::array<int32_t, word::stride> record{};
  bool wide = false;
  for (int i = 0; i < 3; ++i) {
    const Position p = t[static_cast<size_t>(i)], q = t[static_cast<size_t>((i + 1) % 3)];
    wide |= std::abs(p.x - q.x) >= 1 << 15 || std::abs(p.y - q.y) >= 1 << 15;
    record[static_cast<size_t>(word::position + 2 * i)] = p.x;
    record[static_cast<size_t>(word::position + 2 * i + 1)] = p.y;
    record[static_cast<size_t>(word::depth + i)] = std::bit_cast<int32_t>(depth[static_cast<size_t>(i)]);
    record[static_cast<size_t>(word::inverse_w + i)] = std::bit_cast<int32_t>(1.0f);
  }
  record[word::object] = wide ? lower::triangle_flag::wide : 0;
  triangles.insert(triangles.end(), record.begin(), record.end());
  return true;
}

inline int count(const std::vector<int32_t>& triangles) {
  return static_cast<int>(triangles.size() / lower::triangle_word::stride);
}

}  // namespace isoshade::raster::shapes
