// SPDX-License-Identifier: Apache-2.0
// Objects: mesh, transform, effect, parameters, grids.
#include <algorithm>
#include <cmath>

#include "compiler/support/visible.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/parse_parts.h"

namespace isoshade::scene {

using graph::Document;
using graph::Json;
using graph::Literal;
using graph::Member;
using graph::ObjectReader;
using graph::Range;
using support::Diagnostics;
using support::Id;
using support::quote;
using Need = ObjectReader::Need;

namespace {

constexpr Range degrees{-max_degrees, max_degrees};

glm::vec3 parse_scale(const Document& document, ObjectReader& reader, const std::string& what,
                      Diagnostics& diagnostics) {
  constexpr Range range{-1e6, 1e6};
  const Json* json = reader.value("scale", Need::optional);
  const size_t errors_before = diagnostics.error_count();
  glm::vec3 scale(1);
  if (json == nullptr) return scale;
  if (json->kind == Json::Kind::number) {
    scale = glm::vec3(reader.number("scale", range));
  } else if (json->kind == Json::Kind::array) {
    scale = to_vec3(reader.numbers<3>("scale", range, {{1, 1, 1}}));
  } else {
    reader.report_wrong("scale", *json, "a number or an array of 3 numbers");
  }
  if (diagnostics.error_count() != errors_before) return glm::vec3(1);
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(scale[axis]) >= 1e-6f) continue;
    diagnostics.report(Id::degenerate, document.span(*json), "\"scale\" of " + what + " is zero or nearly so")
        .note("a flattened object has no normals; use a plane");
    return glm::vec3(1);
  }
  return scale;
}

Transform parse_transform(const Document& document, const Json& json, const std::string& object,
                          Diagnostics& diagnostics) {
  Transform transform;
  const std::string what = "the transform of " + object;
  ObjectReader reader(document, json, what, diagnostics);
  transform.translate = to_vec3(reader.numbers<3>("translate", coordinates, {{0, 0, 0}}));
  transform.scale = parse_scale(document, reader, what, diagnostics);
  const Json* rotate = reader.value("rotate", Need::optional);
  if (rotate != nullptr && rotate->kind == Json::Kind::array && rotate->items.size() == 4) {
    const std::array<float, 4> q = reader.numbers<4>("rotate", {-1, 1});
    const double square =
        double{q[0]} * q[0] + double{q[1]} * q[1] + double{q[2]} * q[2] + double{q[3]} * q[3];
    if (std::abs(square - 1) < 1e-3) {
      transform.rotation = q;
    } else {
      diagnostics.report(Id::out_of_range, document.span(*rotate),
                         "\"rotate\" of " + what + " has 4 numbers, but they are no quaternion of length 1");
    }
  } else if (rotate != nullptr) {
    transform.rotate = to_vec3(reader.numbers<3>("rotate", degrees, {{0, 0, 0}}));
  }
  reader.finish();
  return transform;
}

size_t number_count(const Literal& literal) {
  if (literal.kind == Literal::Kind::number) return 1;
  return literal.kind == Literal::Kind::numbers ? literal.numbers.size() : 0;
}

/// {"from": a, "to": b} or {"values": [...]}, with one value for each place.
std::optional<Variation> parse_variation(const Document& document, const Member& member, int64_t count,
                                         Diagnostics& diagnostics) {
  Variation variation{member.key, {}, false, document.key_span(member), document.span(member.value)};
  ObjectReader reader(document, member.value, "the variation of " + quote(member.key), diagnostics);
  const Json* values = reader.array("values", Need::optional);
  variation.listed = values != nullptr;
  if (values != nullptr) {
    if (static_cast<int64_t>(values->items.size()) != count) {
      diagnostics.report(Id::wrong_type, document.span(*values),
                         "\"values\" of " + quote(member.key) + " needs one value for each of " +
                             std::to_string(count) + " places, not " + std::to_string(values->items.size()));
    }
    for (const Json& item : values->items) {
      if (const auto literal = graph::parse_literal(document, item, member.key, diagnostics))
        variation.values.push_back(*literal);
    }
  } else {
    for (const std::string_view key : {"from", "to"}) {
      const Json* json = reader.value(key);
      const auto literal = json ? graph::parse_literal(document, *json, key, diagnostics) : std::nullopt;
      if (!literal) continue;
      if (number_count(*literal) == 0) reader.report_wrong(key, *json, "a number or an array of numbers");
      variation.values.push_back(*literal);
    }
    if (variation.values.size() == 2 &&
        number_count(variation.values[0]) != number_count(variation.values[1])) {
      diagnostics.report(Id::wrong_type, document.span(member.value),
                         "\"from\" and \"to\" of " + quote(member.key) + " differ in size");
    }
  }
  if (!reader.finish()) return std::nullopt;
  return variation;
}

Repeat parse_repeat(const Document& document, const Json& json, const std::string& object,
                    Diagnostics& diagnostics) {
  Repeat repeat;
  ObjectReader reader(document, json, "an axis of the grid of " + object, diagnostics);
  repeat.count = reader.integer("count", {1, static_cast<double>(max_instances)});
  repeat.step = to_vec3(reader.numbers<3>("step", coordinates));
  if (const Json* variations = reader.object("parameters", Need::optional)) {
    for (const Member& member : variations->members) {
      auto variation = parse_variation(document, member, std::max<int64_t>(repeat.count, 1), diagnostics);
      if (variation) repeat.variations.push_back(*std::move(variation));
    }
  }
  reader.finish();
  return repeat;
}

/// A parameter has its value from one place.
void check_parameter_names(const Object& object, Diagnostics& diagnostics) {
  std::vector<std::pair<std::string_view, support::Span>> names;
  for (const Parameter& parameter : object.parameters)
    names.emplace_back(parameter.name, parameter.name_where);
  for (const Repeat& repeat : object.repeat)
    for (const Variation& variation : repeat.variations)
      names.emplace_back(variation.name, variation.name_where);
  std::stable_sort(names.begin(), names.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (size_t i = 1; i < names.size(); ++i) {
    if (names[i].first != names[i - 1].first) continue;
    diagnostics
        .report(Id::duplicate_name, names[i].second,
                "the parameter " + quote(names[i].first) + " is set twice for one object")
        .note(names[i - 1].second, "also here");
  }
}

}  // namespace

std::vector<Parameter> parse_parameters(const Document& document, const Json& json,
                                        Diagnostics& diagnostics) {
  std::vector<Parameter> parameters;
  for (const Member& member : json.members) {
    const std::optional<Literal> literal =
        graph::parse_literal(document, member.value, member.key, diagnostics);
    if (!literal) continue;
    parameters.push_back({member.key, *literal, document.key_span(member), document.span(member.value)});
  }
  return parameters;
}

Object parse_object(const Document& document, const Member& member, Diagnostics& diagnostics) {
  Object object;
  object.name = member.key;
  object.name_where = document.key_span(member);
  const std::string what = "object " + quote(member.key);
  ObjectReader reader(document, member.value, what, diagnostics);
  if (const Json* mesh = reader.value("mesh")) {
    object.mesh = parse_mesh(document, *mesh, diagnostics);
    object.mesh_where = document.span(*mesh);
  }
  object.effect = reader.path("effect");
  if (const Json* effect = reader.value("effect", Need::optional))
    object.effect_where = document.span(*effect);
  if (const Json* transform = reader.object("transform", Need::optional))
    object.transform = parse_transform(document, *transform, what, diagnostics);
  if (const Json* parameters = reader.object("parameters", Need::optional))
    object.parameters = parse_parameters(document, *parameters, diagnostics);
  if (const Json* repeat = reader.array("repeat", Need::optional)) {
    if (repeat->items.size() > 3) {
      diagnostics.report(Id::out_of_range, document.span(*repeat),
                         "the grid of " + what + " has more than 3 axes");
    } else {
      for (const Json& axis : repeat->items)
        object.repeat.push_back(parse_repeat(document, axis, what, diagnostics));
    }
  }
  if (reader.finish()) check_parameter_names(object, diagnostics);
  return object;
}

}  // namespace isoshade::scene
