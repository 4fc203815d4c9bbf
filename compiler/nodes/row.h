// SPDX-License-Identifier: Apache-2.0
// The node table's columns. A node of the language is one row: checking, lowering, the manual and the JSON
// schema all come from it.
#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "compiler/ir/op.h"
#include "compiler/nodes/type_set.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::nodes {

struct Site;

/// What a port has that is neither linked nor given: nothing (then it must be), a float in every component,
/// or a text.
using Default = std::variant<std::monostate, float, std::string_view>;

struct Port {
  std::string_view name;
  PortType type;
  std::string_view doc;
  Default value = {};
  std::vector<std::string_view> choices = {};  ///< of a PortType::Kind::choice

  bool required() const { return value.index() == 0; }
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

/// Attributes of the surface point that an effect shades.
enum class Surface : uint8_t {
  position,       ///< vec3, world space
  normal,         ///< vec3, unit, world space
  texcoord,       ///< vec2
  view_direction  ///< vec3, unit, world space, towards the viewer
};
inline constexpr int surface_count = 4;

/// What a light gives at the surface point.
enum class Light : uint8_t {
  direction,  ///< vec3, unit, world space, towards the light
  color       ///< vec3, linear, with all falloff
};

/// Sums its input over the lights.
struct SumLights {};

/// Makes the outputs of a Site from its inputs.
using Custom = void (*)(Site&);

using Lowering = std::variant<ir::Opcode, Function, Surface, Light, SumLights, Custom>;

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
};

}  // namespace isoshade::nodes
