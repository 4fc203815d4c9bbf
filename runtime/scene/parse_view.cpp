// SPDX-License-Identifier: Apache-2.0
// Cameras, lights and environments.
#include "compiler/support/visible.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/parse_parts.h"

namespace isoshade::scene {

using graph::Document;
using graph::Json;
using graph::Member;
using support::Diagnostics;
using support::Id;

namespace {

void check_view(const Camera& camera, support::Span where, Diagnostics& diagnostics) {
  if (camera.position == camera.target) {
    diagnostics.report(Id::degenerate, where, "the position and the target of the camera are the same")
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

Shadow parse_shadow(const Document& document, const Json& json, Diagnostics& diagnostics) {
  namespace key = format::shadow;
  Shadow shadow;
  format::Reader<format::Object::shadow> reader(document, json, "the shadow of a light", diagnostics);
  shadow.size = static_cast<int>(reader.read(key::size));
  shadow.bias = reader.read(key::bias);
  shadow.softness = reader.read(key::softness);
  reader.finish();
  return shadow;
}

/// Reports a direction that is zero, or as float so short that it is.
void check_direction(const glm::vec3& direction, const std::string& what, const support::Span& where,
                     Diagnostics& diagnostics) {
  if (direction != glm::vec3(0)) return;
  diagnostics.report(Id::degenerate, where, "\"direction\" of " + what + " is zero, or too short to have a direction")
      .suggest("write a vector of about length 1, such as [0, -1, 0]");
}

Sun parse_sun(const Document& document, const Json& json, Diagnostics& diagnostics) {
  namespace key = format::sun;
  Sun sun;
  format::Reader<format::Object::sun> reader(document, json, "the sun", diagnostics);
  sun.direction = to_vec3(reader.read(key::direction));
  sun.color = to_vec3(reader.read(key::color));
  sun.intensity = reader.read(key::intensity);
  sun.size = reader.read(key::size);
  if (reader.finish()) check_direction(sun.direction, "the sun", reader.where(key::direction), diagnostics);
  return sun;
}

Sky parse_sky(const Document& document, const Json& json, Diagnostics& diagnostics) {
  namespace key = format::sky;
  Sky sky;
  format::Reader<format::Object::sky> reader(document, json, "the sky", diagnostics);
  sky.horizon = to_vec3(reader.read(key::horizon));
  sky.zenith = to_vec3(reader.read(key::zenith));
  sky.ground = to_vec3(reader.read(key::ground));
  sky.haze = reader.read(key::haze);
  if (const Json* sun = reader.read(key::sun)) sky.sun = parse_sun(document, *sun, diagnostics);
  reader.finish();
  return sky;
}

}  // namespace

Environment parse_environment(const Document& document, const Json& json, Diagnostics& diagnostics) {
  namespace key = format::environment;
  Environment environment;
  environment.where = document.span(json);
  format::Reader<format::Object::environment> reader(document, json, "the environment", diagnostics);
  environment.rotate = reader.read(key::rotate);
  environment.intensity = reader.read(key::intensity);
  const bool has_sky = reader.has(key::sky);
  if (has_sky && reader.has(key::file)) {
    diagnostics.report(Id::unknown_key, reader.where(key::sky), "the environment has both a \"file\" and a \"sky\"")
        .suggest("remove one of them; in a scene that extends another one, write \"file\": null or \"sky\": null");
  }
  if (!has_sky && !reader.has(key::file)) {
    diagnostics.report(Id::missing_key, document.span(json), "the environment needs a \"file\" or a \"sky\"")
        .suggest("for a clear sky: \"sky\": {}");
  }
  if (reader.has(key::file)) {
    environment.file = reader.read(key::file);
    environment.file_where = reader.where(key::file);
  }
  if (has_sky)
    if (const Json* sky = reader.read(key::sky)) environment.sky = parse_sky(document, *sky, diagnostics);
  reader.finish();
  return environment;
}

Camera parse_camera(const Document& document, const Json& json, Diagnostics& diagnostics) {
  namespace key = format::camera;
  Camera camera;
  format::Reader<format::Object::camera> reader(document, json, "the camera", diagnostics);
  camera.projection = static_cast<Projection>(reader.read(key::type));
  camera.position = to_vec3(reader.read(key::position));
  camera.target = to_vec3(reader.read(key::target));
  camera.up = to_vec3(reader.read(key::up));
  camera.near = reader.read(key::near);
  if (camera.projection == Projection::perspective) {
    camera.fov = reader.read(key::fov);
  } else {
    camera.height = reader.read(key::height);
    camera.far = reader.read(key::far);
    if (!(camera.far > camera.near)) {
      diagnostics.report(Id::out_of_range, document.span(json),
                         "\"far\" of the camera must be greater than \"near\"");
    }
  }
  if (reader.finish()) check_view(camera, document.span(json), diagnostics);
  return camera;
}

Light parse_light(const Document& document, const Member& member, Diagnostics& diagnostics) {
  namespace key = format::light;
  Light light;
  light.name = member.key;
  format::Reader<format::Object::light> reader(document, member.value, "light " + support::quote(member.key),
                                               diagnostics);
  light.kind = static_cast<LightKind>(reader.read(key::type));
  light.color = to_vec3(reader.read(key::color));
  light.intensity = reader.read(key::intensity);
  if (light.kind != LightKind::point) light.direction = to_vec3(reader.read(key::direction));
  if (light.kind != LightKind::directional) {
    light.position = to_vec3(reader.read(key::position));
    light.range = reader.read(key::range);
  }
  if (light.kind == LightKind::spot) {
    light.inner_angle = reader.read(key::inner_angle);
    light.outer_angle = reader.read(key::outer_angle);
  }
  if (const Json* shadow = reader.read(key::shadow)) {
    light.shadow = parse_shadow(document, *shadow, diagnostics);
    const Json* size = shadow->find(format::shadow::size.name);
    light.shadow_where = document.span(size != nullptr ? *size : *shadow);
  }
  if (!reader.finish()) return light;
  check_direction(light.direction, "light " + support::quote(member.key), reader.where(key::direction), diagnostics);
  if (light.kind == LightKind::spot && !(light.outer_angle > light.inner_angle)) {
    diagnostics.report(
        Id::out_of_range, document.span(member.value),
        "\"outer_angle\" of light " + support::quote(member.key) + " must be greater than \"inner_angle\"");
  }
  return light;
}

}  // namespace isoshade::scene
