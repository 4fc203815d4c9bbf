// SPDX-License-Identifier: Apache-2.0
// The surface point that is shaded. Only in effects: a function takes what it needs as inputs.
#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

/// Meshes have one set of texture coordinates and one of colours.
template <size_t port>
std::optional<Refusal> set_exists(std::span<const Type>, std::span<const uint32_t> settings, Type) {
  if (settings[port] == 0) return std::nullopt;
  return Refusal{support::Id::out_of_range, port, "meshes have the set 0 and no other"};
}

void facing_ratio(Site& s) {
  const ir::ValueId cosine = s.call("dot", {s.in[0], s.in[1]}).id();
  const ir::ValueId both_sides = s.op(ir::Opcode::fabs, {cosine});
  const ir::ValueId facing = s.op(ir::Opcode::select, {s[2], both_sides, cosine});
  const ir::ValueId inverted = s.op(ir::Opcode::fsub, {s.b.constant(1.0f), facing});
  s.out[0] = s.op(ir::Opcode::select, {s[3], inverted, facing});
}

}  // namespace

std::vector<Row> geometry_rows() {
  const Port space{"space", Choice, "the space that it is given in; \"model\" is \"object\"", "world",
                   space_names};
  constexpr std::string_view corner_doc =
      "The unit normal of one of up to three surfaces that meet at a vertex, as three sides of a box do; where fewer "
      "meet, one of them again. The same for all vertices at a place. Only for the \"position\" of a pass.";
  const Port set{"index", WholeNumber, "which set of texture coordinates", 0.0f};
  return {
      {"position", "Where the point is.", {space}, Vector3, Surface::position},
      {"normal", "The unit normal of the surface.", {space}, Vector3, Surface::normal},
      {"outlinenormal",
       "The unit normal that leads out of the mesh, one for all vertices at a place: edges of a mesh that "
       "have "
       "two normals do not come apart when it moves along this one.",
       {space},
       Vector3,
       Surface::outline_normal},
      {"cornernormal1", corner_doc, {space}, Vector3, Surface::corner_normal1},
      {"cornernormal2", corner_doc, {space}, Vector3, Surface::corner_normal2},
      {"cornernormal3", corner_doc, {space}, Vector3, Surface::corner_normal3},
      {"tangent",
       "The unit vector along u on the surface.",
       {space, set},
       Vector3,
       Surface::tangent,
       set_exists<1>},
      {"bitangent",
       "The unit vector against v on the surface: up in the picture that it is covered with.",
       {space, set},
       Vector3,
       Surface::bitangent,
       set_exists<1>},
      {"viewdirection",
       "The unit vector from the point towards the viewer.",
       {space},
       Vector3,
       Surface::view_direction},
      {"facingratio",
       "The cosine of the angle between `viewdirection` and `normal`.",
       {{"viewdirection", Vector3, "unit length", SurfaceValue{Surface::view_direction}},
        {"normal", Vector3, "unit length", SurfaceValue{Surface::normal}},
        {"faceforward", Boolean, "without its sign, so that a back is like a front", true},
        {"invert", Boolean, "1 - the cosine", false}},
       Float,
       facing_ratio},
      {"texcoord",
       "The texture coordinates of the point: u to the right and v down in the picture, both 0 to 1.",
       {set},
       Vector2,
       Surface::texcoord,
       set_exists<0>},
      {"vertexcolor",
       "The colour that the mesh has there, linear; white where it has none. MaterialX's geomcolor.",
       {{"index", WholeNumber, "which set of colours", 0.0f}},
       Color4,
       Surface::color,
       set_exists<0>},
      {"pixelsize",
       "How many units of world space a pixel covers at the point, from top to bottom. In perspective it "
       "grows "
       "with the distance along the view.",
       {},
       Float,
       Surface::pixel_size},
      {"ddx",
       "What `in` changes by from a pixel to the next on its right: its derivative, not a difference, along "
       "the "
       "triangle that the pixel shows.",
       {{"in", AnyFloat, "the value"}},
       AnyFloat,
       Derivative::x},
      {"ddy",
       "What `in` changes by from a pixel to the next below: its derivative along the triangle.",
       {{"in", AnyFloat, "the value"}},
       AnyFloat,
       Derivative::y},
      {"fwidth",
       "The magnitude of `ddx` plus that of `ddy`: about what `in` changes by across a pixel.",
       {{"in", AnyFloat, "the value"}},
       AnyFloat,
       Derivative::width},
      {"time", "Seconds since the beginning: the scene's \"time\".", {}, Float, Time{}},
  };
}

}  // namespace isoshade::nodes
