// SPDX-License-Identifier: Apache-2.0
// The parser of scene documents: a reader for the objects of format.def, and the parts of parse_scene.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "runtime/scene/format.h"

namespace isoshade::scene::format {

/// What Reader does for types that graph::ObjectReader does not know.
class ObjectReader : protected graph::ObjectReader {
 protected:
  ObjectReader(const graph::Document& document, const graph::Json& json, std::string what,
               support::Diagnostics& diagnostics)
      : graph::ObjectReader(document, json, what, diagnostics),
        document_(document),
        json_(json),
        what_(std::move(what)),
        diagnostics_(diagnostics) {}

  std::array<int, 2> read_size(std::string_view key, const Size& type);
  std::array<float, 3> read_scale(std::string_view key, const Scale& type);
  std::array<float, 4> read_rotation(std::string_view key, const Rotation& type, bool& is_quaternion);

  const graph::Document& document_;
  const graph::Json& json_;
  std::string what_;
  support::Diagnostics& diagnostics_;
};

/// Reads the keys of an object of the format; those of other objects do not compile. As graph::ObjectReader, it reports
/// every fault, returns the default then, and reports in finish() the keys that nobody has read.
template <Object which>
class Reader : private ObjectReader {
 public:
  Reader(const graph::Document& document, const graph::Json& json, std::string what,
         support::Diagnostics& diagnostics)
      : ObjectReader(document, json, std::move(what), diagnostics) {}

  using graph::ObjectReader::finish;

  template <class T>
  using KeyOf = Key<which, T>;

  /// `fallback`: of a key whose default depends on another key.
  bool read(const KeyOf<Boolean>& key, std::optional<bool> fallback = {}) {
    return boolean(key.name, fallback ? fallback : key.type.fallback);
  }
  int64_t read(const KeyOf<Integer>& key) { return integer(key.name, key.type.range, key.type.fallback); }
  /// 0 without the key, if that is optional and has no default.
  float read(const KeyOf<Number>& key) {
    if (!key.required && !key.type.fallback) return optional_number(key.name, key.type.range).value_or(0.0f);
    return number(key.name, key.type.range, key.type.fallback);
  }
  template <size_t N>
  std::array<float, N> read(const KeyOf<Numbers<N>>& key) {
    return numbers<N>(key.name, key.type.range, key.type.fallback);
  }
  std::array<int, 2> read(const KeyOf<Size>& key) { return read_size(key.name, key.type); }
  /// Any integer: the caller reports those that are not among the values.
  int64_t read(const KeyOf<Samples>& key) { return integer(key.name, coordinates, key.type.fallback); }
  std::array<float, 3> read(const KeyOf<Scale>& key) { return read_scale(key.name, key.type); }
  /// 3 angles and a 0, or a quaternion of any length.
  std::array<float, 4> read(const KeyOf<Rotation>& key, bool& is_quaternion) {
    return read_rotation(key.name, key.type, is_quaternion);
  }
  size_t read(const KeyOf<Choice>& key) {
    return choice(key.name, {key.type.words.begin(), key.type.words.end()}, key.type.fallback);
  }
  std::string read(const KeyOf<Name>& key) { return string(key.name); }
  std::string read(const KeyOf<Path>& key) { return path(key.name); }

  // Values that have parsers of their own: null without the key, or if it is of another kind.
  const graph::Json* read(const KeyOf<Literal>& key) { return value(key.name, need(key)); }
  const graph::Json* read(const KeyOf<Literals>& key) { return array(key.name, need(key)); }
  const graph::Json* read(const KeyOf<MapOfLiterals>& key) { return object(key.name, need(key)); }
  const graph::Json* read(const KeyOf<MapOfNames>& key) { return object(key.name, need(key)); }
  const graph::Json* read(const KeyOf<Keyframes>& key) { return array(key.name, need(key)); }
  const graph::Json* read(const KeyOf<MapOfPaths>& key) { return object(key.name, need(key)); }
  const graph::Json* read(const KeyOf<MapOf>& key) { return object(key.name, need(key)); }
  const graph::Json* read(const KeyOf<ListOf>& key) { return array(key.name, need(key)); }
  const graph::Json* read(const KeyOf<ObjectOf>& key) {
    const bool any_kind = !row_of(key.type.object).shorthand.empty();
    return any_kind ? value(key.name, need(key)) : object(key.name, need(key));
  }

  /// Allows a key that somebody else has read.
  template <class T>
  void skip(const KeyOf<T>& key) {
    ignore(key.name);
  }
  /// Allows the keys of every document.
  void skip_document_keys() {
    for (const std::string_view key : {"$schema", "isoshade", "doc"}) ignore(key);
  }
  template <class T>
  bool has(const KeyOf<T>& key) const {
    return json_.find(key.name) != nullptr;
  }
  /// The value of a key, or nowhere.
  template <class T>
  support::Span where(const KeyOf<T>& key) const {
    const graph::Json* found = json_.find(key.name);
    return found != nullptr ? document_.span(*found) : support::Span{};
  }
  template <class T>
  void report_wrong(const KeyOf<T>& key, const graph::Json& json, std::string_view expected) {
    graph::ObjectReader::report_wrong(key.name, json, expected);
  }

 private:
  template <class T>
  static Need need(const KeyOf<T>& key) {
    return key.required ? Need::required : Need::optional;
  }
};

}  // namespace isoshade::scene::format

namespace isoshade::scene {

// The parts of parse_scene. Each reports what is wrong and returns what it could read.

Camera parse_camera(const graph::Document& document, const graph::Json& json,
                    support::Diagnostics& diagnostics);
Light parse_light(const graph::Document& document, const graph::Member& member,
                  support::Diagnostics& diagnostics);
Environment parse_environment(const graph::Document& document, const graph::Json& json,
                              support::Diagnostics& diagnostics);
Object parse_object(const graph::Document& document, const graph::Member& member,
                    support::Diagnostics& diagnostics);
/// `before`: the posts that stand before it.
Post parse_post(const graph::Document& document, const graph::Json& json, const std::vector<Post>& before,
                support::Diagnostics& diagnostics);
std::vector<Parameter> parse_parameters(const graph::Document& document, const graph::Json& json,
                                        support::Diagnostics& diagnostics);
/// A string ("sphere") or an object ({"type": "sphere", "radius": 2}).
MeshShape parse_mesh(const graph::Document& document, const graph::Json& json,
                     support::Diagnostics& diagnostics);
/// How a value moves, before its keys are looked at.
struct ReadAnimation {
  const graph::Json* keys = nullptr;  ///< null after an error
  Ease ease = Ease::linear;
  Loop loop = Loop::once;
};
ReadAnimation parse_animation(const graph::Document& document, const graph::Member& member,
                              support::Diagnostics& diagnostics);
inline glm::vec3 to_vec3(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }

}  // namespace isoshade::scene
