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

#include "compiler/interface/binding.h"
#include "compiler/ir/op.h"
#include "compiler/nodes/image.h"
#include "compiler/nodes/type_set.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::nodes {

struct Site;

using interface::Screen;
using interface::Space;
using interface::Surface;
using interface::SurfaceValue;

/// What ports that ask for a space can be. MaterialX calls object space also "model".
inline const std::vector<std::string_view> space_names{"world", "object", "view", "model"};
constexpr Space space_of(uint32_t choice) { return choice == 3 ? Space::object : static_cast<Space>(choice); }

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

  /// `has_surface`: in an effect.
  bool required(bool has_surface) const {
    return value.index() == 0 || (!has_surface && std::holds_alternative<SurfaceValue>(value));
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

/// Reads an image of the post chain, or the scene's depth, near the pixel.
enum class Fetch : uint8_t { color, depth };

/// What is read beyond an image.
enum class Edge : uint8_t { clamp, mirror, constant };
inline const std::vector<std::string_view> edge_names{"clamp", "mirror", "constant"};

inline constexpr int64_t max_taps = 64;  ///< of a sum

/// The point that the pixel shows.
struct WorldPosition {};

/// Sums its input over taps, and the number of the tap below such a sum.
struct SumTaps {};
struct TapIndex {};

/// Takes its first port from the space of the second to that of the third.
enum class Transform : uint8_t { point, vector, normal };

/// Seconds since the scene began.
struct Time {};

/// What a value changes by from a pixel to the next: to the right, down, or the sum of both without signs.
enum class Derivative : uint8_t { x, y, width };

/// Makes the outputs of a Site from its inputs.
using Custom = void (*)(Site&);

using Lowering = std::variant<ir::Opcode, Function, Surface, Transform, Time, Light, SumLights, Derivative,
                              Image, Screen, Fetch, WorldPosition, SumTaps, TapIndex, Custom>;

/// Which documents a node has a meaning in.
enum class Home : uint8_t { anywhere, drawn /**< effects and posts */, effects, posts };

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
  /// Whether it computes its input again and again, and adds up.
  bool is_sum() const { return is<SumLights>() || is<SumTaps>(); }
  /// Whether it differs from one turn of a sum to the next.
  bool is_summand() const { return is<Light>() || is<TapIndex>(); }
  /// Nodes that speak of the surface, textures, the scene or the screen have no meaning in function documents.
  Home home() const {
    if (is<Time>()) return Home::drawn;
    if (is<Surface>() || is<Transform>() || is<Light>() || is<SumLights>() || is<Derivative>() || is<Image>())
      return Home::effects;
    const bool screen = is<Screen>() || is<Fetch>() || is<WorldPosition>() || is<SumTaps>() || is<TapIndex>();
    return screen ? Home::posts : Home::anywhere;
  }
};

}  // namespace isoshade::nodes
