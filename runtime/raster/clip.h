// SPDX-License-Identifier: Apache-2.0
// From clip space to triangles on the pixel grid: clipping, division, snapping, culling. All backends rasterise the same
// integers: the host makes them, or a GPU by the same functions (lower/setup.h), for which the host clips.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "compiler/interface/pass_state.h"
#include "compiler/support/memory.h"
#include "runtime/raster/viewport.h"
#include "runtime/threads/workers.h"

namespace isoshade::raster {

/// The largest side of an image that positions in 1/256 pixel can cover.
inline constexpr int max_image_size = 8192;
/// How far to the left of and above the image positions may lie, in pixels.
inline constexpr int max_before_image = 2048;

/// How far the depth of a triangle is moved away from the viewer.
struct DepthBias : functions::DepthBiasOf<float> {
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

/// How triangles of the surface are culled in an image of these pixels.
Culling culling_of(const Surface& surface, const Box& pixels);

/// The last word of the surface's triangle records, but for triangle_flag::wide: of those that turn counter-clockwise on
/// the grid, and of the others.
int32_t record_word(const Surface& surface, bool turned);

/// A triangle whose vertices do not all lie well inside.
struct CutTriangle {
  std::span<const uint32_t> indices;  ///< of the surface
  Point points[3];                    ///< in clip space
};
/// What Clipper makes of it: appends records to `triangles`, and those of the vertices that clipping makes to `made`, whose
/// first has the number `first_made`.
void cut_triangle(const Viewport& viewport, const Surface& surface, const CutTriangle& triangle,
                  std::span<const float> vertices, int32_t first_made, std::vector<float>& made,
                  std::vector<int32_t>& triangles);

/// Makes the triangles of a view. Keeps its memory for the next one.
///
/// `triangles` receives those of all surfaces (records of lower/frame_layout.h), in the order of the surfaces and of their
/// indices; the records of the vertices that clipping makes are appended to `vertices`. Both have the same bits for any
/// number of threads and lanes. Width and height are 1 to 8192 pixels.
///
/// Drops triangles that are culled, have no area, cover no pixel centre of the image, or have a vertex that is not
/// finite. Clips at the near and the far plane, 2048 pixels left of and above the image's first pixel, and 8190 pixels (or
/// the image's size, if greater) right of and below it. Triangles that share an edge share both ends of what clipping
/// leaves of it.
class Clipper {
 public:
  /// `lanes`: 4, 8 or 16, which the machine must have; 0: as many as it has.
  explicit Clipper(int lanes = 0);

  void run(std::span<const Surface> surfaces, int width, int height, threads::Workers& workers,
           support::Array<float>& vertices, support::Array<int32_t>& triangles);

  // The same in steps, for a caller that projects vertices as soon as they have their positions in clip space.

  /// The positions of `surfaces` need not be known yet, only how many there are. The surfaces must outlive the other steps.
  void begin(std::span<const Surface> surfaces, int width, int height);
  /// Projects `count` vertices of a surface, from `first` on. Threads may project different vertices at the same time.
  void project(size_t surface, size_t first, size_t count);
  /// Makes the triangles, when all vertices are projected.
  void finish(threads::Workers& workers, support::Array<float>& vertices, support::Array<int32_t>& triangles);

 private:
  /// What becomes of the triangles of a chunk that are cut.
  struct Cut {
    std::vector<float> vertices;     ///< records
    std::vector<int32_t> triangles;  ///< records; ~i stands for the vertex i of the above
    std::vector<int> counts;         ///< how many of `triangles` each of them leaves
  };
  /// Consecutive triangles of a surface.
  struct Chunk {
    size_t surface;
    size_t first;  ///< in the surface
    int count;
    size_t kept_at;  ///< where its part of kept_ begins
    int kept = 0;
    std::unique_ptr<Cut> cut = nullptr;  ///< if triangles are cut
  };

  void decide(Chunk& chunk, std::span<const float> vertices);
  void cut(Chunk& chunk, std::span<const float> vertices) const;
  void write(const Chunk& chunk, int32_t first_made, int32_t* record) const;

  int lanes_;
  Viewport viewport_;
  std::span<const Surface> surfaces_;
  std::vector<size_t> first_corners_;  ///< of each surface in corners_
  support::Array<Corner> corners_;
  std::vector<Chunk> chunks_;
  support::Array<uint16_t> kept_;  ///< by the chunks, see detail::DecideTriangles
};

}  // namespace isoshade::raster
