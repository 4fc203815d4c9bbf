// SPDX-License-Identifier: Apache-2.0
// Names of the same operation as a node, in expressions, and in GLSL, HLSL or MaterialX; for suggestions.
#include <algorithm>
#include <array>

#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

/// Names of one operation; names in our tables come first.
using Names = std::array<std::string_view, 4>;
constexpr Names synonyms[] = {
    {"absval", "abs", "fabs"},
    {"modulo", "mod", "fmod"},
    {"power", "pow"},
    {"ln", "log"},
    {"fract", "frac"},
    {"ceil", "ceiling"},
    {"mix", "lerp"},
    {"saturate", "clamp01"},
    {"atan2", "atan"},
    {"dotproduct", "dot"},
    {"crossproduct", "cross"},
    {"magnitude", "length"},
    {"transformmatrix", "transform", "mul"},
    {"invertmatrix", "inverse"},
    {"rgbtohsv", "rgb_to_hsv"},
    {"hsvtorgb", "hsv_to_rgb"},
    {"combine2", "vector2", "vec2", "float2"},
    {"combine3", "vector3", "vec3", "float3"},
    {"combine4", "vector4", "vec4", "float4"},
    {"ifgreater", "if", "compare"},
    {"vertexcolor", "geomcolor"},
    {"ddx", "dFdx"},
    {"ddy", "dFdy"},
};

}  // namespace

std::string_view find_synonym(std::string_view word, const std::vector<Row>& rows) {
  if (word.empty()) return {};
  for (const Names& names : synonyms) {
    if (std::ranges::find(names, word) == names.end()) continue;
    for (const std::string_view name : names)
      if (!name.empty() && std::ranges::find(rows, name, &Row::name) != rows.end()) return name;
    for (const std::string_view name : names)
      if (graph::find_type(name)) return name;  // type constructors of expressions
  }
  return {};
}

}  // namespace isoshade::nodes
