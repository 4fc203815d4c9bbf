// SPDX-License-Identifier: Apache-2.0
// TypedGraph -> ir::Module.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "compiler/check/typed_graph.h"
#include "compiler/interface/binding.h"
#include "compiler/ir/module.h"

namespace isoshade::lower {

/// What is lowered of a pass of an effect: the colour of its pixels, where its vertices go, or where it is drawn.
enum class PassPart : uint8_t { color, position, coverage };
inline constexpr std::array pass_parts{PassPart::color, PassPart::position, PassPart::coverage};
/// Every pass has a colour.
bool has_part(const check::TypedGraph& graph, size_t pass, PassPart part);

/// By function of a module and origin of that function: the node in the Graph of its document, or ir::none.
using NodesOfOrigins = std::vector<std::vector<uint32_t>>;

/// A module, and what its document's function takes from outside.
struct Lowered {
  ir::Module module;
  interface::Interface interface;
};

struct LowerOptions {
  size_t pass = 0;  ///< of an effect
  PassPart part = PassPart::color;
  NodesOfOrigins* nodes = nullptr;  ///< if given, filled
  bool light_lists = false;         ///< lights are asked for by their places in a list, see first_light below
};

/// The module of a function document or of one pass of an effect: the functions that it uses, one a document,
/// and last its own. Nodes that the result does not depend on are left out. Calls to functions.def stay
/// calls, and their declarations have no bodies yet.
///
/// A function document becomes a function whose parameters are the inputs and whose results are the
/// outputs, in order; a matrix is its columns: "m_0", "m_1", ... Behind the inputs stand the other values that it or
/// a function that it calls reads, as a pass has them (below) but without groups: callers pass theirs on. An image that
/// is an input has a parameter only where it is read, and one for each decoding.
///
/// A pass becomes `shade` -> (color: vec4) with these parameters, as far as they are used:
///   surface.position vec3, .previous_position vec3, .normal vec3, .texcoord vec2, .view_direction vec3, .tangent vec3,
///     .bitangent vec3, .color vec4, .outline_normal vec3, .pixel_size float, .front_facing bool, and where the pass moves
///     vertices .shown_position vec3 for what lights are asked about; directions have length 1. In
///     world space; in others .position_object, .normal_view ...
///   spaces.world_from_object_0 ...  uniform; columns of the matrices between world, object and view space,
///     of which the fourth is the translation
///   frame.time       float, uniform; seconds
///   frame.has_environment  bool, uniform
///   pass_index, pass_count  int, uniform; of the repetitions of the pass
///   parameters.NAME  uniform; of the effect, in its order
///   images.NAME      int, uniform: a texture (sampling.h), or negative for none; of image_slots()
///   light_count      int, uniform: where there is a sum over lights
///   first_light      int, uniform, with LowerOptions::light_lists: the index of the first of them, 0 without
/// What a light gives comes from light_at(index: int uniform, position: vec3) -> (direction: vec3, color:
/// vec3), which is declared without a body where it is needed (see add_pixel_kernel). So are environment_at and
/// irradiance_at (environment.h).
///
/// Its position, if the pass has one, becomes `move_vertex` -> (position: vec3), with the same parameters but for
/// light_count; the surface is that of the mesh at a vertex.
///
/// Its cut-out, if the pass has one, becomes `coverage` -> (drawn: bool), with the same parameters but for light_count.
///
/// A post becomes `post_process` -> (color: vec4) with these parameters, as far as they are used:
///   screen.pixel, .coordinate vec2, .view_ray, .relative_origin vec3 (the ray begins there, from the camera's position)
///     and for each image NAME that is read .NAME_x, .NAME_y int (its pixel under the centre of the pixel that is made)
///     and .NAME_inside vec2 (where in that pixel): "depth", "color" for the one that the post goes over, "image_NAME"
///     for those that the document lists
///   sizes.screen     vec2, uniform; and .NAME_width, .NAME_height int
///   camera.position, .direction vec3, uniform; .depth_numerator, .depth_denominator vec2 (view_word)
///   frame.time, frame.has_environment, parameters.NAME  as in a pass
///   taps.NODE        int, uniform: how many taps the node sums
/// It reads images by NAME_at(x: int, y: int) -> (color: vec4), and the depth by depth_at -> (depth: float): declared
/// without bodies (see add_post_kernel), only called for pixels that the image has.
Lowered lower(const check::TypedGraph& graph, const LowerOptions& options = {});

/// Of a post: whether the result depends on nothing but the camera, the environment and what the depth and the image that it goes over have
/// at the pixel.
bool is_pointwise(const Lowered& post);
/// Of a post that is_pointwise(): whether the result is the same at all pixels that have the same depth and color.
bool ignores_place(const Lowered& post);

/// One function of a shader that other programs link.
struct ShaderEntry {
  PassPart part = PassPart::color;  ///< of an effect
  size_t pass = 0;                  ///< of an effect
  interface::Interface interface;
};

struct LoweredShader {
  ir::Module module;
  std::vector<ShaderEntry> entries;
};

/// All functions of a document in one module: of an effect, each pass's `shade`, `move_vertex` where it moves vertices,
/// and `coverage` where it is cut out; with the pass's name in front ("base_shade") if there is more than one pass.
LoweredShader lower_shader(const check::TypedGraph& graph);

/// All parameters of an effect or a post, needed or not, and of an effect the numbers of its images.
std::vector<interface::Binding> parameter_bindings(const check::TypedGraph& graph);

/// What the parameters of each input are called, by Graph::inputs: one, or one a column of a matrix. No two are alike.
std::vector<std::vector<std::string>> parameter_names(const check::TypedGraph& graph);

}  // namespace isoshade::lower
