// SPDX-License-Identifier: Apache-2.0
// The interface between a document's function and the kernel around it: what each parameter of the function is, and which
// functions the kernel provides. Lowering makes one Interface a module; kernels, the prover, tests and reflection read it.
// Nothing is recognised by its name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "compiler/interface/pass_state.h"
#include "compiler/ir/module.h"

namespace isoshade::interface {

/// What is assumed of each component of a value; graphs/README.md tells users.
struct Assumption {
  double lo = 0, hi = 0;
  bool unit = false;  ///< a vector of length 1
  /// If not 0: a quotient by a sum that begins with this value lies from 0 to this.
  double quotient = 0;
};

inline constexpr int max_size = 8192;  ///< of each side of an image or a texture, in pixels; the runtime refuses more
inline constexpr int max_lights = 1024;  ///< of a scene; the runtime refuses more

namespace assume {
inline constexpr double limit = 1e6;  ///< of what has no limit of its own
inline constexpr Assumption anywhere{-limit, limit}, direction{-1, 1, true}, distance{0, limit}, fraction{0, 1},
    color{0, 1e3}, texture_coordinate{-1e4, 1e4}, ray{-1e3, 1e3}, image_place{0, max_size}, image_size{1, max_size},
    light_count{0, max_lights}, texture{-1, limit}, boolean{0, 1}, pass_index{0, max_repeats - 1}, pass_count{1, max_repeats};
/// The distance of a depth of 0 is 1 / 0, which becomes the largest distance that there is.
inline constexpr Assumption depth_divisor{-limit, limit, false, 1e9};
}  // namespace assume

enum class Surface : uint8_t {
#define SURFACE(name, node, width, spaces, stages, assumed, sets, doc) name,
#include "compiler/interface/values.def"
};
/// Values for posts.
enum class Screen : uint8_t {
#define SCREEN(name, group, parameter, width, assumed, doc) name,
#include "compiler/interface/values.def"
};
enum class SpaceMatrix : uint8_t {
#define MATRIX(name) name,
#include "compiler/interface/values.def"
};

#define SURFACE(name, node, width, spaces, stages, assumed, sets, doc) +1
inline constexpr size_t surface_count = 0
#include "compiler/interface/values.def"
    ;
#define SCREEN(name, group, parameter, width, assumed, doc) +1
inline constexpr size_t screen_value_count = 0
#include "compiler/interface/values.def"
    ;
#define MATRIX(name) +1
inline constexpr size_t space_matrix_count = 0
#include "compiler/interface/values.def"
    ;

/// What a program knows about the repetitions of its pass: the number of the one that is drawn, from 0, and how many there are.
enum class Repetition : uint8_t { index, count };
inline constexpr size_t repetition_count = 2;

/// What coordinates are relative to.
enum class Space : uint8_t {
  world,
  object,
  view  ///< the eye at the origin, looking along -z, y up
};
inline constexpr size_t space_count = 3;

/// An attribute in a space.
struct SurfaceValue {
  Surface attribute;
  Space space = Space::world;

  constexpr size_t index() const {
    return space_count * static_cast<size_t>(attribute) + static_cast<size_t>(space);
  }
};
inline constexpr size_t surface_value_count = space_count * surface_count;  ///< of SurfaceValue::index

enum class SurfaceStages : uint8_t { all, vertices, pixels };

struct SurfaceRow {
  std::string_view name, node;
  int width;  ///< 0 of a boolean
  bool has_spaces;
  SurfaceStages stages;
  Assumption assumed;
  std::string_view sets;  ///< what the node's port "index" counts; empty: it has no such port
  std::string_view doc;

  ir::Type type() const { return width == 0 ? ir::bool_type : ir::vector_type(width); }
};
const SurfaceRow& row(Surface attribute);
/// How many sets of an attribute meshes have: the rows of values.def with its node, from the attribute on.
uint32_t sets_of(Surface attribute);
/// "normal_object"; world space has no suffix.
std::string name(SurfaceValue value);
/// Every value that a document may ask for, in order.
const std::vector<SurfaceValue>& surface_values();

struct ScreenRow {
  std::string_view group, parameter;
  int width;
  Assumption assumed;
  std::string_view doc;
};
const ScreenRow& row(Screen value);

enum class Axis : uint8_t { x, y };

/// An image that a post reads, by its record in `layer_records` (lower/frame_layout.h).
using ImageNumber = uint32_t;

/// The first records of layer_records: the image that is made; of a post, the depth of the picture, the image that the post
/// goes over, and those that its document lists; of a view, the depth and the color of each target that it reads.
namespace image_record {
inline constexpr int made = 0, depth = 1, color = 2;
}  // namespace image_record

/// What a parameter is: one of these.
namespace source {
struct Attribute {
  SurfaceValue value;
};
struct MatrixColumn {
  SpaceMatrix matrix;
  uint32_t column;
};
struct Time {};
struct PassRepetition {
  Repetition what;
};
/// An input of a function document, or a parameter of an effect or post; of a matrix, one column.
struct Input {
  uint32_t input;  ///< in Graph::inputs
  uint32_t column;
};
/// The number of a texture, negative for none.
struct Image {
  uint32_t slot;  ///< in ImageSlots::slots
};
struct LightCount {};
/// Where the lights of an object are listed; only in kernels, see LowerOptions.
struct FirstLight {};
/// Whether there is an environment.
struct HasEnvironment {};
struct ScreenValue {
  Screen value;
};
/// The column or row of an image's pixel that lies under the centre of the pixel that is made.
struct PixelOfImage {
  ImageNumber image;
  Axis axis;
};
/// The position of the centre inside that pixel: a vec2, 0 to 1.
struct OffsetInPixel {
  ImageNumber image;
};
struct SizeOfImage {
  ImageNumber image;
  Axis axis;
};
/// How many taps a node sums.
struct TapCount {
  uint32_t node;  ///< in Graph::nodes
};
}  // namespace source

using Source =
    std::variant<source::Attribute, source::MatrixColumn, source::Time, source::PassRepetition, source::Input, source::Image,
                 source::LightCount, source::FirstLight, source::HasEnvironment, source::ScreenValue, source::PixelOfImage, source::OffsetInPixel,
                 source::SizeOfImage, source::TapCount>;

/// Functions for std::visit, one an alternative: what forgets one does not compile.
template <class... Case>
struct Cases : Case... {
  using Case::operator()...;
};
template <class... Case>
Cases(Case...) -> Cases<Case...>;

struct Binding {
  Source source;
  ir::Parameter parameter;
  Assumption assumed;
  int element = -1;  ///< of a matrix's column: the number of its first element in the matrix
};

// Bindings whose parameter follows from what they are.
Binding bind(SurfaceValue value);
Binding bind(SpaceMatrix matrix, uint32_t column);
Binding bind(Screen value);
Binding bind_time();
/// `assumed`: of the pass; in a function, which any pass may call, assume::pass_index or pass_count.
Binding bind_repetition(Repetition what, Assumption assumed);
Binding bind_light_count();
Binding bind_first_light();
Binding bind_has_environment();
/// `slot_name`: ImageSlot::name.
Binding bind_image(uint32_t slot, std::string slot_name);
/// `prefix`: what names of the image begin with.
Binding bind_pixel(ImageNumber image, const std::string& prefix, Axis axis);
Binding bind_offset(ImageNumber image, const std::string& prefix);
Binding bind_size(ImageNumber image, const std::string& prefix, Axis axis);
/// `count`: as many as the document asks for.
Binding bind_taps(uint32_t node, std::string node_name, int count);

/// A function that a document calls and the kernel around it answers: without a body until the kernel gives it one, but
/// for samplers, whose bodies call `texel_at`.
enum class Host : uint8_t {
  light,         ///< light_at(index, position) -> (direction, color)
  light_change,  ///< light_at_change(index, position, position_change) -> the change of both; passes::derivatives asks
  environment,   ///< environment_at(direction, roughness) -> radiance
  irradiance,    ///< irradiance_at(direction) -> irradiance / pi
  texel,         ///< texel_at(picture, x, y) -> texel
  texture_size,  ///< texture_size(picture) -> (width, height, smaller)
  texture_layer, ///< texture_layer(picture, layer) -> picture
  image,         ///< NAME_at(x, y) -> color: of an image of a post
  depth,         ///< depth_at(x, y) -> depth
  mip_level,     ///< sample_level(picture, along_x, along_y) -> level, in 1/65536
  sample_closest,
  sample_linear,
  sample_trilinear
};

struct HostFunction {
  Host host{};
  uint32_t function = 0;        ///< in the module
  ImageNumber image = ir::none;  ///< of Host::image and Host::depth
};

struct Interface {
  uint32_t entry = 0;              ///< the document's function in the module
  std::vector<Binding> bindings;   ///< of its parameters, in order
  std::vector<HostFunction> host;  ///< in the order of the module

  const HostFunction* find(uint32_t function) const;
  /// The function, or ir::none.
  uint32_t find(Host host, ImageNumber image = ir::none) const;
};

/// Where the words of a document's record begin in `objects`: of each input (a matrix column by column; -1 for what has no
/// words), each image slot, and each sum over taps.
struct RecordLayout {
  int previous = -1;  ///< the columns that lead from object to world space at the frame before, as object_word::model
  std::vector<int> inputs, images;
  std::vector<std::pair<uint32_t, int>> taps;  ///< node, word
};

namespace names {
#define KERNEL_FUNCTION(name) inline constexpr const char* name = #name;
#include "compiler/interface/kernel_functions.def"
/// What the names of samplers begin with.
inline constexpr const char* sample_prefix = "sample_";
}  // namespace names

/// Whether no function of a document may have the name.
bool is_kernel_function(std::string_view name);

}  // namespace isoshade::interface
