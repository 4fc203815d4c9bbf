// SPDX-License-Identifier: Apache-2.0
// Vectors as directions and points.
#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

std::optional<Refusal> matrix_fits(std::span<const Type> types, std::span<const uint32_t>, Type) {
  const bool fits3 = types[0] != Type::vector4, fits4 = types[0] != Type::vector2;
  if (types[1] == Type::matrix33 ? fits3 : fits4) return std::nullopt;
  return Refusal{support::Id::type_mismatch, 1,
                 "a " + std::string(graph::type_name(types[0])) + " needs a matrix" + (fits3 ? "33" : "44") +
                     ", not a " + std::string(graph::type_name(types[1]))};
}

/// A vector with one component less than the matrix is a point: it is extended by 1.
void transform(Site& s) {
  const auto height = static_cast<uint32_t>(graph::float_count(s.types[0]));
  if (height == s.in[1].count) {
    s.out[0] = s.call("transform", {s.in[1], s.in[0]});
    return;
  }
  std::array<ir::ValueId, 4> components;
  for (uint32_t i = 0; i < height; ++i) components[i] = s.b.extract(s[0], i);
  components[height] = s.b.constant(1.0f);
  const std::span<ir::ValueId> tall = std::span(components).first(height + 1);
  const ir::ValueId result = s.call("transform", {s.in[1], s.b.construct(tall)}).id();
  for (uint32_t i = 0; i < height; ++i) components[i] = s.b.extract(result, i);
  s.out[0] = s.b.construct(tall.first(height));
}

}  // namespace

std::vector<Row> vector_rows() {
  const Port in1{"in1", Vector, "the first vector"};
  const Port in2{"in2", Vector, "the second vector"};
  const Port from{"fromspace", Choice, "the space of `in`", "world", space_names};
  const Port to{"tospace", Choice, "the space of the result; \"model\" is \"object\"", "world", space_names};
  return {
      {"dotproduct", "The dot product of `in1` and `in2`.", {in1, in2}, Float, Function{"dot"}},
      {"crossproduct",
       "The right-handed cross product of `in1` and `in2`.",
       {{"in1", Vector3, "the first vector"}, {"in2", Vector3, "the second vector"}},
       Vector3,
       Function{"cross"}},
      {"normalize",
       "`in`, scaled to length 1, without intermediate overflow for any length.",
       {{"in", Vector, "a vector that is not zero"}},
       Vector,
       Function{"normalize"}},
      {"magnitude", "The length of `in`.", {{"in", Vector, "the vector"}}, Float, Function{"length"}},
      {"distance", "The length of `in1` - `in2`.", {in1, in2}, Float, Function{"distance"}},
      {"reflect",
       "`in`, reflected at the plane with this normal: `in` - 2 (`normal` . `in`) `normal`.",
       {{"in", Vector, "a direction towards the surface"}, {"normal", Vector, "unit length"}},
       Vector,
       Function{"reflect"}},
      {"refract",
       "The unit direction `in`, refracted at a surface; zero for total internal reflection.",
       {{"in", Vector, "unit length, towards the surface"},
        {"normal", Vector, "unit length, opposite to `in`"},
        {"ior", Float, "the index of refraction on the incident side divided by that on the other side", 1.0f}},
       Vector,
       Function{"refract"}},
      {"transformpoint",
       "Transforms the point `in` to another space.",
       {{"in", Vector3, "a point in `fromspace`"}, from, to},
       Vector3,
       Transform::point},
      {"transformvector",
       "Transforms the vector `in` (direction and length) to another space.",
       {{"in", Vector3, "a vector in `fromspace`"}, from, to},
       Vector3,
       Transform::vector},
      {"transformnormal",
       "Transforms the normal `in` to another space and normalises it.",
       {{"in", Vector3, "a normal in `fromspace`, of any non-zero length"}, from, to},
       Vector3,
       Transform::normal},
      {"transformmatrix",
       "`mat` times `in`. A vector2 with a matrix33, and a vector3 with a matrix44, is a point.",
       {{"in", Vector, "the column vector"},
        {"mat", {matrix_types, Variable::u}, "the matrix; literals are in column-major order"}},
       {{"out", Vector}},
       transform,
       matrix_fits},
      {"transpose", "The transpose.", {{"in", Matrix, "the matrix"}}, Matrix, Function{"transpose"}},
      {"determinant", "The determinant.", {{"in", Matrix, "the matrix"}}, Float, Function{"determinant"}},
      {"invertmatrix",
       "The inverse; infinities and NaN for a singular matrix.",
       {{"in", Matrix, "the matrix"}},
       Matrix,
       Function{"inverse"}},
  };
}

}  // namespace isoshade::nodes
