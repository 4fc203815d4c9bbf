// SPDX-License-Identifier: Apache-2.0
// Cameras and lights.
#include "compiler/support/visible.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/parse_parts.h"

namespace isoshade::scene {

using graph::Document;
using graph::Json;
using graph::Member;
using graph::ObjectReader;
using support::Diagnostics;
using support::Id;
using Need = ObjectReader::Need;

namespace {

void check_view(const Camera& camera, support::Span where, Diagnostics& diagnostics) {
  if (camera.position == camera.target) {
    diagnostics.report(Id::degenerate, where, "the camera looks at where it stands")
        .suggest("move \"target\" or \"position\"");
    return;
  }
  bool sees_up = false;
  {
    const lanes::FpGuard guard;
    sees_up = camera.up != glm::vec3(0) && !parallel(camera.target - camera.position, camera.up);
  }
  if (sees_up) return;
  diagnostics.report(Id::degenerate, where, "\"up\" of the camera is zero or lies along the view")
      .suggest("for a view straight down, \"up\": [0, 0, -1]");
}

}  // namespace

Camera parse_camera(const Document& document, const Json& json, Diagnostics& diagnostics) {
  Camera camera;
  ObjectReader reader(document, json, "the camera", diagnostics);
  camera.projection = static_cast<Projection>(reader.choice("type", {"perspective", "orthographic"}, 0));
  camera.position = to_vec3(reader.numbers<3>("position", coordinates));
  camera.target = to_vec3(reader.numbers<3>("target", coordinates));
  camera.up = to_vec3(reader.numbers<3>("up", coordinates, {{0, 1, 0}}));
  camera.near = reader.number("near", lengths, camera.near);
  if (camera.projection == Projection::perspective) {
    camera.fov = reader.number("fov", {0.01, 179}, camera.fov);
  } else {
    camera.height = reader.number("height", lengths);
    camera.far = reader.number("far", lengths, camera.far);
    if (!(camera.far > camera.near)) {
      diagnostics.report(Id::out_of_range, document.span(json),
                         "\"far\" of the camera must be greater than \"near\"");
    }
  }
  if (reader.finish()) check_view(camera, document.span(json), diagnostics);
  return camera;
}

Light parse_light(const Document& document, const Member& member, Diagnostics& diagnostics) {
  Light light;
  light.name = member.key;
  ObjectReader reader(document, member.value, "light " + support::quote(member.key), diagnostics);
  light.kind = static_cast<LightKind>(reader.choice("type", {"directional", "point", "spot"}));
  light.color = to_vec3(reader.numbers<3>("color", brightness, {{1, 1, 1}}));
  light.intensity = reader.number("intensity", brightness, 1.0f);
  if (light.kind != LightKind::point) light.direction = to_vec3(reader.numbers<3>("direction", coordinates));
  if (light.kind != LightKind::directional) {
    light.position = to_vec3(reader.numbers<3>("position", coordinates));
    light.range = reader.optional_number("range", lengths).value_or(0.0f);
  }
  if (light.kind == LightKind::spot) {
    light.inner_angle = reader.number("inner_angle", {0, 89}, 0.0f);
    light.outer_angle = reader.number("outer_angle", {0.01, 90}, 45.0f);
  }
  if (!reader.finish()) return light;
  if (light.direction == glm::vec3(0)) {
    diagnostics.report(Id::degenerate, document.span(member.value),
                       "\"direction\" of light " + support::quote(member.key) + " is zero");
  }
  if (light.kind == LightKind::spot && !(light.outer_angle > light.inner_angle)) {
    diagnostics.report(
        Id::out_of_range, document.span(member.value),
        "\"outer_angle\" of light " + support::quote(member.key) + " must be greater than \"inner_angle\"");
  }
  return light;
}

}  // namespace isoshade::scene
