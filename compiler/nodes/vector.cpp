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
                 "a " + std::string(graph::type_name(types[0])) + " is transformed by a matrix" +
                     (fits3 ? "33" : "44") + ", not by a " + std::string(graph::type_name(types[1]))};
}

/// A vector that is one shorter than the matrix is a point: it gets a fourth or third component of 1.
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
      {"dotproduct", "The sum of products of components.", {in1, in2}, Float, Function{"dot"}},
      {"crossproduct",
       "The vector at right angles to both, right-handed.",
       {{"in1", Vector3, "the first vector"}, {"in2", Vector3, "the second vector"}},
       Vector3,
       Function{"cross"}},
      {"normalize",
       "`in` at length 1; whatever its length, nothing overflows on the way.",
       {{"in", Vector, "a vector that is not zero"}},
       Vector,
       Function{"normalize"}},
      {"magnitude", "The length of `in`.", {{"in", Vector, "the vector"}}, Float, Function{"length"}},
      {"distance", "The length of `in1` - `in2`.", {in1, in2}, Float, Function{"distance"}},
      {"reflect",
       "`in` mirrored at the plane with this normal: `in` - 2 (`normal` . `in`) `normal`.",
       {{"in", Vector, "a direction towards the surface"}, {"normal", Vector, "unit length"}},
       Vector,
       Function{"reflect"}},
      {"refract",
       "The unit direction `in` bent at a surface; zero where it is totally reflected.",
       {{"in", Vector, "unit length, towards the surface"},
        {"normal", Vector, "unit length, against `in`"},
        {"ior", Float, "index of refraction before the surface over that behind it", 1.0f}},
       Vector,
       Function{"refract"}},
      {"transformpoint",
       "The point `in` in the coordinates of another space.",
       {{"in", Vector3, "a point in `fromspace`"}, from, to},
       Vector3,
       Transform::point},
      {"transformvector",
       "The direction and length `in` in the coordinates of another space.",
       {{"in", Vector3, "a vector in `fromspace`"}, from, to},
       Vector3,
       Transform::vector},
      {"transformnormal",
       "The normal `in` in another space, at length 1.",
       {{"in", Vector3, "a normal in `fromspace`, of any length but 0"}, from, to},
       Vector3,
       Transform::normal},
      {"transformmatrix",
       "`mat` times `in`. A vector2 under a matrix33 and a vector3 under a matrix44 are points.",
       {{"in", Vector, "the vector, a column"},
        {"mat", {matrix_types, Variable::u}, "the matrix; literals are written column by column"}},
       {{"out", Vector}},
       transform,
       matrix_fits},
      {"transpose", "Rows become columns.", {{"in", Matrix, "the matrix"}}, Matrix, Function{"transpose"}},
      {"determinant", "The determinant.", {{"in", Matrix, "the matrix"}}, Float, Function{"determinant"}},
      {"invertmatrix",
       "The inverse; infinities and NaN where there is none.",
       {{"in", Matrix, "the matrix"}},
       Matrix,
       Function{"inverse"}},
  };
}

}  // namespace isoshade::nodes
