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
using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

/// A scale without zeros, or 1 after a report.
glm::vec3 check_scale(const std::array<float, 3>& scale, const std::string& what, const support::Span& where,
                      Diagnostics& diagnostics) {
  const bool flat = std::ranges::any_of(scale, [](float factor) { return !(std::abs(factor) >= 1e-6f); });
  if (!flat) return to_vec3(scale);
  diagnostics.report(Id::degenerate, where, "\"scale\" of " + what + " is zero or nearly so")
      .note("a flattened object has no normals; use a plane");
  return glm::vec3(1);
}

Transform parse_transform(const Document& document, const Json& json, const std::string& object,
                          Diagnostics& diagnostics) {
  namespace key = format::transform;
  Transform transform;
  const std::string what = "the transform of " + object;
  format::Reader<format::Object::transform> reader(document, json, what, diagnostics);
  transform.translate = to_vec3(reader.read(key::translate));
  transform.scale = check_scale(reader.read(key::scale), what, reader.where(key::scale), diagnostics);
  bool is_quaternion = false;
  const std::array<float, 4> r = reader.read(key::rotate, is_quaternion);
  const double square = double{r[0]} * r[0] + double{r[1]} * r[1] + double{r[2]} * r[2] + double{r[3]} * r[3];
  if (!is_quaternion) {
    transform.rotate = {r[0], r[1], r[2]};
  } else if (std::abs(square - 1) < 1e-3) {
    transform.rotation = r;
  } else {
    diagnostics.report(Id::out_of_range, reader.where(key::rotate),
                       "\"rotate\" of " + what + " has 4 numbers, which are not a quaternion of length 1");
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
  namespace key = format::variation;
  format::Reader<format::Object::variation> reader(document, member.value,
                                                   "the variation of " + quote(member.key), diagnostics);
  variation.listed = reader.has(key::values);
  if (variation.listed) {
    const Json* values = reader.read(key::values);
    if (values != nullptr && static_cast<int64_t>(values->items.size()) != count) {
      diagnostics.report(Id::wrong_type, document.span(*values),
                         "\"values\" of " + quote(member.key) + " needs one value for each of " +
                             std::to_string(count) + " places, not " + std::to_string(values->items.size()));
    }
    for (size_t i = 0; values != nullptr && i < values->items.size(); ++i) {
      if (const auto literal = graph::parse_literal(document, values->items[i], member.key, diagnostics))
        variation.values.push_back(*literal);
    }
  } else {
    for (const auto* end : {&key::from, &key::to}) {
      const Json* json = reader.read(*end);
      const auto literal =
          json ? graph::parse_literal(document, *json, end->name, diagnostics) : std::nullopt;
      if (!literal) continue;
      if (number_count(*literal) == 0) reader.report_wrong(*end, *json, "a number or an array of numbers");
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
  namespace key = format::repeat;
  format::Reader<format::Object::repeat> reader(document, json, "an axis of the grid of " + object,
                                                diagnostics);
  repeat.count = reader.read(key::count);
  repeat.step = to_vec3(reader.read(key::step));
  if (const Json* variations = reader.read(key::parameters)) {
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
  namespace key = format::object;
  format::Reader<format::Object::object> reader(document, member.value, what, diagnostics);
  if (const Json* mesh = reader.read(key::mesh)) object.mesh = parse_mesh(document, *mesh, diagnostics);
  object.mesh_where = reader.where(key::mesh);
  object.effect = reader.read(key::effect);
  object.effect_where = reader.where(key::effect);
  if (const Json* transform = reader.read(key::transform))
    object.transform = parse_transform(document, *transform, what, diagnostics);
  if (const Json* parameters = reader.read(key::parameters))
    object.parameters = parse_parameters(document, *parameters, diagnostics);
  object.casts_shadow = reader.read(key::casts_shadow);
  object.receives_shadow = reader.read(key::receives_shadow);
  if (const Json* repeat = reader.read(key::repeat)) {
    if (repeat->items.size() > key::repeat.type.most) {
      diagnostics.report(
          Id::out_of_range, document.span(*repeat),
          "the grid of " + what + " has more than " + std::to_string(key::repeat.type.most) + " axes");
    } else {
      for (const Json& axis : repeat->items)
        object.repeat.push_back(parse_repeat(document, axis, what, diagnostics));
    }
  }
  if (reader.finish()) check_parameter_names(object, diagnostics);
  return object;
}

}  // namespace isoshade::scene
