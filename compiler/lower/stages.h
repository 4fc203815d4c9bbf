// SPDX-License-Identifier: Apache-2.0
// The kernels around what an author wrote: they load by frame_layout.h, interpolate, and call it. IR like all
// else, so that both languages and the interpreter run one definition.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/graph/graph.h"
#include "compiler/ir/module.h"

namespace isoshade::lower {

/// Each kernel is a function of the module named as the enumerator:
///   vertex (vertex: int, object: int uniform) -> (clip: vec4)
///   depth  (x: int, y: int, triangle: int) -> (depth: float)                      the same for every scene
///   pixel  (x: int, y: int, triangle: int, object: int uniform, light_count: int uniform) -> (color: vec4)
///   eval   (row: int) -> (the function's results)
/// `object` is the first word of the object's record; x and y are whole pixels.
enum class Stage : uint8_t { vertex, depth, pixel, eval };
std::string_view name(Stage stage);

/// Which kinds of light a scene has: the others are not asked about.
struct LightKinds {
  bool directional = true;
  bool point = true;
  bool spot = true;
};

/// A field of a record and the word where it begins.
using FieldOffsets = std::vector<std::pair<std::string, int>>;

/// A module with the frame's buffers and no function.
ir::Module frame_module();

/// Object space to clip space by the object's matrix. Adds `vertex`; returns its index.
uint32_t add_vertex_kernel(ir::Module& module);

/// Adds `vertex` around the module's `move_vertex`, which gives positions in `space`. `parameters` as below.
uint32_t add_moving_vertex_kernel(ir::Module& module, const FieldOffsets& parameters,
                                  graph::PositionSpace space);

/// Adds `depth`; returns its index.
uint32_t add_depth_kernel(ir::Module& module);

/// Adds `pixel` around the module's `shade`, and the bodies of `light_at` and of what reads textures, where they are
/// declared. `parameters`: where each effect parameter and each image lies, from the first word of the object's record.
uint32_t add_pixel_kernel(ir::Module& module, const FieldOffsets& parameters, LightKinds lights);

/// Adds `eval` around `function`: its arguments are the words of record `row` of `inputs`, in order.
uint32_t add_eval_kernel(ir::Module& module, uint32_t function);

}  // namespace isoshade::lower
