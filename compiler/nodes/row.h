// SPDX-License-Identifier: Apache-2.0
// The node table's columns. A node of the language is one row: checking, lowering, the manual and the JSON
// schema all come from it.
#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "compiler/ir/op.h"
#include "compiler/nodes/image.h"
#include "compiler/nodes/type_set.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::nodes {

struct Site;

/// Attributes of the surface point that an effect shades.
enum class Surface : uint8_t {
  position,        ///< vec3
  normal,          ///< vec3, unit
  texcoord,        ///< vec2; has no space
  view_direction,  ///< vec3, unit, towards the viewer
  tangent,         ///< vec3, unit, along the texture's u
  bitangent,       ///< vec3, unit, up in the texture: against its v
  color,           ///< vec4, linear: what the mesh has, else 1; has no space
  outline_normal,  ///< vec3, unit: one for all vertices at a place
  pixel_size       ///< float, world units; has no space
};

/// Where coordinates count from.
enum class Space : uint8_t {
  world,
  object,
  view  ///< the eye at the origin, looking along -z, y up
};

/// What ports that ask for a space can be. MaterialX calls object space also "model".
inline const std::vector<std::string_view> space_names{"world", "object", "view", "model"};
constexpr Space space_of(uint32_t choice) { return choice == 3 ? Space::object : static_cast<Space>(choice); }

/// An attribute; vectors are given in a space.
struct SurfaceValue {
  Surface attribute;
  Space space = Space::world;

  constexpr size_t index() const { return 3 * static_cast<size_t>(attribute) + static_cast<size_t>(space); }
};
inline constexpr size_t surface_value_count = 3 * 9;  ///< of SurfaceValue::index

/// What a port has that is neither linked nor given: nothing (then it must be), a number in every component
/// (of a matrix: of the diagonal), a boolean (0 where another type is needed), three numbers, a text, or an
/// attribute of the surface (in a function document, which has none, it must be linked or given).
using Default =
    std::variant<std::monostate, float, bool, std::array<float, 3>, std::string_view, SurfaceValue>;

struct Port {
  std::string_view name;
  PortType type;
  std::string_view doc;
  Default value = {};
  std::vector<std::string_view> choices = {};  ///< of a PortType::Kind::choice

  bool required(bool in_function) const {
    return value.index() == 0 || (in_function && std::holds_alternative<SurfaceValue>(value));
  }
};

struct Output {
  std::string_view name;
  PortType type;
};

/// Most rows have the one output "out".
struct Outputs : std::vector<Output> {
  Outputs(PortType type) : vector{{"out", type}} {}
  Outputs(std::initializer_list<Output> outputs) : vector(outputs) {}
};

/// A row of functions.def; one that only takes floats is called for each component.
struct Function {
  std::string_view row;
};

/// What a light gives at the surface point.
enum class Light : uint8_t {
  direction,  ///< vec3, unit, world space, towards the light
  color       ///< vec3, linear, with all falloff
};

/// Sums its input over the lights.
struct SumLights {};

/// Takes its first port from the space of the second to that of the third.
enum class Transform : uint8_t { point, vector, normal };

/// Seconds since the scene began.
struct Time {};

/// What a value changes by from a pixel to the next: to the right, down, or the sum of both without signs.
enum class Derivative : uint8_t { x, y, width };

/// Makes the outputs of a Site from its inputs.
using Custom = void (*)(Site&);

using Lowering =
    std::variant<ir::Opcode, Function, Surface, Transform, Time, Light, SumLights, Derivative, Image, Custom>;

/// What a row demands of its ports beyond their types, and what is wrong there.
struct Refusal {
  support::Id id;
  size_t port;
  std::string message;
};
/// `types`: of each port, after inference; `settings`: of literal ports, as in Site; `out`: of output 0.
using Condition = std::optional<Refusal> (*)(std::span<const Type> types, std::span<const uint32_t> settings,
                                             Type out);

struct Row {
  std::string_view name;
  std::string_view doc;  ///< one or two sentences; `port` in back quotes
  std::vector<Port> ports;
  Outputs outputs;
  Lowering lowering;
  Condition condition = nullptr;
  std::string_view group = {};  ///< "math": the file it stands in

  template <class Kind>
  bool is() const {
    return std::holds_alternative<Kind>(lowering);
  }
  /// Whether it speaks of the surface, its pixels, textures, the scene or its lights: function documents have none of
  /// these.
  bool belongs_to_effects() const {
    return is<Surface>() || is<Transform>() || is<Time>() || is<Light>() || is<SumLights>() ||
           is<Derivative>() || is<Image>();
  }
};

}  // namespace isoshade::nodes
