// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/animate.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "compiler/support/visible.h"
#include "runtime/scene/parse_parts.h"

namespace isoshade::scene {

using graph::Document;
using graph::Json;
using graph::Member;
using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

/// Why a key cannot move; empty if it can, or has parts that can. A type without an overload does not compile.
struct Immovable {
  std::string_view operator()(const format::Boolean&) const { return ""; }
  std::string_view operator()(const format::Number&) const { return ""; }
  template <size_t N>
  std::string_view operator()(const format::Numbers<N>&) const {
    return "";
  }
  std::string_view operator()(const format::Scale&) const { return ""; }
  std::string_view operator()(const format::Rotation&) const { return ""; }
  std::string_view operator()(const format::Literal&) const { return ""; }
  std::string_view operator()(const format::Literals&) const { return lists; }
  std::string_view operator()(const format::MapOfLiterals&) const { return ""; }
  std::string_view operator()(const format::ObjectOf& type) const {
    return type.object == format::Object::mesh ? "a mesh is made once: move its transform, or its vertices by the "
                                                 "\"position\" of a pass"
                                               : "";
  }
  std::string_view operator()(const format::MapOf&) const { return ""; }
  std::string_view operator()(const format::ListOf&) const { return ""; }
  std::string_view operator()(const format::Integer&) const { return sizes; }
  std::string_view operator()(const format::Size&) const { return sizes; }
  std::string_view operator()(const format::Samples&) const { return sizes; }
  std::string_view operator()(const format::Choice&) const { return words; }
  std::string_view operator()(const format::Name&) const { return words; }
  std::string_view operator()(const format::Path&) const { return words; }
  std::string_view operator()(const format::MapOfNames&) const { return words; }
  std::string_view operator()(const format::Keyframes&) const { return lists; }
  std::string_view operator()(const format::MapOfPaths&) const { return lists; }

  static constexpr std::string_view sizes = "sizes and counts are the same in all frames";
  static constexpr std::string_view words = "only numbers, lists of numbers and booleans move";
  static constexpr std::string_view lists = "a list of values has no one value that could move";
};

std::string_view reason_to_rest(const format::KeyRow& row) {
  if (row.object == format::Object::scene && row.name == format::scene::time.name)
    return "it is the time by which all else moves; `render --time` sets it";
  if (row.object == format::Object::scene && row.name == format::scene::frames_per_second.name)
    return "it tells how far the frame before is away";
  if (row.object == format::Object::post && row.name == format::post::size.name) return Immovable::sizes;
  return std::visit(Immovable{}, row.type);
}

/// How many numbers a value consists of: 0 is a boolean, 1 one that is no list.
struct Shape {
  bool boolean = false, list = false;
  size_t count = 1;
  bool operator==(const Shape&) const = default;
};

std::optional<Shape> shape_of(const Json& value) {
  if (value.kind == Json::Kind::boolean) return Shape{true, false, 1};
  if (value.kind == Json::Kind::number) return Shape{};
  const auto is_number = [](const Json& item) { return item.kind == Json::Kind::number; };
  if (value.kind != Json::Kind::array || value.items.empty() || !std::ranges::all_of(value.items, is_number))
    return std::nullopt;
  return Shape{false, true, value.items.size()};
}

std::string text_of(const Shape& shape) {
  if (shape.boolean) return "a boolean";
  return shape.list ? "a list of " + std::to_string(shape.count) + (shape.count == 1 ? " number" : " numbers") : "a number";
}

/// The shapes that a place takes; none if its effect decides that.
struct Shapes {
  std::vector<Shape> operator()(const format::Boolean&) const { return {{true, false, 1}}; }
  std::vector<Shape> operator()(const format::Number&) const { return {{}}; }
  template <size_t N>
  std::vector<Shape> operator()(const format::Numbers<N>&) const {
    return {{false, true, N}};
  }
  std::vector<Shape> operator()(const format::Scale&) const { return {{}, {false, true, 3}}; }
  std::vector<Shape> operator()(const format::Rotation&) const { return {{false, true, 3}, {false, true, 4}}; }
  template <class T>
  std::vector<Shape> operator()(const T&) const {
    return {};
  }
};

/// A place in the document that an animation writes to.
struct Place {
  Json* owner = nullptr;
  std::string_view key;
  std::vector<Shape> shapes;  ///< empty: any
  bool is_rotation = false;
};

class Finder {
 public:
  Finder(Document& document, const Member& animation, Diagnostics& diagnostics)
      : document_(document), animation_(animation), diagnostics_(diagnostics), rest_(animation.key) {}

  std::optional<Place> find() {
    if (rest_.ends_with('.')) return rests("its name ends with a dot");
    Json* owner = &document_.root;
    format::Object kind = format::Object::scene;
    while (true) {
      const std::string_view name = next();
      const auto rows = format::keys_of(kind);
      const auto found = std::ranges::find(rows, name, &format::KeyRow::name);
      if (found == rows.end()) {
        std::vector<std::string_view> names;
        for (const format::KeyRow* row : rows) names.push_back(row->name);
        return unknown(name, names);
      }
      const format::KeyRow& row = **found;
      if (const std::string_view reason = reason_to_rest(row); !reason.empty()) return rests(reason);
      const bool is_whole = rest_.empty();
      if (const auto* object = std::get_if<format::ObjectOf>(&row.type)) {
        if (is_whole) return rests("name one of its keys");
        kind = object->object;
        owner = part(owner, name);
      } else if (const auto* map = std::get_if<format::MapOf>(&row.type)) {
        kind = map->object;
        owner = is_whole ? nullptr : member(owner->find(name));
        if (owner == nullptr || rest_.empty()) return owner == nullptr && !is_whole ? std::nullopt : rests("name one of its keys");
      } else if (const auto* list = std::get_if<format::ListOf>(&row.type)) {
        kind = list->object;
        owner = is_whole ? nullptr : item(owner->find(name));
        if (owner == nullptr || rest_.empty()) return owner == nullptr && !is_whole ? std::nullopt : rests("name one of its keys");
      } else if (std::holds_alternative<format::MapOfLiterals>(row.type)) {
        if (is_whole) return rests("name one of the parameters");
        owner = part(owner, name);
        const std::string_view parameter = next();
        if (!rest_.empty()) return rests("a parameter has no parts");
        Place place{owner, parameter, {}, false};
        const Json* stated = owner->find(parameter);
        if (const auto shape = stated != nullptr ? shape_of(*stated) : std::nullopt) place.shapes = {*shape};
        return place;
      } else {
        if (!is_whole) return rests(quote(name) + " has no parts");
        return Place{owner, name, std::visit(Shapes{}, row.type), std::holds_alternative<format::Rotation>(row.type)};
      }
    }
  }

 private:
  std::string_view next() {
    const size_t dot = rest_.find('.');
    const std::string_view name = rest_.substr(0, dot);
    rest_.remove_prefix(dot == std::string_view::npos ? rest_.size() : dot + 1);
    return name;
  }

  std::nullopt_t unknown(std::string_view name, const std::vector<std::string_view>& names) {
    std::string list;
    for (const std::string_view known : names) list.append(list.empty() ? "" : ", ").append(known);
    support::Diagnostic& report = diagnostics_.report_unknown(
        Id::unknown_key, document_.key_span(animation_),
        quote(animation_.key) + " leads to nothing: there is no " + quote(name), name, names);
    if (report.fix.empty()) report.note(list.empty() ? "there is nothing of the kind" : "there are " + list);
    return std::nullopt;
  }

  std::nullopt_t rests(std::string_view reason) {
    diagnostics_.report(Id::unknown_key, document_.key_span(animation_), quote(animation_.key) + " cannot move")
        .note(std::string(reason));
    return std::nullopt;
  }

  /// The object under a key; added if it is missing. If it is no object, which parse_scene reports, one that is lost.
  Json* part(Json* owner, std::string_view key) {
    Json* found = owner->find(key);
    if (found != nullptr) return found->kind == Json::Kind::object ? found : &nothing_;
    Member made{std::string(key), animation_.key_begin, animation_.key_end, {}};
    made.value.kind = Json::Kind::object;
    made.value.source = animation_.value.source;
    made.value.begin = animation_.key_begin;
    made.value.end = animation_.key_end;
    owner->members.push_back(std::move(made));
    return &owner->members.back().value;
  }

  /// The object that the next name means among the members of a map.
  Json* member(Json* map) {
    const std::string_view name = next();
    Json* found = map != nullptr ? map->find(name) : nullptr;
    if (found != nullptr) return found->kind == Json::Kind::object ? found : &nothing_;
    std::vector<std::string_view> names;
    for (size_t i = 0; map != nullptr && i < map->members.size(); ++i) names.push_back(map->members[i].key);
    unknown(name, names);
    return nullptr;
  }

  /// The same of a list: by the "name" of an item, or its number.
  Json* item(Json* list) {
    const std::string_view name = next();
    std::vector<std::string> names;
    for (size_t i = 0; list != nullptr && i < list->items.size(); ++i) {
      Json& candidate = list->items[i];
      const Json* own = candidate.find(format::post::name.name);
      names.push_back(own != nullptr && own->kind == Json::Kind::string ? own->string : std::to_string(i));
      if (names.back() == name) return candidate.kind == Json::Kind::object ? &candidate : &nothing_;
    }
    unknown(name, {names.begin(), names.end()});
    return nullptr;
  }

  Document& document_;
  const Member& animation_;
  Diagnostics& diagnostics_;
  std::string_view rest_;
  Json nothing_;
};

struct Key {
  double time = 0;
  const Json* value = nullptr;
};

/// Checks and evaluates one animation.
class Animation {
 public:
  Animation(const Document& document, const Member& member, const Place& place, Diagnostics& diagnostics)
      : document_(document), member_(member), place_(place), diagnostics_(diagnostics) {}

  std::optional<Json> at(double time) {
    const ReadAnimation read = parse_animation(document_, member_, diagnostics_);
    if (read.keys == nullptr || !read_keys(*read.keys)) return std::nullopt;
    ease_ = read.ease;
    loop_ = read.loop;
    return value_at(looped(time));
  }

 private:
  bool read_keys(const Json& list) {
    if (list.items.empty()) {
      diagnostics_.report(Id::wrong_type, document_.span(list), "the animation of " + quote(member_.key) + " has no keys")
          .suggest("write [[0, value], [1, value]]");
      return false;
    }
    for (const Json& item : list.items)
      if (!read_key(item)) return false;
    return true;
  }

  bool read_key(const Json& item) {
    const std::string of = " of the animation of " + quote(member_.key);
    if (item.kind != Json::Kind::array || item.items.size() != 2 || item.items[0].kind != Json::Kind::number) {
      diagnostics_.report(Id::wrong_type, document_.span(item), "a key" + of + " must be a time and a value")
          .suggest("write [time, value], the time in seconds");
      return false;
    }
    const Key key{item.items[0].number, &item.items[1]};
    const support::Span time_where = document_.span(item.items[0]);
    if (!(key.time >= format::coordinates.low && key.time <= format::coordinates.high)) {
      diagnostics_.report(Id::out_of_range, time_where, "the time of a key" + of + " must be from -1e9 to 1e9");
      return false;
    }
    if (!keys_.empty() && !(key.time > keys_.back().time)) {
      diagnostics_.report(Id::out_of_range, time_where, "the times of the keys" + of + " must ascend")
          .note("this one is not after the one before it");
      return false;
    }
    const auto shape = shape_of(*key.value);
    if (!shape) {
      diagnostics_.report(Id::wrong_type, document_.span(*key.value),
                          "a value" + of + " must be a number, a list of numbers or a boolean");
      return false;
    }
    std::vector<Shape> wanted = place_.shapes;
    if (!keys_.empty()) wanted = {*shape_of(*keys_.front().value)};
    if (!wanted.empty() && std::ranges::find(wanted, *shape) == wanted.end()) {
      std::string text;
      for (const Shape& other : wanted) text += (text.empty() ? "" : " or ") + text_of(other);
      diagnostics_.report(Id::wrong_type, document_.span(*key.value), "a value" + of + " must be " + text + ", not " + text_of(*shape))
          .note(keys_.empty() ? "as the value that moves" : "as the first key");
      return false;
    }
    keys_.push_back(key);
    return true;
  }

  /// A time between those of the first and the last key, or one at which the value rests.
  double looped(double time) const {
    const double first = keys_.front().time, length = keys_.back().time - first;
    if (loop_ == Loop::once || !(length > 0)) return time;
    const double period = loop_ == Loop::ping_pong ? 2 * length : length;
    double since = std::fmod(time - first, period);
    if (since < 0) since += period;
    if (loop_ == Loop::ping_pong && since > length) since = period - since;
    return first + since;
  }

  Json value_at(double time) const {
    const auto after = std::ranges::upper_bound(keys_, time, {}, &Key::time);
    if (after == keys_.begin()) return *after->value;
    const Key& from = *(after - 1);
    const bool rests = after == keys_.end() || from.time == time || ease_ == Ease::step;
    if (rests || from.value->kind == Json::Kind::boolean) return *from.value;
    double part = (time - from.time) / (after->time - from.time);
    if (ease_ == Ease::smooth) part = part * part * (3 - 2 * part);
    Json mixed = *from.value;
    if (mixed.kind == Json::Kind::number) {
      mix(mixed, *after->value, part, 1);
      return mixed;
    }
    const bool is_quaternion = place_.is_rotation && mixed.items.size() == 4;
    double cosine = 0;
    for (size_t i = 0; is_quaternion && i < 4; ++i) cosine += mixed.items[i].number * after->value->items[i].number;
    for (size_t i = 0; i < mixed.items.size(); ++i) mix(mixed.items[i], after->value->items[i], part, cosine < 0 ? -1 : 1);
    if (is_quaternion) normalize(mixed);
    return mixed;
  }

  /// `sign`: q and -q are one rotation; the shorter way leads to the nearer of them.
  static void mix(Json& from, const Json& to, double part, double sign) {
    from.number = from.number * (1 - part) + sign * to.number * part;
    from.computed = true;
    from.integral = false;
  }

  static void normalize(Json& quaternion) {
    double square = 0;
    for (const Json& item : quaternion.items) square += item.number * item.number;
    if (!(square > 0)) return;
    for (Json& item : quaternion.items) item.number /= std::sqrt(square);
  }

  const Document& document_;
  const Member& member_;
  const Place& place_;
  Diagnostics& diagnostics_;
  Ease ease_ = Ease::linear;
  Loop loop_ = Loop::once;
  std::vector<Key> keys_;
};

}  // namespace

ReadAnimation parse_animation(const Document& document, const Member& member, Diagnostics& diagnostics) {
  namespace key = format::animation;
  ReadAnimation read;
  format::Reader<format::Object::animation> reader(document, member.value, "the animation of " + quote(member.key),
                                                   diagnostics);
  read.keys = reader.read(key::keys);
  read.ease = static_cast<Ease>(reader.read(key::ease));
  read.loop = static_cast<Loop>(reader.read(key::loop));
  if (!reader.finish()) read.keys = nullptr;
  return read;
}

std::vector<AnimatedParameter> animated_parameters(const Document& document) {
  std::vector<AnimatedParameter> found;
  const Json* animations = document.root.find(format::scene::animate.name);
  if (animations == nullptr || animations->kind != Json::Kind::object) return found;
  for (const Member& member : animations->members) {
    // objects.NAME.parameters.PARAMETER, and so posts
    std::vector<std::string> path(1);
    for (const char c : member.key)
      if (c == '.')
        path.emplace_back();
      else
        path.back() += c;
    const bool has_owner = path[0] == format::scene::objects.name || path[0] == format::scene::posts.name;
    if (path.size() == 4 && has_owner && path[2] == format::object::parameters.name) found.push_back({path[1], path[3]});
  }
  return found;
}

bool animate(Document& document, double time, Diagnostics& diagnostics) {
  const Json* found = document.root.find(format::scene::animate.name);
  if (found == nullptr) return true;
  if (found->kind != Json::Kind::object) {
    diagnostics.report(Id::wrong_type, document.span(*found),
                       "\"animate\" of a scene must be an object, not " + std::string(kind_name(found->kind)));
    return false;
  }
  const Json animations = *found;  // what is written below may move the members of the scene
  const size_t errors_before = diagnostics.error_count();
  for (const Member& member : animations.members) {
    if (diagnostics.full()) return false;
    Finder finder(document, member, diagnostics);
    const std::optional<Place> place = finder.find();
    if (!place) continue;
    std::optional<Json> value = Animation(document, member, *place, diagnostics).at(time);
    if (!value) continue;
    if (Json* old = place->owner->find(place->key)) {
      *old = *std::move(value);
    } else {
      place->owner->members.push_back({std::string(place->key), member.key_begin, member.key_end, *std::move(value)});
    }
  }
  return diagnostics.error_count() == errors_before;
}

}  // namespace isoshade::scene
