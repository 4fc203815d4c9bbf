// SPDX-License-Identifier: Apache-2.0
// Whole shaders: a kernel with the stage around it.
//
// Set 0: bindings 0 to n - 1 are the buffers of lower/frame_layout.h (only those used are declared), n `clip`
// (uvec4, written by vertex), n + 1 `ids` (isampler2D, read by pixel and blend), n + 2 a word that is 0.0 (see ir::Opcode),
// n + 3 `former_ids` (isampler2D), n + 4 `former_depth` and n + 5 `former_color` (sampler2D): of the layer before. Push
// constants, nine ints:
//   object, light_count, program, first, count, width, origin_x, origin_y, projected
//   vertex  a vertex shader without rasterisation. gl_VertexIndex is the vertex; its position is stored as bits at
//           clip[gl_VertexIndex - first + count].
//   depth   a fragment shader: `flat in int triangle` at location 0; gl_FragDepth; out int at 0: triangle + 1. The
//           target's first pixel is (origin_x, origin_y) of the frame, as it is of pixel.
//   cutout  the same, but it discards pixels where the effect's cut-out does not hold.
//   pixel   a fragment shader: the id at its pixel, 0 for none; discards pixels of other programs; out vec4 at 0.
//   blend   as pixel, for a layer of triangles that are blended, over `former_color`.
//   eval    a fragment shader: row = first + x + y * width; discards rows >= count; results as bits, four to an
//           `out ivec4` at locations 0, 1, ...
//   post    a fragment shader: out vec4 at 0
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
  layer
};

std::string stage(const ir::Module& module, uint32_t entry, lower::Stage stage, const emit::Heading& heading,
                  Variant variant = Variant::usual);

}  // namespace isoshade::glsl
