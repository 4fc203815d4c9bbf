// SPDX-License-Identifier: Apache-2.0
// The shaded surface point. Only in effects; functions take attributes as inputs.
#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"
#include "compiler/support/assert.h"

namespace isoshade::nodes {
namespace {

/// Meshes have one or two sets of an attribute.
template <size_t port, uint32_t sets>
std::optional<Refusal> set_exists(std::span<const Type>, std::span<const uint32_t> settings, Type) {
  if (settings[port] < sets) return std::nullopt;
  return Refusal{support::Id::out_of_range, port,
                 sets == 1 ? "meshes have only set 0" : "meshes have only the sets 0 and 1"};
}

void facing_ratio(Site& s) {
  const ir::ValueId cosine = s.call("dot", {s.in[0], s.in[1]}).id();
  const ir::ValueId both_sides = s.op(ir::Opcode::fabs, {cosine});
  const ir::ValueId facing = s.op(ir::Opcode::select, {s[2], both_sides, cosine});
  const ir::ValueId inverted = s.op(ir::Opcode::fsub, {s.b.constant(1.0f), facing});
  s.out[0] = s.op(ir::Opcode::select, {s[3], inverted, facing});
}

/// The node of an attribute, of which `attribute` is the first set.
Row surface_row(Surface attribute) {
  constexpr PortType types[] = {Boolean, Float, Vector2, Vector3, Color4};  // by width
  const interface::SurfaceRow& row = interface::row(attribute);
  Row node{row.node, row.doc, {}, types[row.width], attribute};
  if (row.has_spaces)
    node.ports.push_back({"space", Choice, "the coordinate space; \"model\" is \"object\"", "world", space_names});
  if (row.sets.empty()) return node;
  const uint32_t sets = interface::sets_of(attribute);
  support::assert_that(sets == 1 || (sets == 2 && !row.has_spaces), "no condition counts the sets of an attribute");
  node.condition = sets == 2 ? set_exists<0, 2> : row.has_spaces ? set_exists<1, 1> : set_exists<0, 1>;
  node.ports.push_back({"index", WholeNumber, row.sets, 0.0f});
  return node;
}

}  // namespace

std::vector<Row> geometry_rows() {
  std::vector<Row> rows{
      {"facingratio",
       "The cosine of the angle between `viewdirection` and `normal`.",
       {{"viewdirection", Vector3, "unit length", SurfaceValue{Surface::view_direction}},
        {"normal", Vector3, "unit length", SurfaceValue{Surface::normal}},
        {"faceforward", Boolean, "take the absolute value, so that back faces look like front faces", true},
        {"invert", Boolean, "1 minus the cosine", false}},
       Float,
       facing_ratio},
      {"ddx",
       "The screen-space derivative of `in` in x: its change per pixel to the right, along the triangle. Exact, not a "
       "finite difference.",
       {{"in", AnyFloat, "the value"}},
       AnyFloat,
       Derivative::x},
      {"ddy",
       "The screen-space derivative of `in` in y: its change per pixel downwards, along the triangle.",
       {{"in", AnyFloat, "the value"}},
       AnyFloat,
       Derivative::y},
      {"fwidth",
       "The magnitude of `ddx` plus that of `ddy`: approximately the change of `in` across a pixel.",
       {{"in", AnyFloat, "the value"}},
       AnyFloat,
       Derivative::width},
      {"passindex",
       "Which repetition of the pass is drawn, from 0 to `passcount` - 1; 0 in a pass without \"repeat\".",
       {},
       Integer,
       Repetition::index},
      {"passcount",
       "How often the pass is drawn: its \"repeat\", or 1 without one.",
       {},
       Integer,
       Repetition::count},
      {"time", "The \"time\" of the scene, in seconds.", {}, Float, Time{}},
  };
  for (uint32_t i = 0; i < interface::surface_count; i += interface::sets_of(static_cast<Surface>(i)))
    rows.push_back(surface_row(static_cast<Surface>(i)));
  return rows;
}

}  // namespace isoshade::nodes
