// SPDX-License-Identifier: Apache-2.0
// The types that a port accepts, and the names that rows of the node table use for them.
#pragma once

#include <cstdint>

#include "compiler/graph/graph.h"

namespace isoshade::nodes {

using graph::Type;

struct TypeSet {
  uint16_t bits = 0;

  constexpr bool has(Type type) const { return (bits >> static_cast<int>(type) & 1) != 0; }
  friend constexpr TypeSet operator|(TypeSet a, TypeSet b) {
    return {static_cast<uint16_t>(a.bits | b.bits)};
  }
  friend constexpr bool operator==(TypeSet, TypeSet) = default;
};

constexpr TypeSet only(Type type) { return {static_cast<uint16_t>(1u << static_cast<int>(type))}; }

/// Type variables: the ports of a row with the same variable have the same type, which is inferred.
enum class Variable : uint8_t { none, t, u };

/// The type of a port or an output.
struct PortType {
  enum class Kind : uint8_t {
    value,      ///< a value of one of `accepts`
    type_name,  ///< a literal string: the name of the type of `variable`
    choice,     ///< a literal string: one of the port's choices
    component,  ///< a literal non-negative integer: a component index, or a number
    integer,    ///< a literal integer
    image       ///< a literal string: one of the document's images
  };
  TypeSet accepts;
  Variable variable = Variable::none;
  Kind kind = Kind::value;
};

inline constexpr TypeSet scalar_types = only(Type::floating);
inline constexpr TypeSet vector_types = only(Type::vector2) | only(Type::vector3) | only(Type::vector4);
inline constexpr TypeSet color_types = only(Type::color3) | only(Type::color4);
inline constexpr TypeSet matrix_types = only(Type::matrix33) | only(Type::matrix44);
inline constexpr TypeSet float_types = scalar_types | vector_types | color_types;
inline constexpr TypeSet value_types = float_types | matrix_types | only(Type::boolean) | only(Type::integer);

inline constexpr PortType Boolean{only(Type::boolean)};
inline constexpr PortType Integer{only(Type::integer)};
inline constexpr PortType Float{only(Type::floating)};
inline constexpr PortType Vector2{only(Type::vector2)};
inline constexpr PortType Vector3{only(Type::vector3)};
inline constexpr PortType Color3{only(Type::color3)};
inline constexpr PortType Color4{only(Type::color4)};
inline constexpr PortType AnyFloat{float_types, Variable::t};  ///< float, a vector or a colour
inline constexpr PortType Vector{vector_types, Variable::t};
inline constexpr PortType VectorOrColor{vector_types | color_types, Variable::t};
inline constexpr PortType Filename{only(Type::filename)};
inline constexpr PortType Color{color_types, Variable::t};
inline constexpr PortType Matrix{matrix_types, Variable::t};
inline constexpr PortType FloatOrMatrix{float_types | matrix_types, Variable::t};
inline constexpr PortType Any{value_types, Variable::t};
inline constexpr PortType Other{value_types, Variable::u};  ///< independent of Any
inline constexpr PortType Choice{{}, Variable::none, PortType::Kind::choice};
inline constexpr PortType WholeNumber{{}, Variable::none, PortType::Kind::component};

inline constexpr PortType SignedNumber{{}, Variable::none, PortType::Kind::integer};
inline constexpr PortType ImageName{{}, Variable::none, PortType::Kind::image};

/// A port that names the type of the same variable: "to": "color3".
constexpr PortType name_of(PortType type) { return {type.accepts, type.variable, PortType::Kind::type_name}; }
constexpr PortType component_of(PortType type) {
  return {type.accepts, type.variable, PortType::Kind::component};
}

}  // namespace isoshade::nodes
