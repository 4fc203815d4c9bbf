// SPDX-License-Identifier: Apache-2.0
#include "runtime/raster/clip.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "compiler/lower/frame_layout.h"
#include "runtime/lanes/lanes.h"
#include "runtime/raster/clip_kernels.h"
#include "runtime/raster/clip_polygon.h"
#include "runtime/raster/tile.h"

namespace isoshade::raster {
namespace {

namespace word = lower::triangle_word;
namespace flag = lower::triangle_flag;
namespace kept_flag = detail::kept_flag;

constexpr int vertex_stride = lower::vertex_word::stride;
constexpr size_t chunk_size = 4096;
static_assert(chunk_size <= detail::chunk_triangles);

int32_t depth_flag(interface::DepthTest test) {
  switch (test) {
    case interface::DepthTest::nearer: return 0;
    case interface::DepthTest::always: return flag::over;
  }
  return 0;
}

int32_t blend_flags(const Surface& surface) {
  if (!surface.blended) return 0;
  switch (surface.state.depth_write) {
    case interface::DepthWrite::off: return flag::blended | flag::keeps_depth;
    case interface::DepthWrite::on: return flag::blended;
  }
  return 0;
}

/// Writes records of one surface.
class Writer {
 public:
  explicit Writer(const Surface& surface)
      : bias_(surface.bias), turned_(record_word(surface, true)), straight_(record_word(surface, false)) {}

  /// The corners and the indices of their vertices, in the order of the surface's indices.
  void write(std::array<const Corner*, 3> corners, std::array<int32_t, 3> vertices, bool turned, bool wide,
             int32_t* record) const {
    if (turned) {
      std::swap(corners[1], corners[2]);
      std::swap(vertices[1], vertices[2]);
    }
    for (int i = 0; i < 3; ++i) {
      record[word::vertex + i] = vertices[static_cast<size_t>(i)];
      const Corner& corner = *corners[static_cast<size_t>(i)];
      std::memcpy(record + word::position + 2 * i, &corner, 2 * sizeof corner.x);  // x and y
      record[word::depth + i] = corner.depth;
      record[word::inverse_w + i] = corner.inverse_w;
    }
    record[word::object] = (turned ? turned_ : straight_) | (wide ? flag::wide : 0);
    if (bias_.is_set()) move_away(corners, record);
  }

 private:
  /// The corners wind so that the area is positive.
  void move_away(const std::array<const Corner*, 3>& corners, int32_t* record) const {
    int x[3], y[3];
    float depth[3];
    for (size_t i = 0; i < 3; ++i) {
      x[i] = corners[i]->x;
      y[i] = corners[i]->y;
      depth[i] = lanes::from_bits_normal(corners[i]->depth);
    }
    functions::move_depth(x, y, depth, bias_);
    for (size_t i = 0; i < 3; ++i) record[word::depth + i] = lanes::bits(depth[i]);
  }

  DepthBias bias_;
  int32_t turned_, straight_;
};

/// Appends the triangles of a polygon, a fan about its first vertex, and the vertices that clipping made, whose indices
/// are ~0, ~1, ...
void add(Polygon& polygon, const Culling& culling, const Writer& writer, std::vector<float>& vertices,
         std::vector<int32_t>& triangles) {
  for (int i = 0; i < polygon.count; ++i) {
    ClipVertex& vertex = polygon.vertices[static_cast<size_t>(i)];
    if (vertex.index != made_by_clipping) continue;
    vertex.index = ~static_cast<int32_t>(vertices.size() / vertex_stride);
    vertices.insert(vertices.end(), vertex.attributes.begin(), vertex.attributes.end());
  }
  for (size_t i = 2; i < static_cast<size_t>(polygon.count); ++i) {
    const std::array<const Corner*, 3> corners = {&polygon.corners[0], &polygon.corners[i - 1], &polygon.corners[i]};
    int x[3], y[3];
    for (size_t k = 0; k < 3; ++k) {
      x[k] = corners[k]->x;
      y[k] = corners[k]->y;
    }
    const Decision<int> decision = decide(x, y, culling);
    if (!decision.kept) continue;
    triangles.resize(triangles.size() + word::stride);
    writer.write(corners, {polygon.vertices[0].index, polygon.vertices[i - 1].index, polygon.vertices[i].index},
                 decision.turned, decision.wide, &triangles[triangles.size() - word::stride]);
  }
}

/// The polygon of a triangle, clipped. False if nothing is left.
bool clip(const Viewport& viewport, const Surface& surface, const CutTriangle& triangle,
          std::span<const float> vertices, Outside outside, Polygon& polygon) {
  for (size_t i = 0; i < 3; ++i) {
    const size_t record = size_t{surface.first_vertex} + triangle.indices[i];
    ClipVertex vertex{triangle.points[i], static_cast<int32_t>(record), {}};
    std::copy_n(vertices.data() + record * vertex_stride, vertex_stride, vertex.attributes.begin());
    polygon.add(vertex);
  }
  return clip(viewport, outside, polygon);
}

/// Where a record names a vertex that clipping made, gives its number.
void number_made(int32_t* record, int32_t first_made) {
  for (int i = word::vertex; i < word::vertex + 3; ++i)
    if (record[i] < 0) record[i] = first_made + ~record[i];
}

}  // namespace

/// A triangle that turns on the grid, whose y points down, turns the other way in the image.
Culling culling_of(const Surface& surface, const Box& pixels) {
  const auto is_culled = [&](bool front) {
    switch (surface.state.cull) {
      case interface::Cull::none: return false;
      case interface::Cull::back: return !front;
      case interface::Cull::front: return front;
    }
    return false;
  };
  return {is_culled(!surface.mirrored), is_culled(surface.mirrored), pixels};
}

int32_t record_word(const Surface& surface, bool turned) {
  const bool front = turned != surface.mirrored;
  return (surface.object << flag::bits) | depth_flag(surface.state.depth) | (front ? 0 : flag::back) |
         (surface.cutout ? flag::cutout : 0) | blend_flags(surface);
}

void cut_triangle(const Viewport& viewport, const Surface& surface, const CutTriangle& triangle,
                  std::span<const float> vertices, int32_t first_made, std::vector<float>& made,
                  std::vector<int32_t>& triangles) {
  Outside any = 0, all = static_cast<Outside>(~0);
  for (const Point& point : triangle.points) {
    const Outside outside = viewport.classify(point);
    any |= outside;
    all &= outside;
  }
  Polygon polygon;
  if ((any & unusable) != 0 || all != 0 || !clip(viewport, surface, triangle, vertices, any, polygon)) return;
  const size_t former = triangles.size();
  add(polygon, culling_of(surface, viewport.pixels()), Writer(surface), made, triangles);
  for (size_t i = former; i < triangles.size(); i += word::stride) number_made(&triangles[i], first_made);
}

Clipper::Clipper(int lanes) : lanes_(lanes != 0 ? lanes : rasterizer_lanes()) {}

void Clipper::begin(std::span<const Surface> surfaces, int width, int height) {
  viewport_ = Viewport(width, height);
  surfaces_ = surfaces;
  first_corners_.clear();
  chunks_.clear();
  size_t corners = 0, triangles = 0;
  for (size_t s = 0; s < surfaces.size(); ++s) {
    first_corners_.push_back(corners);
    corners += surfaces[s].clip.size() / 4;
    const size_t count = surfaces[s].indices.size() / 3;
    for (size_t first = 0; first < count; first += chunk_size) {
      const size_t taken = std::min(chunk_size, count - first);
      // A part of kept_ has room for one more.
      chunks_.push_back({.surface = s,
                         .first = first,
                         .count = static_cast<int>(taken),
                         .kept_at = triangles + chunks_.size()});
      triangles += taken;
    }
  }
  corners_.resize(corners);
  kept_.resize(triangles + chunks_.size());
}

void Clipper::project(size_t surface, size_t first, size_t count) {
  detail::clip_kernels(lanes_).project(viewport_, surfaces_[surface].clip.data() + 4 * first, static_cast<int>(count),
                                       corners_.data() + first_corners_[surface] + first);
}

void Clipper::decide(Chunk& chunk, std::span<const float> vertices) {
  const Surface& surface = surfaces_[chunk.surface];
  uint16_t* const kept = kept_.data() + chunk.kept_at;
  chunk.kept = detail::clip_kernels(lanes_).decide(corners_.data() + first_corners_[chunk.surface],
                                                   surface.indices.data() + 3 * chunk.first, chunk.count,
                                                   culling_of(surface, viewport_.pixels()), kept);
  if (std::any_of(kept, kept + chunk.kept, [](uint16_t entry) { return entry & kept_flag::cut; })) cut(chunk, vertices);
}

void Clipper::cut(Chunk& chunk, std::span<const float> vertices) const {
  const Surface& surface = surfaces_[chunk.surface];
  const Corner* const corners = corners_.data() + first_corners_[chunk.surface];
  const Culling culling = culling_of(surface, viewport_.pixels());
  const Writer writer(surface);
  chunk.cut = std::make_unique<Cut>();
  Cut& result = *chunk.cut;
  for (const uint16_t entry : std::span(kept_).subspan(chunk.kept_at, static_cast<size_t>(chunk.kept))) {
    if ((entry & kept_flag::cut) == 0) continue;
    const size_t former = result.triangles.size();
    CutTriangle triangle{surface.indices.subspan(3 * (chunk.first + (entry >> kept_flag::bits)), 3), {}};
    Polygon polygon;
    Outside outside = 0;
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t index = triangle.indices[i];
      const float* p = surface.clip.data() + size_t{4} * index;
      triangle.points[i] = {p[0], p[1], p[2], p[3]};
      if (corners[index].x == not_inside) outside |= static_cast<Outside>(corners[index].y);
    }
    if (clip(viewport_, surface, triangle, vertices, outside, polygon))
      add(polygon, culling, writer, result.vertices, result.triangles);
    result.counts.push_back(static_cast<int>((result.triangles.size() - former) / word::stride));
  }
}

void Clipper::write(const Chunk& chunk, int32_t first_made, int32_t* record) const {
  const Surface& surface = surfaces_[chunk.surface];
  const Corner* const corners = corners_.data() + first_corners_[chunk.surface];
  const Writer writer(surface);
  const int32_t* cut_record = chunk.cut ? chunk.cut->triangles.data() : nullptr;
  const int* cut_count = chunk.cut ? chunk.cut->counts.data() : nullptr;
  for (const uint16_t entry : std::span(kept_).subspan(chunk.kept_at, static_cast<size_t>(chunk.kept))) {
    if (entry & kept_flag::cut) {
      for (int left = *cut_count++; left > 0; --left, cut_record += word::stride, record += word::stride) {
        std::copy_n(cut_record, word::stride, record);
        number_made(record, first_made);
      }
      continue;
    }
    const uint32_t* index = surface.indices.data() + 3 * (chunk.first + (entry >> kept_flag::bits));
    const auto first = static_cast<int32_t>(surface.first_vertex);
    writer.write({corners + index[0], corners + index[1], corners + index[2]},
                 {first + static_cast<int32_t>(index[0]), first + static_cast<int32_t>(index[1]),
                  first + static_cast<int32_t>(index[2])},
                 entry & kept_flag::turned, entry & kept_flag::wide, record);
    record += word::stride;
  }
}

void Clipper::finish(threads::Workers& workers, support::Array<float>& vertices, support::Array<int32_t>& triangles) {
  workers.for_each(chunks_.size(), [&](size_t c) { decide(chunks_[c], vertices); });

  struct Place {
    size_t triangle, made;
  };
  std::vector<Place> places;
  places.reserve(chunks_.size());
  const size_t given = vertices.size() / vertex_stride;
  Place next{0, given};
  for (const Chunk& chunk : chunks_) {
    places.push_back(next);
    next.triangle += static_cast<size_t>(chunk.kept);
    if (!chunk.cut) continue;
    next.triangle += chunk.cut->triangles.size() / word::stride - chunk.cut->counts.size();
    next.made += chunk.cut->vertices.size() / vertex_stride;
  }
  triangles.resize(next.triangle * word::stride);
  vertices.resize(next.made * vertex_stride);

  workers.for_each(chunks_.size(), [&](size_t c) {
    const Chunk& chunk = chunks_[c];
    write(chunk, static_cast<int32_t>(places[c].made), triangles.data() + places[c].triangle * word::stride);
    if (chunk.cut) std::ranges::copy(chunk.cut->vertices, vertices.data() + places[c].made * vertex_stride);
  });
}

void Clipper::run(std::span<const Surface> surfaces, int width, int height, threads::Workers& workers,
                  support::Array<float>& vertices, support::Array<int32_t>& triangles) {
  begin(surfaces, width, height);
  struct Part {
    size_t surface, first, count;
  };
  std::vector<Part> parts;
  for (size_t s = 0; s < surfaces.size(); ++s) {
    const size_t count = surfaces[s].clip.size() / 4;
    for (size_t first = 0; first < count; first += chunk_size)
      parts.push_back({s, first, std::min(chunk_size, count - first)});
  }
  workers.for_each(parts.size(), [&](size_t p) { project(parts[p].surface, parts[p].first, parts[p].count); });
  finish(workers, vertices, triangles);
}

}  // namespace isoshade::raster
