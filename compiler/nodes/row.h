// SPDX-License-Identifier: Apache-2.0
// The columns of the node table. Each node of the language is one row; checking, lowering, the manual and the JSON
// schema derive from it.
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
#include "compiler/nodes/type_set.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::nodes {

struct Site;

using interface::Repetition;
using interface::Screen;
using interface::Space;
using interface::Surface;
using interface::SurfaceValue;

/// The choices of a port for a space. "model" is MaterialX's other name of object space.
inline const std::vector<std::string_view> space_names{"world", "object", "view", "model"};
constexpr Space space_of(uint32_t choice) { return choice == 3 ? Space::object : static_cast<Space>(choice); }

/// The default of a port: none (the port is required), a number for every component (for a matrix: for the diagonal), a
/// boolean (0 for other types), three numbers, a text, or a surface attribute (required in posts, which have no
/// surface).
using Default =
    std::variant<std::monostate, float, bool, std::array<float, 3>, std::string_view, SurfaceValue>;

struct Port {
  std::string_view name;
  PortType type;
  std::string_view doc;
  Default value = {};
  std::vector<std::string_view> choices = {};  ///< for PortType::Kind::choice
  /// Of a choice: a link to an integer input may take its place, whose values are called as the first of the choices.
  bool takes_input = false;

  /// `has_surface`: the document is an effect, or a function that effects may call.
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

/// Calls a row of functions.def, componentwise if the row has only floats.
struct Function {
  std::string_view row;
};

/// Samples a texture.
struct Image {};

/// The ports of the row `image`, in order.
namespace image_port {
inline constexpr size_t file = 0, default_value = 1, texcoord = 2, uaddressmode = 3, vaddressmode = 4,
                        filtertype = 5, colorspace = 6, layer = 7;
}  // namespace image_port

// The enumerations below have the order of the ports' choices.

/// Addressing outside of a texture; `constant` is the port `default`.
enum class AddressMode : uint8_t { periodic, clamp, mirror, constant };

/// The nearest texel; bilinear interpolation of four texels; the same, interpolated between the two mip levels whose
/// texels are nearest to the size of the pixel.
enum class Filter : uint8_t { closest, linear, trilinear };

/// The colour space of a file. `automatic`: sRGB if it has 8 bits per channel and is read as a colour, else linear.
enum class ColorSpace : uint8_t { automatic, srgb, linear };

/// Reads a property of the current light at the surface point.
enum class Light : uint8_t {
  direction,  ///< vec3, unit, world space, towards the light
  color       ///< vec3, linear, including all falloff
};

/// Reads the environment: the radiance at a roughness, or the irradiance divided by pi. The port `default` replaces it
/// where there is none.
enum class Environment : uint8_t { radiance, irradiance };

/// Sums its input over the lights.
struct SumLights {};

/// Reads an image of the post chain, the scene's depth, or what moved, at an offset from the pixel. In an effect: the color
/// or the depth of what is opaque.
enum class Fetch : uint8_t { color, depth, motion };

/// The ports of the rows `scenecolor`, `scenedepth` and `motion`.
namespace fetch_port {
inline constexpr size_t image = 0, filter = 4, nonfinite = 5;  ///< of scenecolor alone
constexpr size_t offset_x(Fetch what) { return what == Fetch::color ? 1 : 0; }
constexpr size_t offset_y(Fetch what) { return offset_x(what) + 1; }
constexpr size_t edge(Fetch what) { return offset_x(what) + 2; }
constexpr size_t shift(Fetch what) { return what == Fetch::color ? 6 : 3; }
}  // namespace fetch_port

/// The value outside of an image.
enum class Edge : uint8_t { clamp, mirror, constant };
inline const std::vector<std::string_view> edge_names{"clamp", "mirror", "constant"};

inline constexpr int64_t max_taps = 64;  ///< per sum_taps

/// The world-space position of the visible surface at the pixel.
struct WorldPosition {};

/// Sums its input over taps; the index of the current tap.
struct SumTaps {};
struct TapIndex {};

/// Transforms port 0 from the space of port 1 to the space of port 2.
enum class Transform : uint8_t { point, vector, normal };

/// The time of the scene, in seconds.
struct Time {};

/// The screen-space derivative in x (right), in y (down), or |x| + |y|.
enum class Derivative : uint8_t { x, y, width };

/// Computes the outputs of a Site from its inputs.
using Custom = void (*)(Site&);

using Lowering = std::variant<ir::Opcode, Function, Surface, Transform, Time, Repetition, Light, SumLights, Environment,
                              Derivative, Image, Screen, Fetch, WorldPosition, SumTaps, TapIndex, Custom>;

/// The kinds of documents in which a node is available. A function may use what is available in effects; then only
/// effects can call it, or for `drawn` nodes also posts (check/stage_needs.h).
enum class Availability : uint8_t {
  anywhere,
  drawn,  ///< effects and posts
  effects,
  posts,
  pictures  ///< where there is a picture to read: posts, and in effects the colour of passes that are blended
};

/// The error of a port that violates a row's Condition.
struct Refusal {
  support::Id id;
  size_t port;
  std::string message;
};
/// A constraint on ports beyond their types. `types`: of each port, after inference; `settings`: of literal ports, as
/// in Site; `out`: of output 0.
using Condition = std::optional<Refusal> (*)(std::span<const Type> types, std::span<const uint32_t> settings,
                                             Type out);

struct Row {
  std::string_view name;
  std::string_view doc;  ///< one or two sentences, with ports in back quotes
  std::vector<Port> ports;
  Outputs outputs;
  Lowering lowering;
  Condition condition = nullptr;
  std::string_view group = {};  ///< the file that defines it: "math"

  template <class Kind>
  bool is() const {
    return std::holds_alternative<Kind>(lowering);
  }
  /// Whether it evaluates its input repeatedly and sums the results.
  bool is_sum() const { return is<SumLights>() || is<SumTaps>(); }
  /// Whether its value depends on the iteration of the enclosing sum.
  bool is_summand() const { return is<Light>() || is<TapIndex>(); }
  Availability availability() const {
    if (is<Time>() || is<Environment>()) return Availability::drawn;
    if (is<Surface>() || is<Transform>() || is<Repetition>() || is<Light>() || is<SumLights>() || is<Derivative>() ||
        is<Image>())
      return Availability::effects;
    if (const auto* what = std::get_if<Fetch>(&lowering))
      return *what == Fetch::motion ? Availability::posts : Availability::pictures;
    const bool screen = is<Screen>() || is<WorldPosition>() || is<SumTaps>() || is<TapIndex>();
    return screen ? Availability::posts : Availability::anywhere;
  }
};

}  // namespace isoshade::nodes
