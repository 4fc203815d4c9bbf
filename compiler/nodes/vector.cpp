// SPDX-License-Identifier: Apache-2.0
// Vectors as directions and points.
#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

/// A matrix takes vectors as tall as it is.
std::optional<Refusal> matrix_fits(std::span<const Type> types, std::span<const uint32_t>, Type) {
  const Type needed = types[0] == Type::vector3 ? Type::matrix33 : Type::matrix44;
  if (types[1] == needed) return std::nullopt;
  return Refusal{support::Id::type_mismatch, 1,
                 "a " + std::string(graph::type_name(types[0])) + " is transformed by a " +
                     std::string(graph::type_name(needed)) + ", not by a " +
                     std::string(graph::type_name(types[1]))};
}

}  // namespace

std::vector<Row> vector_rows() {
  const Port in1{"in1", Vector, "the first vector"};
  const Port in2{"in2", Vector, "the second vector"};
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
      {"transformmatrix",
       "`mat` times `in`. A vector3 takes a matrix33, a vector4 a matrix44.",
       {{"in", {only(Type::vector3) | only(Type::vector4), Variable::t}, "the vector, a column"},
        {"mat", {matrix_types, Variable::u}, "the matrix; literals are written column by column"}},
       {{"out", {only(Type::vector3) | only(Type::vector4), Variable::t}}},
       [](Site& s) {
         s.out[0] = s.call("transform", {s.in[1], s.in[0]});
       },
       matrix_fits},
  };
}

}  // namespace isoshade::nodes
