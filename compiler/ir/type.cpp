// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/type.h"

#include <array>

namespace isoshade::ir {

namespace {
constexpr std::array<std::string_view, 5> float_names{"", "float", "vec2", "vec3", "vec4"};
}

std::string_view name(Type type) {
  switch (type.scalar) {
    case Scalar::boolean: return "bool";
    case Scalar::integer: return "int";
    case Scalar::floating: break;
  }
  return float_names[type.width];
}

std::optional<Type> type_from_name(std::string_view text) {
  if (text == "bool") return bool_type;
  if (text == "int") return int_type;
  for (int width = 1; width <= 4; ++width)
    if (text == float_names[width]) return vector_type(width);
  return std::nullopt;
}

}  // namespace isoshade::ir
