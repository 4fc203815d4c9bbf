// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace isoshade::ir {

enum class Scalar : uint8_t { boolean, integer, floating };

/// bool, int (32-bit, two's complement), float, or a vector of 2 to 4 floats. Nothing else exists:
/// matrices are their columns, colours are vectors.
struct Type {
  Scalar scalar = Scalar::floating;
  uint8_t width = 1;

  friend bool operator==(Type, Type) = default;
  bool is_float() const { return scalar == Scalar::floating; }
};

inline constexpr Type bool_type{Scalar::boolean, 1};
inline constexpr Type int_type{Scalar::integer, 1};
inline constexpr Type float_type{Scalar::floating, 1};
constexpr Type vector_type(int width) { return {Scalar::floating, static_cast<uint8_t>(width)}; }

std::string_view name(Type type);  ///< "bool" "int" "float" "vec2" "vec3" "vec4"
std::optional<Type> type_from_name(std::string_view name);

}  // namespace isoshade::ir
