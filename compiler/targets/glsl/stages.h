// SPDX-License-Identifier: Apache-2.0
// Whole shaders: a kernel with the stage around it.
//
// Set 0: bindings 0 to n - 1 are the buffers of lower/frame_layout.h (only those used are declared), n `clip`
// (uvec4, written by vertex), n + 1 `ids` (isampler2D, read by pixel and blend), n + 2 a word that is 0.0 (see ir::Opcode),
// n + 6 to 8 are buffers of setup: `positions` (vec4), `indices` (int) and `cuts`, n + 9 to 11 of compute shaders: `seen`
// (int), `tiles` and `orders` (int);
// n + 3 `former_ids` (isampler2D), n + 4 `former_depth` and n + 5 `former_color` (sampler2D): of the layer before. Push
// constants, nine ints:
//   object, light_count, program, first, count, width, origin_x, origin_y, projected
//   vertex  a vertex shader without rasterisation. gl_VertexIndex is the vertex; its position is stored as bits at
//           clip[gl_VertexIndex - first + count].
//   setup   a compute shader. `clip` receives the record of each triangle. Of one that the host clips, `cuts` receives a
//           record, if there are no more than cut_room of them.
//   depth   a fragment shader: `flat in int triangle` at location 0; gl_FragDepth; out int at 0: triangle + 1. The
//           target's first pixel is (origin_x, origin_y) of the frame, as it is of pixel.
//   cutout  the same, but it discards pixels where the effect's cut-out does not hold.
//   pixel   a fragment shader: the id at its pixel, 0 for none; discards pixels of other programs; out vec4 at 0.
//   blend   as pixel, for a layer of triangles that are blended, over `former_color`.
//   eval    a fragment shader: row = first + x + y * width; discards rows >= count; results as bits, four to an
//           `out ivec4` at locations 0, 1, ...
//   post    a fragment shader: out vec4 at 0
//
// Compute shaders have six more ints in their push constants: left, top, columns, rows, place, pitch. They run on the
// pixels [left, left + columns) x [top, top + rows) of the target, in groups of compute_side x compute_side, or on the
// vertices or triangles [left, left + columns), in groups of compute_length. A pixel's four floats go to `layers`, to the
// word place + 4 * (y * pitch + x); its triangle is in `seen`, -1 for none.
//   vertex, setup   one call serves many draws. A table in `inputs` has `count` rows from the word `first` on, see table_row;
//           the draw of a vertex or a triangle is the last one that begins at or before it.
//   depth, cutout   find what is seen in a window of width x count pixels, whose first is (origin_x, origin_y) of the frame,
//           in two turns; `first` tells what to do. First each pixel's greatest depth is found, in `layers` from `place` on;
//           then in `seen` the first triangle that has it, see seen_order. Triangles of few pixels are drawn at once, of
//           others each tile by one group, from the list `tiles`.
#pragma once

#include <string>

#include "compiler/emit/target.h"
#include "compiler/lower/stages.h"

namespace isoshade::glsl {

/// Other shaders that some stages become.
enum class Variant : uint8_t {
  usual,
  vertex_eval,  ///< of eval: a vertex shader that stores the words of row gl_VertexIndex, one record after another, at the
                ///< binding of `clip` (ints)
  /// Of depth and cutout: keeps pixels whose triangle has a number of at least `first`, or if that is negative of at least
  /// the id that `former_ids` has there (none where that is 0), and passes the depth test against `former_depth`.
  /// gl_FragDepth is 1, so that under the test `>` the first triangle is kept that comes through. Of blend: writes the
  /// depth of the triangle, too, as out float at 1.
  layer,
  compute  ///< of all but eval
};

/// In `cuts`: how many triangles were kept, how many are to be clipped, two words unused; then records of 16 words: the
/// number of the triangle, three words unused, the positions of its vertices.
inline constexpr int cut_room = 4096;
inline constexpr int cut_words = 16, cut_head_words = 4;

/// The words of a row: the first vertex or triangle among those of the call; then of vertex where the draw's vertices begin,
/// where their positions go, `object` and `projected`; and of setup where the draw's indices begin, where the positions of
/// its vertices lie, the number of the first of these, and its surface in `inputs`.
namespace table_row {
inline constexpr int begin = 0, first = 1, position = 2;
inline constexpr int object = 3, projected = 4;
inline constexpr int vertex = 3, surface = 4;
inline constexpr int stride = 5;
}  // namespace table_row

/// What depth and cutout do as compute shaders: the first four in this order, for depth alone the first two. Then, if there
/// are triangles that are blended, for each layer of them the next two; the very first time in place of layer_of_triangles
/// first_layer_of_triangles, which lists tiles.
enum class Turn : int {
  depth_of_triangles,
  depth_of_tiles,
  seen_of_triangles,
  seen_of_tiles,
  layer_of_triangles,
  layer_of_tiles,
  first_layer_of_triangles
};
/// Triangles whose bounds have more pixels are drawn by tiles of so many pixels a side.
inline constexpr int most_pixels = 64, seen_tile = 16;
/// `tiles` begins with their number, and that of the last layer that shows anything, from 1 on; then follow pairs: the
/// triangle, and the tile, row by row. If there are more than tile_room, some are missing.
inline constexpr int tile_head_words = 2, tile_words = 2, tile_room = 1 << 22;
/// Groups that take tiles, one after the other.
inline constexpr int tile_groups = 4096;

/// In `seen`, until the backdrop is drawn, triangles have numbers that keep their order: `triangle << order_bits`. One from
/// the number `projected` on is what is left of a triangle that was cut: its number is in `inputs` from the word `object` on, that
/// of the triangle that was cut plus 1, 2, ...
inline constexpr int order_bits = 3;
inline constexpr int nothing_seen = 0x7fffffff;

/// `orders` has for each pixel the order of the triangle that was blended last, -1 for none, and then for each pixel that of
/// the next one.

inline constexpr int compute_side = 8;
inline constexpr int compute_length = 64;

/// The push constants of compute shaders, and their groups: of pixels, or of vertices.
std::string compute_interface(bool of_pixels);

/// A compute shader that makes numbers of triangles of their order in `seen`, and stores the background where there is none:
/// the words `object`, `light_count`, `program` and `first`.
std::string backdrop_compute();

/// A compute shader of the layer `first` of triangles that are blended: each pixel moves on to its next one, whose number it
/// finds in `seen`. `count`: the pixels in `orders`.
std::string layer_compute();

/// A compute shader that makes each pixel [left, left + columns) x [top, top + rows) the mean of 2 x 2 others, of `width` a
/// row: their colors begin at the word `object` of `layers`, their depths at `count`. The color goes to `place`, the depth to
/// `first`, in rows of `pitch`.
std::string halving_compute();

std::string stage(const ir::Module& module, uint32_t entry, lower::Stage stage, const emit::Heading& heading,
                  Variant variant = Variant::usual);

}  // namespace isoshade::glsl
