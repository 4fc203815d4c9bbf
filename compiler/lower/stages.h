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
///   post   (x: int, y: int uniform) -> (color: vec4)
/// `object` is the first word of the object's record; x and y are whole pixels.
enum class Stage : uint8_t { vertex, depth, pixel, eval, post };
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

/// Adds `post` around the module's `post_process`, and the bodies of the functions that read images.
/// `images`: how the names begin that tell of each image (image_prefix): the one that the post goes over, then those
/// of its document. `record`: where each parameter lies in `objects`, and under tap_field() the number of taps of each
/// sum.
uint32_t add_post_kernel(ir::Module& module, const std::vector<std::string>& images,
                         const FieldOffsets& record);
/// No parameter has such a name.
inline std::string tap_field(const std::string& node) { return node + " taps"; }

/// The groups of parameters of `post_process`, and the prefix of names that tell of the depth.
inline constexpr const char* screen_group = "screen";
inline constexpr const char* sizes_group = "sizes";
inline constexpr const char* camera_group = "camera";
inline constexpr const char* taps_group = "taps";
inline constexpr std::string_view depth_prefix = "depth";

}  // namespace isoshade::lower
