// SPDX-License-Identifier: Apache-2.0
// The kernels around what an author wrote: they load by frame_layout.h, interpolate, and call it. IR like all
// else, so that both languages and the interpreter run one definition.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "compiler/graph/graph.h"
#include "compiler/interface/binding.h"
#include "compiler/interface/pass_state.h"
#include "compiler/ir/module.h"

namespace isoshade::lower {

/// Each kernel is a function of the module named as the enumerator:
///   vertex (vertex: int, object: int uniform, projected: int uniform) -> (clip: vec4)
///   setup  (see setup.h)                                                           the same for every scene
///   depth  (x: int, y: int, triangle: int) -> (depth: float)                      the same for every scene
///   cutout (x: int, y: int, triangle: int, object: int uniform) -> (drawn: bool, depth: float)
///   pixel  (x: int, y: int, triangle: int, object: int uniform, light_count: int uniform) -> (color: vec4)
///   blend  (x: int, y: int, triangle: int, object: int uniform, light_count: int uniform, backdrop: vec4)
///            -> (color: vec4, depth: float)           of a pixel that shows `backdrop` behind the triangle
///   eval   (row: int) -> (the function's results)
///   post   (x: int, y: int uniform) -> (color: vec4)
/// `object` is the first word of the object's record, and `projected` that of its matrix in `view`; x and y are whole
/// pixels.
enum class Stage : uint8_t { vertex, setup, depth, cutout, pixel, blend, eval, post };
std::string_view name(Stage stage);
/// Whether it decides which triangle a pixel shows. The result must not depend on the precision or the number type.
constexpr bool decides_visibility(Stage stage) {
  switch (stage) {
    case Stage::vertex:
    case Stage::setup:
    case Stage::depth:
    case Stage::cutout: return true;
    case Stage::pixel:
    case Stage::blend:
    case Stage::eval:
    case Stage::post: break;
  }
  return false;
}

/// Which parameter of the kernel is the first word of the object's record; none where there is no such record. That of a
/// post begins at word 0.
constexpr std::optional<size_t> record_parameter(Stage stage) {
  switch (stage) {
    case Stage::vertex: return 1;
    case Stage::cutout:
    case Stage::pixel:
    case Stage::blend: return 3;
    case Stage::setup:
    case Stage::depth:
    case Stage::eval:
    case Stage::post: break;
  }
  return std::nullopt;
}

/// Which kinds of light a scene has: the others are not asked about.
struct LightKinds {
  bool directional = true;
  bool point = true;
  bool spot = true;
  bool shadows = false;  ///< whether any has a shadow that the surface receives
  bool lists = false;    ///< each object lists its lights: object_word::first_light; only of passes that are lowered so
  std::optional<bool> environment = {};  ///< whether there is one, if that is known
};

/// A module with the frame's buffers and no function.
ir::Module frame_module();

/// Object space to clip space by the draw's matrix. Adds `vertex`; returns its index.
uint32_t add_vertex_kernel(ir::Module& module);

/// Adds `vertex` around the document's `move_vertex`, which returns positions in `space`.
uint32_t add_moving_vertex_kernel(ir::Module& module, const interface::Interface& interface,
                                  const interface::RecordLayout& record, graph::PositionSpace space);

/// Adds `depth`; returns its index.
uint32_t add_depth_kernel(ir::Module& module);

/// Adds `cutout` around the document's `coverage`, and the bodies of the functions that it asks its host for. What it
/// computes of a pixel that the triangle covers is what `depth` and the effect's graph give there.
uint32_t add_cutout_kernel(ir::Module& module, const interface::Interface& interface,
                           const interface::RecordLayout& record);

/// Adds `pixel` around the document's `shade`, and the bodies of the functions that it asks its host for.
uint32_t add_pixel_kernel(ir::Module& module, const interface::Interface& interface,
                          const interface::RecordLayout& record, LightKinds lights);

/// Adds `blend`: as `pixel`, but the color is blended with what is behind it. The depth is that of the triangle.
uint32_t add_blend_kernel(ir::Module& module, const interface::Interface& interface,
                          const interface::RecordLayout& record, LightKinds lights, interface::Blend blend);

/// What moves farther counts as this far, in pixels.
inline constexpr float farthest_motion = 16384.0f;

/// Adds `pixel`: how far what is seen has moved since the frame before, in pixels of the target, x to the right and y down;
/// then 0 and 1. The vertices have in place of their corner normals, which nothing reads once vertices have their places,
/// how much x, y and w in clip space have changed. What was behind the eye has not moved.
uint32_t add_motion_kernel(ir::Module& module);

/// Adds `post`, which completes such an image, its `color`: where alpha is 0, nothing is drawn, and the backdrop moves as the
/// camera turns. The record has the rows x, y and w of the matrices from directions in world space to clip space of the
/// camera, and then of the camera before.
uint32_t add_backdrop_motion_kernel(ir::Module& module);

/// Adds `eval` around `function`: its arguments are the words of record `row` of `inputs`, in order.
uint32_t add_eval_kernel(ir::Module& module, uint32_t function);

/// Adds `post` around the document's `post_process`, and the bodies of the functions that read images.
uint32_t add_post_kernel(ir::Module& module, const interface::Interface& interface,
                         const interface::RecordLayout& record, LightKinds lights);

}  // namespace isoshade::lower
