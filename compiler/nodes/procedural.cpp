// SPDX-License-Identifier: Apache-2.0
// Patterns over texture coordinates and positions.
#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

using ir::Opcode;

/// Port 0 where texture coordinate `axis` is 0, port 1 where it is 1, interpolated in between.
template <uint32_t axis>
void ramp(Site& s) {
  const Value weight = s.call("saturate", {Value(s.b.extract(s[2], axis))});
  s.out[0] = s.call("mix", {s.in[0], s.in[1], weight});
}

/// Port 0 where texture coordinate `axis` is below the centre, else port 1.
template <uint32_t axis>
void split(Site& s) {
  const ir::ValueId below = s.op(Opcode::flt, {s.b.extract(s[3], axis), s[2]});
  s.out[0] = s.op(Opcode::select, {below, s[0], s[1]});
}

void place2d(Site& s) {
  enum : size_t { texcoord, pivot, scale, degrees, offset, order };
  if (s.settings[order] == 0) {
    s.out[0] = s.call("place2d", {s.in[texcoord], s.in[pivot], s.in[scale], s.in[degrees], s.in[offset]});
    return;
  }
  const ir::ValueId from_pivot = s.op(Opcode::fsub, {s[texcoord], s[pivot]});
  const ir::ValueId moved = s.op(Opcode::fsub, {from_pivot, s[offset]});
  const ir::ValueId turned = s.call("rotate2d", {moved, s.in[degrees]}).id();
  s.out[0] = s.op(Opcode::fadd, {s.op(Opcode::fdiv, {turned, s[scale]}), s[pivot]});
}

std::optional<Refusal> order_exists(std::span<const Type>, std::span<const uint32_t> settings, Type) {
  if (settings[5] <= 1) return std::nullopt;
  return Refusal{support::Id::out_of_range, 5, "\"operationorder\" must be 0 or 1"};
}

/// A noise of functions.def at `at` with the components of `type`. `row` has one component and `row`_vector3 three; the
/// fourth is `row` at an offset, as in MaterialX.
ir::ValueId noise_of_type(Site& s, std::string row, Type type, ir::ValueId at, std::vector<Value> settings) {
  const auto call = [&](const std::string& name, ir::ValueId point) {
    std::vector<Value> arguments{point};
    arguments.insert(arguments.end(), settings.begin(), settings.end());
    return call_function(s.b, name, arguments).id();
  };
  const auto width = static_cast<size_t>(graph::float_count(type));
  if (width == 1) return call(row, at);
  const ir::ValueId three = call(row + "_vector3", at);
  if (width == 3) return three;
  std::array<ir::ValueId, 4> components;
  for (uint32_t i = 0; i < 3; ++i) components[i] = s.b.extract(three, i);
  if (width == 4) {
    const std::array offsets{s.b.constant(19.0f), s.b.constant(73.0f), s.b.constant(29.0f)};
    const ir::ValueId offset = s.b.construct(std::span(offsets).first(s.b.type(at).width));
    components[3] = call(row, s.op(Opcode::fadd, {at, offset}));
  }
  return s.b.construct(std::span<const ir::ValueId>(components).first(width));
}

void noise(Site& s, const std::string& row) {
  const Type type = s.out_types[0];
  const ir::ValueId scaled = s.op(Opcode::fmul, {noise_of_type(s, row, type, s[2], {}), s[0]});
  const Value pivot = broadcast(s.b, s.in[1], Type::floating, type);
  s.out[0] = s.op(Opcode::fadd, {scaled, pivot.id()});
}

void fractal(Site& s) {
  enum : size_t { amplitude, octaves, lacunarity, diminish, position };
  const Value count = s.op(Opcode::itof, {s[octaves]});
  const ir::ValueId sum =
      noise_of_type(s, "fractal3d", s.out_types[0], s[position], {count, s.in[lacunarity], s.in[diminish]});
  s.out[0] = s.op(Opcode::fmul, {sum, s[amplitude]});
}

void worley(Site& s) {
  const int width = graph::float_count(s.out_types[0]);
  if (width == 1) {
    s.out[0] = s.call("worleynoise2d", {s.in[0], s.in[1]});
    return;
  }
  const ir::ValueId three = s.call("worleynoise2d_vector3", {s.in[0], s.in[1]}).id();
  s.out[0] = width == 3 ? three : s.b.construct(std::array{s.b.extract(three, 0), s.b.extract(three, 1)});
}

}  // namespace

std::vector<Row> procedural_rows() {
  const Port texcoord{"texcoord", Vector2, "the texture coordinates", SurfaceValue{Surface::texcoord}};
  const Port position{"position", Vector3, "the position", SurfaceValue{Surface::position, Space::object}};
  const Port amplitude{"amplitude", AnyFloat, "the maximum deviation from the centre value", 1.0f};
  const Port pivot{"pivot", Float, "the centre value", 0.0f};
  const Port to{"to", name_of(AnyFloat), "the type of the result; default: that of `amplitude`", ""};
  constexpr PortType distances{only(Type::floating) | only(Type::vector2) | only(Type::vector3), Variable::t};
  const Port left{"valuel", AnyFloat, "the value at the left, where u = 0"};
  const Port right{"valuer", AnyFloat, "the value at the right, where u = 1"};
  const Port top{"valuet", AnyFloat, "the value at the top, where v = 0"};
  const Port bottom{"valueb", AnyFloat, "the value at the bottom, where v = 1"};
  return {
      {"ramplr", "A linear ramp from `valuel` to `valuer` along u.", {left, right, texcoord}, AnyFloat, ramp<0>},
      {"ramptb", "A linear ramp from `valuet` to `valueb` along v.", {top, bottom, texcoord}, AnyFloat, ramp<1>},
      {"splitlr",
       "`valuel` where u is below `center`, else `valuer`.",
       {left, right, {"center", Float, "the boundary in u", 0.5f}, texcoord},
       AnyFloat,
       split<0>},
      {"splittb",
       "`valuet` where v is below `center`, else `valueb`.",
       {top, bottom, {"center", Float, "the boundary in v", 0.5f}, texcoord},
       AnyFloat,
       split<1>},
      {"noise2d",
       "2D Perlin noise in [-1, 1], times `amplitude`, plus `pivot`; every component is different.",
       {amplitude, pivot, texcoord, to},
       AnyFloat,
       [](Site& s) { noise(s, "noise2d"); }},
      {"noise3d",
       "3D Perlin noise in [-1, 1], times `amplitude`, plus `pivot`; every component is different.",
       {amplitude, pivot, position, to},
       AnyFloat,
       [](Site& s) { noise(s, "noise3d"); }},
      {"fractal3d",
       "A sum of octaves of noise3d. Each octave has `lacunarity` times the frequency and `diminish` times the amplitude "
       "of the previous one.",
       {amplitude,
        {"octaves", Integer, "the number of octaves, 0 to 16", 3.0f},
        {"lacunarity", Float, "the frequency ratio of successive octaves", 2.0f},
        {"diminish", Float, "the amplitude ratio of successive octaves", 0.5f},
        position,
        to},
       AnyFloat,
       fractal},
      {"cellnoise2d",
       "A random number in [0, 1) for each unit square.",
       {texcoord},
       Float,
       Function{"cellnoise2d"}},
      {"cellnoise3d",
       "A random number in [0, 1) for each unit cube.",
       {position},
       Float,
       Function{"cellnoise3d"}},
      {"worleynoise2d",
       "The distance to the nearest of random points, one per unit square; as vector2 or vector3, the distances to the "
       "nearest two or three.",
       {texcoord,
        {"jitter", Float, "how far points deviate from the centre of their square", 1.0f},
        {"to", name_of(distances), "float, vector2 or vector3", "float"}},
       distances,
       worley},
      {"rotate2d",
       "`in`, rotated about the origin by `amount` degrees, from the second axis towards the first.",
       {{"in", Vector2, "the vector"}, {"amount", Float, "the angle in degrees", 0.0f}},
       Vector2,
       Function{"rotate2d"}},
      {"place2d",
       "Texture coordinates that scale, rotate and move an image.",
       {texcoord,
        {"pivot", Vector2, "the centre of scaling and rotation", 0.0f},
        {"scale", Vector2, "the size of the image", 1.0f},
        {"rotate", Float, "the rotation of the image in degrees, from u towards v", 0.0f},
        {"offset", Vector2, "the displacement of the image", 0.0f},
        {"operationorder", WholeNumber, "0: scale, rotate, move; 1: move, rotate, scale", 0.0f}},
       Vector2,
       place2d,
       order_exists},
  };
}

}  // namespace isoshade::nodes
