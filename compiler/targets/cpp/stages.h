// SPDX-License-Identifier: Apache-2.0
// Whole C++ files: a kernel with the stage around it.
//
// Lanes are chosen by the macros ISOSHADE_LANES (1, 4, 8, 16) and ISOSHADE_REGISTERS (1, 2). A file
// exports one of
//   void isoshade_vertex(const BufferView* buffers, int object, int projected, int first, int count, float* clip)
//   void isoshade_cutout(const BufferView* buffers, int object, int count, const int* x, const int* y,
//                        const int* triangle, int* drawn)                     1 where it is drawn, else 0
//   void isoshade_pixel(const BufferView* buffers, int object, int light_count, int count, const int* x,
//                       const int* y, const int* triangle, float* rgba)
//   void isoshade_eval(const BufferView* buffers, int first, int count, int* results)
//   void isoshade_post(const BufferView* buffers, int first, int y, int count, float* rgba)   x from `first` on
// with BufferView { const void* data; int size; } for each buffer, and 4 floats a vertex or pixel, or the
// result words of a row, written one after another. The caller holds an FpGuard.
#pragma once

#include <string>

#include "compiler/emit/target.h"
#include "compiler/lower/stages.h"

namespace isoshade::cpp {

/// Not for Stage::setup and Stage::depth, which the CPU rasteriser computes from the same templates.
std::string stage(const ir::Module& module, uint32_t entry, lower::Stage stage, const emit::Heading& heading);

}  // namespace isoshade::cpp
