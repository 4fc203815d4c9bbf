// SPDX-License-Identifier: Apache-2.0
// Values made from texture coordinates and positions.
#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

using ir::Opcode;

/// `value_b` where the `axis` of the texture coordinates is 1, `value_a` where it is 0.
template <uint32_t axis>
void ramp(Site& s) {
  const Value share = s.call("saturate", {Value(s.b.extract(s[2], axis))});
  s.out[0] = s.call("mix", {s.in[0], s.in[1], share});
}

/// `value_a` below the centre.
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
  return Refusal{support::Id::out_of_range, 5, "\"operationorder\" is 0 or 1"};
}

/// A noise of functions.def at `at`, with as many components as the type has. `row` is that of one component;
/// the second and third are those of the row for vector3, the fourth is taken elsewhere, as in MaterialX.
ir::ValueId noise_of_type(Site& s, std::string row, Type type, ir::ValueId at, std::vector<Value> settings) {
  const auto call = [&](const std::string& name, ir::ValueId place) {
    std::vector<Value> arguments{place};
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
    const std::array away{s.b.constant(19.0f), s.b.constant(73.0f), s.b.constant(29.0f)};
    const ir::ValueId offset = s.b.construct(std::span(away).first(s.b.type(at).width));
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
  const Port texcoord{"texcoord", Vector2, "where it is asked for", SurfaceValue{Surface::texcoord}};
  const Port position{"position", Vector3, "where it is asked for",
                      SurfaceValue{Surface::position, Space::object}};
  const Port amplitude{"amplitude", AnyFloat, "how far it goes to either side", 1.0f};
  const Port pivot{"pivot", Float, "the value in the middle", 0.0f};
  const Port to{"to", name_of(AnyFloat), "the type of the result, where `amplitude` does not tell", ""};
  constexpr PortType distances{only(Type::floating) | only(Type::vector2) | only(Type::vector3), Variable::t};
  const Port left{"valuel", AnyFloat, "the value at the left, where u is 0"};
  const Port right{"valuer", AnyFloat, "the value at the right, where u is 1"};
  const Port top{"valuet", AnyFloat, "the value at the top, where v is 0"};
  const Port bottom{"valueb", AnyFloat, "the value at the bottom, where v is 1"};
  return {
      {"ramplr", "From `valuel` to `valuer` in proportion to u.", {left, right, texcoord}, AnyFloat, ramp<0>},
      {"ramptb", "From `valuet` to `valueb` in proportion to v.", {top, bottom, texcoord}, AnyFloat, ramp<1>},
      {"splitlr",
       "`valuel` where u is below `center`, else `valuer`.",
       {left, right, {"center", Float, "where they meet", 0.5f}, texcoord},
       AnyFloat,
       split<0>},
      {"splittb",
       "`valuet` where v is below `center`, else `valueb`.",
       {top, bottom, {"center", Float, "where they meet", 0.5f}, texcoord},
       AnyFloat,
       split<1>},
      {"noise2d",
       "Perlin noise over the plane, in [-1, 1] times `amplitude`, plus `pivot`; each component another.",
       {amplitude, pivot, texcoord, to},
       AnyFloat,
       [](Site& s) { noise(s, "noise2d"); }},
      {"noise3d",
       "Perlin noise in space, in [-1, 1] times `amplitude`, plus `pivot`; each component another.",
       {amplitude, pivot, position, to},
       AnyFloat,
       [](Site& s) { noise(s, "noise3d"); }},
      {"fractal3d",
       "A sum of noise3d, each octave `lacunarity` times as fine and `diminish` times as strong as the last.",
       {amplitude,
        {"octaves", Integer, "how many are summed, 0 to 16", 3.0f},
        {"lacunarity", Float, "how much finer each is than the last", 2.0f},
        {"diminish", Float, "how much weaker", 0.5f},
        position,
        to},
       AnyFloat,
       fractal},
      {"cellnoise2d",
       "A random number in [0, 1) for each square of side 1.",
       {texcoord},
       Float,
       Function{"cellnoise2d"}},
      {"cellnoise3d",
       "A random number in [0, 1) for each cube of side 1.",
       {position},
       Float,
       Function{"cellnoise3d"}},
      {"worleynoise2d",
       "The distance to the nearest of points scattered one in each square of side 1; to the nearest two or "
       "three as vector2 or vector3.",
       {texcoord,
        {"jitter", Float, "how far points are off the middle of their square", 1.0f},
        {"to", name_of(distances), "float, vector2 or vector3", "float"}},
       distances,
       worley},
      {"rotate2d",
       "`in` turned about the origin by `amount` degrees, from the second axis towards the first.",
       {{"in", Vector2, "the vector"}, {"amount", Float, "degrees", 0.0f}},
       Vector2,
       Function{"rotate2d"}},
      {"place2d",
       "Texture coordinates for a picture that is scaled, rotated and moved.",
       {texcoord,
        {"pivot", Vector2, "the point that it is scaled and rotated about", 0.0f},
        {"scale", Vector2, "how large the picture is", 1.0f},
        {"rotate", Float, "degrees that the picture turns, from u towards v", 0.0f},
        {"offset", Vector2, "how far the picture is moved", 0.0f},
        {"operationorder", WholeNumber, "0: scale, rotate, move; 1: move, rotate, scale", 0.0f}},
       Vector2,
       place2d,
       order_exists},
  };
}

}  // namespace isoshade::nodes
