// SPDX-License-Identifier: Apache-2.0
// The format of scene documents as data: format.def with its types.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "compiler/graph/reader.h"
#include "compiler/nodes/schema.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/mesh_formats.h"
#include "runtime/scene/scene.h"

namespace isoshade::scene::format {

using graph::Range;

// Coordinates and lengths that keep every matrix of a frame finite, products included.
inline constexpr Range coordinates{-1e9, 1e9};
inline constexpr Range lengths{1e-6, 1e9};
inline constexpr Range brightness{0, 1e6};
/// Sizes of meshes.
inline constexpr float smallest_size = 1e-6f, largest_size = 1e6f;
inline constexpr Range sizes{1e-6, 1e6};
inline constexpr size_t no_limit = std::numeric_limits<size_t>::max();

enum class Object : uint8_t {
#define OBJECT(name, forms, shorthand, doc) name,
#include "runtime/scene/format.def"
};

/// How the values of a parameter are given along an axis.
enum class VariationForm : uint8_t { list, steps };
inline constexpr std::string_view variation_forms[] = {"list", "steps"};

/// Where the light of an environment comes from.
enum class EnvironmentForm : uint8_t { file, sky };
inline constexpr std::string_view environment_forms[] = {"file", "sky"};

/// A set of forms of an object, by their numbers.
using Forms = uint16_t;
inline constexpr Forms every = 0xffff;
template <class... Kind>
constexpr Forms of(Kind... kinds) {
  return static_cast<Forms>(((1u << static_cast<unsigned>(kinds)) | ...));
}

/// The names of all meshes: of those made by rule, in the order of MeshKind, then of the formats of files.
inline constexpr auto mesh_names = [] {
  constexpr size_t ruled = std::size(ruled_mesh_names);
  std::array<std::string_view, ruled + std::size(mesh_formats)> names{};
  for (size_t i = 0; i < ruled; ++i) names[i] = ruled_mesh_names[i];
  for (size_t i = 0; i < std::size(mesh_formats); ++i) names[ruled + i] = mesh_formats[i].name;
  return names;
}();
inline constexpr Forms mesh_files = static_cast<Forms>(0xffffu << static_cast<unsigned>(MeshKind::file));
static_assert(mesh_names.size() <= 16);

// The types of values. A fallback is the value where an optional key is left out.
struct Boolean {
  std::optional<bool> fallback = {};  ///< without one it depends on another key
};
struct Integer {
  Range range;
  std::optional<int64_t> fallback = {};
};
struct Number {
  Range range;
  std::optional<float> fallback = {};
};
template <size_t N>
struct Numbers {
  Range range;
  std::optional<std::array<float, N>> fallback = {};
};
struct Size {  ///< of the image
  Range range;
  std::array<int, 2> fallback;
};
struct Samples {
  std::array<int, 3> values;
  int fallback;
};
struct Scale {  ///< one number, or one for each axis
  Range range;
};
struct Rotation {  ///< 3 angles, or 4 numbers of a quaternion
  Range range;     ///< of the angles
};
struct Choice {
  std::span<const std::string_view> words;
  std::optional<size_t> fallback = {};
};
struct Name {};
struct Path {};
struct Literal {};  ///< of any type that a parameter may have
struct Literals {};
struct MapOfLiterals {};
struct MapOfNames {};
struct Keyframes {};  ///< times and values: [[0, 1], [2, 5]]
struct MapOfPaths {   ///< by paths to values of the scene
  Object object;
};
struct ObjectOf {
  Object object;
};
struct MapOf {
  Object object;
  size_t most;
};
struct ListOf {
  Object object;
  size_t least, most;
};
using Type =
    std::variant<Boolean, Integer, Number, Numbers<2>, Numbers<3>, Numbers<4>, Size, Samples, Scale, Rotation,
                 Choice, Name, Path, Literal, Literals, MapOfLiterals, MapOfNames, Keyframes, MapOfPaths, ObjectOf,
                 MapOf, ListOf>;

inline constexpr bool required = true, optional = false;

/// A key of an object: Reader<object> alone reads it.
template <Object object, class T>
struct Key {
  std::string_view name;
  bool required;
  T type;
  Forms forms;
};
template <Object object, class T>
constexpr Key<object, T> make_key(std::string_view name, bool required, T type, Forms forms) {
  return {name, required, type, forms};
}

// format::camera::fov, ...
#define KEY(object, identifier, key, need, type, forms, doc)                           \
  namespace object {                                                                   \
  inline constexpr auto identifier = make_key<Object::object>(key, need, type, forms); \
  }
#include "runtime/scene/format.def"

/// The rows of format.def.
struct KeyRow {
  Object object;
  std::string_view name;
  bool required;
  Type type;
  Forms forms;
  std::string_view doc;
};
struct ObjectRow {
  Object object;
  std::string_view name;
  std::span<const std::string_view> forms;  ///< their names; empty: there is only one
  std::string_view shorthand;
  std::string_view doc;
};
std::span<const ObjectRow> objects();
const ObjectRow& row_of(Object object);
/// The keys of an object, or of one of its forms.
std::vector<const KeyRow*> keys_of(Object object, Forms forms = every);
/// The keys of a scene that settings change as they are ("size=..."): those with plain values.
std::vector<std::string_view> plain_keys_of_scene();
/// The keys of a scene whose own keys settings change ("camera.fov=..."): those with an object.
std::vector<std::string_view> object_keys_of_scene();

/// The JSON Schema of scene documents.
nodes::DocumentSchema schema();
/// The tables of graphs/README.md, one for each object.
std::string markdown();

}  // namespace isoshade::scene::format
