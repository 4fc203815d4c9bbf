// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "compiler/support/visible.h"
#include "runtime/scene/parse_parts.h"

namespace isoshade::scene {

using graph::Document;
using graph::Json;
using graph::ObjectReader;
using graph::Range;
using support::Diagnostics;
using support::Id;
using support::quote;
using Need = ObjectReader::Need;

namespace {

constexpr float least_size = 1e-6f;
constexpr float most_size = 1e6f;
constexpr Range sizes{least_size, most_size};

/// The order of MeshKind.
const std::vector<std::string_view> kinds = {"sphere", "plane", "box",   "icosphere", "cylinder",
                                             "cone",   "torus", "lathe", "gltf"};

MeshShape default_shape(MeshKind kind) {
  switch (kind) {
    case MeshKind::plane: return {kind, {1, 0, 1}, 1, 1};
    case MeshKind::icosphere: return {kind, {1, 1, 1}, 1, 4};
    case MeshKind::cylinder:
    case MeshKind::cone: return {kind, {1, 2, 1}, 64, 1};
    case MeshKind::torus: return {kind, {1, 0.25f, 1}, 64, 32};
    default: return {kind, {1, 1, 1}, 64, 32};
  }
}

/// [radius, height], or {"at": [radius, height], "smooth": false}.
ProfilePoint parse_point(const Document& document, const Json& json, bool smooth, Diagnostics& diagnostics) {
  ProfilePoint point{0, 0, smooth};
  std::array<float, 2> at{};
  if (json.kind == Json::Kind::object) {
    ObjectReader reader(document, json, "profile", diagnostics);
    at = reader.numbers<2>("at", {-most_size, most_size});
    point.smooth = reader.boolean("smooth", smooth);
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
  const bool in_range = point.radius == 0 || (point.radius >= least_size && point.radius <= most_size);
  if (!in_range || !(std::abs(point.height) <= most_size)) {
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
    if (std::max(std::abs(a.radius - b.radius), std::abs(a.height - b.height)) < least_size) {
      diagnostics.report(Id::degenerate, where, "two points of a profile coincide or nearly so");
      return;
    }
    if (a.radius == 0 && b.radius == 0) {
      diagnostics.report(Id::degenerate, where, "a profile along the axis has no surface");
      return;
    }
  }
}

std::vector<ProfilePoint> parse_profile(const Document& document, ObjectReader& reader,
                                        Diagnostics& diagnostics) {
  const bool smooth = reader.boolean("smooth", true);
  const Json* json = reader.array("profile");
  std::vector<ProfilePoint> profile;
  if (json == nullptr) return profile;
  if (json->items.size() < 2 || json->items.size() > max_profile_points) {
    diagnostics.report(Id::out_of_range, document.span(*json),
                       "a profile has 2 to " + std::to_string(max_profile_points) + " points");
    return profile;
  }
  const size_t errors = diagnostics.error_count();
  for (const Json& item : json->items) profile.push_back(parse_point(document, item, smooth, diagnostics));
  if (diagnostics.error_count() == errors) check_profile(document, *json, profile, diagnostics);
  return profile;
}

void read_radius_and_height(ObjectReader& reader, MeshShape& shape) {
  shape.size.x = reader.number("radius", sizes, shape.size.x);
  shape.size.y = reader.number("height", sizes, shape.size.y);
}

void read_count(ObjectReader& reader, std::string_view key, Range range, int& count) {
  count = static_cast<int>(reader.integer(key, range, count));
}

void read_torus(const Document& document, const Json& json, ObjectReader& reader, MeshShape& shape,
                Diagnostics& diagnostics) {
  shape.size.x = reader.number("radius", sizes, shape.size.x);
  shape.size.y = reader.number("tube", sizes, shape.size.y);
  // Else the hole closes; a little more, so that its triangles have an area.
  if (shape.size.y <= 0.999f * shape.size.x) return;
  diagnostics.report(Id::out_of_range, document.span(json),
                     "the \"tube\" of a torus is thinner than 0.999 of its \"radius\"");
}

}  // namespace

MeshShape parse_mesh(const Document& document, const Json& json, Diagnostics& diagnostics) {
  constexpr Range around{3, max_segments}, along{1, max_segments};
  if (json.kind == Json::Kind::string) {
    const auto found = std::find(kinds.begin(), kinds.end(), json.string);
    if (found == kinds.end()) {
      std::string list;
      for (const std::string_view kind : kinds) list.append(list.empty() ? "" : ", ").append(kind);
      diagnostics
          .report_unknown(Id::out_of_range, document.span(json), "no mesh is called " + quote(json.string),
                          json.string, kinds)
          .note("there are " + list);
      return {};
    }
    const auto kind = static_cast<MeshKind>(found - kinds.begin());
    if (kind == MeshKind::lathe) {
      diagnostics.report(
          Id::wrong_type, document.span(json),
          "a lathe needs a profile: {\"type\": \"lathe\", \"profile\": [[radius, height], ...]}");
    }
    if (kind == MeshKind::gltf) {
      diagnostics.report(Id::wrong_type, document.span(json),
                         "a glTF is a file: {\"type\": \"gltf\", \"file\": \"model.glb\"}");
    }
    return default_shape(kind);
  }
  ObjectReader reader(document, json, "a mesh", diagnostics);
  MeshShape shape = default_shape(static_cast<MeshKind>(reader.choice("type", kinds)));
  switch (shape.kind) {
    case MeshKind::sphere:
      shape.size = glm::vec3(reader.number("radius", sizes, 1.0f));
      read_count(reader, "segments", around, shape.segments);
      read_count(reader, "rings", {2, max_segments}, shape.rings);
      break;
    case MeshKind::plane: {
      const auto size = reader.numbers<2>("size", sizes, {{1, 1}});
      shape.size = {size[0], 0, size[1]};
      read_count(reader, "segments", along, shape.segments);
      break;
    }
    case MeshKind::box: shape.size = to_vec3(reader.numbers<3>("size", sizes, {{1, 1, 1}})); break;
    case MeshKind::icosphere:
      shape.size = glm::vec3(reader.number("radius", sizes, 1.0f));
      read_count(reader, "subdivisions", {0, max_subdivisions}, shape.rings);
      break;
    case MeshKind::cylinder:
    case MeshKind::cone:
      read_radius_and_height(reader, shape);
      read_count(reader, "segments", around, shape.segments);
      read_count(reader, "rings", along, shape.rings);
      shape.caps = reader.boolean("caps", true);
      break;
    case MeshKind::torus:
      read_torus(document, json, reader, shape, diagnostics);
      read_count(reader, "segments", around, shape.segments);
      read_count(reader, "rings", around, shape.rings);
      break;
    case MeshKind::lathe:
      shape.profile = parse_profile(document, reader, diagnostics);
      read_count(reader, "segments", around, shape.segments);
      break;
    case MeshKind::gltf:
      shape.file = reader.path("file");
      shape.fit = reader.boolean("fit", false);
      break;
  }
  reader.finish();
  return shape;
}

}  // namespace isoshade::scene
