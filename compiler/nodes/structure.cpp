// SPDX-License-Identifier: Apache-2.0
// Construction, decomposition and conversion of values.
#include <limits>

#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

using graph::float_count;
using ir::Opcode;

constexpr TypeSet scalars = only(Type::boolean) | only(Type::integer) | only(Type::floating);

bool is_tuple(Type type) { return (vector_types | color_types).has(type); }

std::optional<Refusal> component_exists(std::span<const Type> types, std::span<const uint32_t> settings,
                                        Type) {
  const int count = float_count(types[0]);
  if (settings[1] < static_cast<uint32_t>(count)) return std::nullopt;
  return Refusal{support::Id::out_of_range, 1,
                 "a " + std::string(graph::type_name(types[0])) + " has the components 0 to " +
                     std::to_string(count - 1)};
}

/// Scalars convert to scalars and tuples, tuples to tuples.
std::optional<Refusal> conversion_exists(std::span<const Type> types, std::span<const uint32_t>, Type out) {
  const Type in = types[0];
  if (in == out) return std::nullopt;
  if (scalars.has(in) && (scalars.has(out) || is_tuple(out))) return std::nullopt;
  if (is_tuple(in) && is_tuple(out)) return std::nullopt;
  return Refusal{support::Id::type_mismatch, 0,
                 "a " + std::string(graph::type_name(in)) + " cannot be converted to " +
                     std::string(graph::type_name(out))};
}

/// Truncates towards zero and clamps to the range of integers; NaN gives 0.
ir::ValueId to_integer(Site& s) {
  constexpr float least = -2147483648.0f, greatest = 2147483520.0f;  // floats that fit in 32 bits
  const Value inside = s.call("clamp", {s.in[0], s.b.constant(least), s.b.constant(greatest)});
  const ir::ValueId number = s.op(Opcode::feq, {s[0], s[0]});
  const ir::ValueId within = s.op(Opcode::ftoi, {s.op(Opcode::select, {number, inside.id(), s.b.constant(0.0f)})});
  const ir::ValueId above = s.op(Opcode::fgt, {s[0], s.b.constant(greatest)});
  return s.op(Opcode::select, {above, s.b.constant(std::numeric_limits<int32_t>::max()), within});
}

void convert(Site& s) {
  const Type in = s.types[0];
  const Type out = s.out_types[0];
  if (in == out) {
    s.out[0] = s.in[0];
  } else if (in == Type::boolean && out == Type::integer) {
    s.out[0] = s.op(Opcode::select, {s[0], s.b.constant(1), s.b.constant(0)});
  } else if (in == Type::integer && out == Type::boolean) {
    s.out[0] = s.op(Opcode::ine, {s[0], s.b.constant(0)});
  } else if (out == Type::boolean) {
    s.out[0] = s.op(Opcode::fne, {s[0], s.b.constant(0.0f)});
  } else if (out == Type::integer) {
    s.out[0] = to_integer(s);
  } else if (in == Type::boolean) {
    const Value number = s.op(Opcode::select, {s[0], s.b.constant(1.0f), s.b.constant(0.0f)});
    s.out[0] = broadcast(s.b, number, Type::floating, out);
  } else if (!is_tuple(in)) {
    s.out[0] = broadcast(s.b, s.in[0], in, out);
  } else if (float_count(in) == float_count(out)) {
    s.out[0] = s.in[0];
  } else {
    std::array<ir::ValueId, 4> components;
    const int count = float_count(out);
    for (int i = 0; i < count; ++i)
      components[i] = i < float_count(in) ? s.b.extract(s[0], i) : s.b.constant(i == 3 ? 1.0f : 0.0f);
    s.out[0] = s.b.construct(std::span<const ir::ValueId>(components).first(count));
  }
}

void separate(Site& s) {
  const auto count = static_cast<uint32_t>(float_count(s.types[0]));
  for (uint32_t i = 0; i < s.out.size(); ++i) s.out[i] = s.b.extract(s[0], i % count);
}

/// Combines floats, or a tuple and a float.
void combine(Site& s) {
  std::array<ir::ValueId, 4> components;
  size_t count = 0;
  for (size_t i = 0; i < s.in.size(); ++i) {
    if (s.in[i].count == 0) continue;
    const int width = float_count(s.types[i]);
    if (width == 1) components[count++] = s[i];
    for (int c = 0; width > 1 && c < width; ++c) components[count++] = s.b.extract(s[i], c);
  }
  s.out[0] = s.b.construct(std::span<const ir::ValueId>(components).first(count));
}

std::optional<Refusal> one_more(std::span<const Type> types, std::span<const uint32_t>, Type out) {
  const int count = float_count(types[0]) + 1;
  if (float_count(out) == count) return std::nullopt;
  return Refusal{support::Id::type_mismatch, 2,
                 "a " + std::string(graph::type_name(types[0])) + " and a float have " + std::to_string(count) +
                     " components, but " + std::string(graph::type_name(out)) + " has " +
                     std::to_string(float_count(out)) + ": set \"to\" to the type of the result"};
}

std::optional<Refusal> columns_fit(std::span<const Type> types, std::span<const uint32_t>, Type out) {
  if (out == Type::matrix44 || types[0] == Type::vector3) return std::nullopt;
  return Refusal{support::Id::type_mismatch, 0, "the columns of a matrix33 must be vector3, not vector4"};
}

/// vector3 columns of a matrix44 are extended to those of an affine transform.
void create_matrix(Site& s) {
  std::array<ir::ValueId, 4> columns;
  const size_t count = s.out_types[0] == Type::matrix33 ? 3 : 4;
  for (size_t i = 0; i < count; ++i) {
    columns[i] = s[i];
    if (count == 3 || s.types[i] == Type::vector4) continue;
    std::array<ir::ValueId, 4> components;
    for (int c = 0; c < 3; ++c) components[static_cast<size_t>(c)] = s.b.extract(s[i], c);
    components[3] = s.b.constant(i == 3 ? 1.0f : 0.0f);
    columns[i] = s.b.construct(components);
  }
  s.out[0] = Value(std::span<const ir::ValueId>(columns).first(count));
}

}  // namespace

std::vector<Row> structure_rows() {
  const PortType three{only(Type::vector3) | only(Type::color3), Variable::t};
  const PortType four{only(Type::vector4) | only(Type::color4), Variable::t};
  const PortType begun{scalar_types | only(Type::vector2) | only(Type::vector3) | only(Type::color3), Variable::t};
  const PortType ended{vector_types | only(Type::color4), Variable::u};
  const PortType column{only(Type::vector3) | only(Type::vector4), Variable::t};
  const PortType matrix{matrix_types, Variable::u};
  const Port in1{"in1", Float, "component 0: x or r", 0.0f};
  const Port in2{"in2", Float, "component 1: y or g", 0.0f};
  const Port in3{"in3", Float, "component 2: z or b", 0.0f};
  const Port in4{"in4", Float, "component 3: w or a", 0.0f};
  return {
      {"constant",
       "A constant. An array is a vector unless `to` is color3, color4 or a matrix (column by column).",
       {{"value", Any, "the value"}, {"to", name_of(Any), "its type; default: inferred from the value", ""}},
       Any,
       [](Site& s) { s.out[0] = s.in[0]; }},
      {"convert",
       "Converts `in` to another type. Scalars fill every component; vectors and colours lose components, or gain 0, and "
       "1 as the fourth. Floats are truncated and clamped to integers. Non-zero is true.",
       {{"in", Any, "the value"}, {"to", name_of(Other), "the type to convert to"}},
       Other,
       convert,
       conversion_exists},
      {"combine2",
       "A vector2 of two floats, or a vector or colour extended by one component.",
       {{"in1", begun, "the first component, or all but the last", 0.0f},
        {"in2", Float, "the last component", 0.0f},
        {"to", name_of(ended), "vector2, vector3, vector4 or color4", "vector2"}},
       ended,
       combine,
       one_more},
      {"combine3",
       "A vector3 or color3 of three floats.",
       {in1, in2, in3, {"to", name_of(three), "vector3 or color3", "vector3"}},
       three,
       combine},
      {"combine4",
       "A vector4 or color4 of four floats.",
       {in1, in2, in3, in4, {"to", name_of(four), "vector4 or color4", "vector4"}},
       four,
       combine},
      {"creatematrix",
       "A matrix from its columns: the images of the x, y and z axes and, in a matrix44, of the origin. vector3 columns "
       "of a matrix44 are extended by 0, the fourth by 1.",
       {{"in1", column, "the first column"},
        {"in2", column, "the second column"},
        {"in3", column, "the third column"},
        {"in4", column, "the fourth column of a matrix44", std::array{0.0f, 0.0f, 0.0f}},
        {"to", name_of(matrix), "matrix33 or matrix44", "matrix33"}},
       matrix,
       create_matrix,
       columns_fit},
      {"extract",
       "One component of `in`, like the link \"node.x\".",
       {{"in", VectorOrColor, "a vector or colour"},
        {"index", component_of(VectorOrColor), "the index of the component, from 0", 0.0f}},
       Float,
       [](Site& s) { s.out[0] = s.b.extract(s[0], s.settings[1]); },
       component_exists},
      {"separate2",
       "Both components of a vector2.",
       {{"in", Vector2, "the vector"}},
       {{"outx", Float}, {"outy", Float}},
       separate},
      {"separate3",
       "The components of `in`, each with two names.",
       {{"in", three, "a vector3 or color3"}},
       {{"outx", Float}, {"outy", Float}, {"outz", Float}, {"outr", Float}, {"outg", Float}, {"outb", Float}},
       separate},
      {"separate4",
       "The components of `in`, each with two names.",
       {{"in", four, "a vector4 or color4"}},
       {{"outx", Float},
        {"outy", Float},
        {"outz", Float},
        {"outw", Float},
        {"outr", Float},
        {"outg", Float},
        {"outb", Float},
        {"outa", Float}},
       separate},
  };
}

}  // namespace isoshade::nodes
