// SPDX-License-Identifier: Apache-2.0
// Whole shaders and whole C++ files: a kernel with the stage around it.
//
// GLSL. Set 0: bindings 0 to n - 1 are the buffers of lower/frame_layout.h (only those used are declared), n `clip`
// (uvec4, written by vertex), n + 1 `ids` (isampler2D, read by pixel), n + 2 a word that is 0.0 (see ir::Opcode). Push
// constants, nine ints:
//   object, light_count, program, first, count, width, origin_x, origin_y, projected
//   vertex  a vertex shader without rasterisation. gl_VertexIndex is the vertex; its position is stored as bits at
//           clip[gl_VertexIndex - first + count].
//   depth   a fragment shader: `flat in int triangle` at location 0; gl_FragDepth; out int at 0: triangle + 1. The
//           target's first pixel is (origin_x, origin_y) of the frame, as it is of pixel.
//   pixel   a fragment shader: the id at its pixel, 0 for none; discards pixels of other programs; out vec4 at 0.
//   eval    a fragment shader: row = first + x + y * width; discards rows >= count; results as bits, four to an
//           `out ivec4` at locations 0, 1, ...
//   post    a fragment shader: out vec4 at 0
//
// C++. Lanes are chosen by the macros ISOSHADE_LANES (1, 4, 8, 16) and ISOSHADE_REGISTERS (1, 2). A file
// exports one of
//   void isoshade_vertex(const BufferView* buffers, int object, int projected, int first, int count, float* clip)
//   void isoshade_pixel(const BufferView* buffers, int object, int light_count, int count, const int* x,
//                       const int* y, const int* triangle, float* rgba)
//   void isoshade_eval(const BufferView* buffers, int first, int count, int* results)
//   void isoshade_post(const BufferView* buffers, int first, int y, int count, float* rgba)   x from `first` on
// with BufferView { const void* data; int size; } for each buffer, and 4 floats a vertex or pixel, or the
// result words of a row, written one after another. The caller holds an FpGuard.
#pragma once

#include <string>

#include "compiler/lower/stages.h"

namespace isoshade::emit {

/// What stands at the head of the text: the document and what made the text.
struct Heading {
  std::string document;
  std::string name;
};

/// Which shader an eval program becomes. As a vertex shader it stores the words of row gl_VertexIndex, one
/// record after another, at the binding of `clip` (ints).
enum class EvalIn : uint8_t { fragment_shader, vertex_shader };

std::string glsl_stage(const ir::Module& module, uint32_t entry, lower::Stage stage, const Heading& heading,
                       EvalIn eval_in = EvalIn::fragment_shader);
/// Not for Stage::depth, which the CPU rasteriser computes from the same templates.
std::string cpp_stage(const ir::Module& module, uint32_t entry, lower::Stage stage, const Heading& heading);

}  // namespace isoshade::emit
