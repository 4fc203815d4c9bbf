// SPDX-License-Identifier: Apache-2.0
// What is called one thing as a node, another in expressions and a third in GLSL, HLSL or MaterialX, for messages.
#include <algorithm>
#include <array>

#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

/// Names of one thing, the ones that stand in tables first.
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

std::string_view called_elsewhere(std::string_view word, const std::vector<Row>& rows) {
  if (word.empty()) return {};
  for (const Names& names : synonyms) {
    if (std::ranges::find(names, word) == names.end()) continue;
    for (const std::string_view name : names)
      if (!name.empty() && std::ranges::find(rows, name, &Row::name) != rows.end()) return name;
    for (const std::string_view name : names)
      if (graph::find_type(name)) return name;  // expressions call types
  }
  return {};
}

}  // namespace isoshade::nodes
