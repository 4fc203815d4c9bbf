// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "compiler/support/visible.h"
#include "runtime/scene/parse_parts.h"

namespace isoshade::scene {

using graph::Document;
using graph::Json;
using support::Diagnostics;
using support::Id;
using support::quote;
using MeshReader = format::Reader<format::Object::mesh>;
namespace key = format::mesh;

namespace {

/// [radius, height], or {"at": [radius, height], "smooth": false}.
ProfilePoint parse_point(const Document& document, const Json& json, bool smooth, Diagnostics& diagnostics) {
  ProfilePoint point{0, 0, smooth};
  std::array<float, 2> at{};
  if (json.kind == Json::Kind::object) {
    format::Reader<format::Object::profile_point> reader(document, json, "profile", diagnostics);
    at = reader.read(format::profile_point::at);
    point.smooth = reader.read(format::profile_point::smooth, smooth);
    if (!reader.finish()) return point;
  } else {
    const auto literal = graph::parse_literal(document, json, "profile", diagnostics);
    if (!literal) return point;
    if (literal->numbers.size() != 2) {
      diagnostics.report(Id::wrong_type, document.span(json),
                         "a point of a profile is [radius, height], or {\"at\": [radius, height], "
                         "\"smooth\": false}");
      return point;
    }
    at = {literal->numbers[0], literal->numbers[1]};
  }
  point.radius = at[0] == 0 ? 0.0f : at[0];
  point.height = at[1];
  const bool in_range =
      point.radius == 0 || (point.radius >= format::smallest_size && point.radius <= format::largest_size);
  if (!in_range || !(std::abs(point.height) <= format::largest_size)) {
    diagnostics.report(Id::out_of_range, document.span(json),
                       "the radius is 0 or from 1e-6 to 1e6, and the height from -1e6 to 1e6");
  }
  return point;
}

void check_profile(const Document& document, const Json& json, const std::vector<ProfilePoint>& profile,
                   Diagnostics& diagnostics) {
  for (size_t i = 0; i < profile.size(); ++i) {
    const support::Span where = document.span(json.items[i]);
    if (i > 0 && i + 1 < profile.size() && profile[i].radius == 0) {
      diagnostics.report(Id::degenerate, where, "a profile meets the axis only at its ends");
      return;
    }
    if (i == 0) continue;
    const ProfilePoint &a = profile[i - 1], &b = profile[i];
    if (std::max(std::abs(a.radius - b.radius), std::abs(a.height - b.height)) < format::smallest_size) {
      diagnostics.report(Id::degenerate, where, "two points of a profile coincide or nearly so");
      return;
    }
    if (a.radius == 0 && b.radius == 0) {
      diagnostics.report(Id::degenerate, where, "a profile along the axis has no surface");
      return;
    }
  }
}

std::vector<ProfilePoint> parse_profile(const Document& document, MeshReader& reader,
                                        Diagnostics& diagnostics) {
  const bool smooth = reader.read(key::smooth);
  const Json* json = reader.read(key::profile);
  std::vector<ProfilePoint> profile;
  if (json == nullptr) return profile;
  const auto& [object, least, most] = key::profile.type;
  if (json->items.size() < least || json->items.size() > most) {
    diagnostics.report(Id::out_of_range, document.span(*json),
                       "a profile has " + std::to_string(least) + " to " + std::to_string(most) + " points");
    return profile;
  }
  const size_t errors = diagnostics.error_count();
  for (const Json& item : json->items) profile.push_back(parse_point(document, item, smooth, diagnostics));
  if (diagnostics.error_count() == errors) check_profile(document, *json, profile, diagnostics);
  return profile;
}

/// Otherwise the hole closes. A little less than the radius, so that its triangles have an area.
void check_tube(const MeshShape& torus, const support::Span& where, Diagnostics& diagnostics) {
  if (torus.size.y <= 0.999f * torus.size.x) return;
  diagnostics.report(Id::out_of_range, where,
                     "the \"tube\" of a torus is thinner than 0.999 of its \"radius\"");
}

/// The number of a mesh that is given by its name alone; reports one that does not exist, or needs more than its name.
std::optional<size_t> find_mesh(const std::string& name, const support::Span& where,
                                Diagnostics& diagnostics) {
  const auto& names = format::mesh_names;
  const auto number = static_cast<size_t>(std::ranges::find(names, name) - names.begin());
  if (number == names.size()) {
    std::string list;
    for (const std::string_view known : names) list.append(list.empty() ? "" : ", ").append(known);
    diagnostics
        .report_unknown(Id::out_of_range, where, "no mesh is called " + quote(name), name,
                        {names.begin(), names.end()})
        .note("there are " + list);
    return std::nullopt;
  }
  if (number == static_cast<size_t>(MeshKind::lathe)) {
    diagnostics.report(
        Id::wrong_type, where,
        "a lathe needs a profile: {\"type\": \"lathe\", \"profile\": [[radius, height], ...]}");
    return std::nullopt;
  }
  if (number >= static_cast<size_t>(MeshKind::file)) {
    const MeshFormat& format = mesh_formats[number - static_cast<size_t>(MeshKind::file)];
    diagnostics.report(Id::wrong_type, where,
                       "a " + std::string(format.title) + " is a file: {\"type\": \"" +
                           std::string(format.name) + "\", \"file\": \"model" +
                           std::string(format.extensions.back()) + "\"}");
    return std::nullopt;
  }
  return number;
}

int count(int64_t number) { return static_cast<int>(number); }

/// The keys of the mesh with this number in format::mesh_names.
MeshShape read_shape(const Document& document, size_t number, MeshReader& reader, const support::Span& where,
                     Diagnostics& diagnostics) {
  MeshShape shape;
  shape.kind = static_cast<MeshKind>(std::min(number, static_cast<size_t>(MeshKind::file)));
  shape.rings = shape.segments = 1;
  switch (shape.kind) {
    case MeshKind::sphere:
      shape.size = glm::vec3(reader.read(key::radius));
      shape.segments = count(reader.read(key::segments));
      shape.rings = count(reader.read(key::sphere_rings));
      break;
    case MeshKind::plane: {
      const auto size = reader.read(key::plane_size);
      shape.size = {size[0], 0, size[1]};
      shape.segments = count(reader.read(key::plane_segments));
      break;
    }
    case MeshKind::box: shape.size = to_vec3(reader.read(key::box_size)); break;
    case MeshKind::icosphere:
      shape.size = glm::vec3(reader.read(key::radius));
      shape.rings = count(reader.read(key::subdivisions));
      break;
    case MeshKind::cylinder:
    case MeshKind::cone:
      shape.size.x = reader.read(key::radius);
      shape.size.y = reader.read(key::height);
      shape.segments = count(reader.read(key::segments));
      shape.rings = count(reader.read(key::side_rings));
      shape.caps = reader.read(key::caps);
      break;
    case MeshKind::torus:
      shape.size.x = reader.read(key::radius);
      shape.size.y = reader.read(key::tube);
      shape.segments = count(reader.read(key::segments));
      shape.rings = count(reader.read(key::tube_rings));
      check_tube(shape, where, diagnostics);
      break;
    case MeshKind::lathe:
      shape.profile = parse_profile(document, reader, diagnostics);
      shape.segments = count(reader.read(key::segments));
      break;
    case MeshKind::file:
      shape.file = reader.read(key::file);
      shape.format = number - static_cast<size_t>(MeshKind::file);
      shape.fit = reader.read(key::fit);
      break;
  }
  return shape;
}

}  // namespace

MeshShape parse_mesh(const Document& document, const Json& json, Diagnostics& diagnostics) {
  const support::Span where = document.span(json);
  if (json.kind == Json::Kind::string) {
    const auto number = find_mesh(json.string, where, diagnostics);
    Json no_keys;
    no_keys.kind = Json::Kind::object;
    MeshReader reader(document, no_keys, "a mesh", diagnostics);
    return number ? read_shape(document, *number, reader, where, diagnostics) : MeshShape{};
  }
  MeshReader reader(document, json, "a mesh", diagnostics);
  const size_t number = reader.read(key::type);
  const MeshShape shape = read_shape(document, number, reader, where, diagnostics);
  reader.finish();
  return shape;
}

}  // namespace isoshade::scene
