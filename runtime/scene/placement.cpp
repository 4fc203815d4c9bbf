// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/placement.h"

#include <algorithm>

#include "runtime/scene/host_math.h"

namespace isoshade::scene {
namespace {

/// From world space to view space: the camera at the origin, looking along -z, y up.
glm::mat4 view_matrix(const glm::vec3& right, const glm::vec3& up, const glm::vec3& back,
                      const glm::vec3& position) {
  glm::mat4 view(1);
  const glm::vec3 rows[3] = {right, up, back};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) view[c][r] = rows[r][c];
    view[3][r] = -dot(rows[r], position);
  }
  return view;
}

glm::mat4 projection_matrix(const Camera& camera, float aspect) {
  glm::mat4 projection(0);
  if (camera.projection == Projection::perspective) {
    const SinCos half = sin_cos_of_degrees(camera.fov * 0.5f);
    const float scale = half.cos / half.sin;
    projection[0][0] = scale / aspect;
    projection[1][1] = scale;
    projection[3][2] = camera.near;
    projection[2][3] = -1;
  } else {
    const float scale = 2.0f / camera.height;
    const float inverse_depth = 1.0f / (camera.far - camera.near);
    projection[0][0] = scale / aspect;
    projection[1][1] = scale;
    projection[2][2] = inverse_depth;
    projection[3][2] = camera.far * inverse_depth;
    projection[3][3] = 1;
  }
  return projection;
}

/// Unit vectors in world space.
struct Axes {
  glm::vec3 right, up, back;
};
Axes axes_of(const Camera& camera) {
  const glm::vec3 back = normalize(camera.position - camera.target);
  const glm::vec3 right = normalize(cross(camera.up, back));
  return {right, cross(back, right), back};
}

glm::mat3 rotation_about(int axis, float degrees) {
  const SinCos angle = sin_cos_of_degrees(degrees);
  const int next = (axis + 1) % 3;
  const int after = (axis + 2) % 3;
  glm::mat3 rotation(1);
  rotation[next][next] = rotation[after][after] = angle.cos;
  rotation[next][after] = angle.sin;
  rotation[after][next] = -angle.sin;
  return rotation;
}

glm::mat3 rotation_of(const Transform& transform) {
  if (transform.rotation) return rotation_of_quaternion(*transform.rotation);
  return multiply(rotation_about(2, transform.rotate.z),
                  multiply(rotation_about(1, transform.rotate.y), rotation_about(0, transform.rotate.x)));
}

}  // namespace

Camera turned(const Camera& camera, int64_t part, int64_t whole) {
  const SinCos angle = sin_cos_of_turn(part, whole);
  const glm::vec3 axis = normalize(camera.up), arm = camera.position - camera.target;
  const glm::vec3 along = axis * (dot(axis, arm) * (1 - angle.cos));
  Camera turned = camera;
  turned.position = camera.target + (arm * angle.cos + cross(axis, arm) * angle.sin + along);
  return turned;
}

View make_view(const Camera& camera, int width, int height) {
  const auto [right, up, back] = axes_of(camera);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  View view;
  view.view = view_matrix(right, up, back, camera.position);
  view.inverse =
      glm::mat4(glm::vec4(right, 0), glm::vec4(up, 0), glm::vec4(back, 0), glm::vec4(camera.position, 1));
  view.clip_from_view = projection_matrix(camera, aspect);
  view.projection = multiply(view.clip_from_view, view.view);
  const bool perspective = camera.projection == Projection::perspective;
  view.eye = perspective ? glm::vec4(camera.position, 1) : glm::vec4(back, 0);
  // Clip space is 2 high.
  const float pixel = 2.0f / (view.clip_from_view[1][1] * static_cast<float>(height));
  view.pixel_size = perspective ? glm::vec2(0, pixel) : glm::vec2(pixel, 0);
  return view;
}

void store_camera(const Camera& camera, int width, int height, std::span<float> view) {
  namespace word = lower::view_word;
  const auto store = [&](int at, const glm::vec3& v) {
    for (int i = 0; i < 3; ++i) view[static_cast<size_t>(at + i)] = canonical(v[i]);
  };
  const auto store_over_screen = [&](int at, const glm::vec3& middle, const glm::vec3& across,
                                     const glm::vec3& down) {
    store(at, middle);
    store(at + 3, across);
    store(at + 6, down);
  };
  const auto store_pair = [&](int at, float a, float b) {
    view[static_cast<size_t>(at)] = canonical(a);
    view[static_cast<size_t>(at + 1)] = canonical(b);
  };
  const auto [right, up, back] = axes_of(camera);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const bool perspective = camera.projection == Projection::perspective;
  const SinCos half_angle = sin_cos_of_degrees(camera.fov * 0.5f);
  const float half = perspective ? half_angle.sin / half_angle.cos : camera.height * 0.5f;
  const glm::vec3 across = right * (half * aspect), down = -up * half, nothing(0);
  store(word::camera_position, camera.position);
  store(word::camera_direction, -back);
  store_over_screen(word::view_ray, -back, perspective ? across : nothing, perspective ? down : nothing);
  store_over_screen(word::ray_origin, nothing, perspective ? nothing : across, perspective ? nothing : down);
  const float depth = camera.far - camera.near;
  store_pair(word::depth_numerator, perspective ? camera.near : camera.far, perspective ? 0 : -depth);
  store_pair(word::depth_denominator, perspective ? 0.0f : 1.0f, perspective ? 1.0f : 0.0f);
}

glm::mat4 model_matrix(const Object& object, const Instance& instance) {
  const glm::mat3 rotation = rotation_of(object.transform);
  glm::mat4 model(1);
  for (int c = 0; c < 3; ++c) model[c] = glm::vec4(rotation[c] * object.transform.scale[c], 0);
  model[3] = glm::vec4(instance_translation(object, instance), 1);
  return model;
}

std::array<float, lower::light_word::stride> light_record(const Light& light) {
  namespace word = lower::light_word;
  std::array<float, word::stride> record{};
  const auto store = [&](int at, const glm::vec3& value) {
    for (int i = 0; i < 3; ++i) record[static_cast<size_t>(at + i)] = value[i];
  };
  record[word::kind] = static_cast<float>(light.kind);
  if (light.kind != LightKind::point) store(word::direction, normalize(-light.direction));
  if (light.kind != LightKind::directional) store(word::position, light.position);
  store(word::color, light.color * light.intensity);
  record[word::cone_offset] = 1;  // no cone: a falloff of 1 at every angle
  if (light.kind == LightKind::spot) {
    const float inner = sin_cos_of_degrees(light.inner_angle).cos;
    const float outer = sin_cos_of_degrees(light.outer_angle).cos;
    // The minimum difference is that of glTF's KHR_lights_punctual.
    const float scale = 1.0f / std::max(0.001f, inner - outer);
    record[word::cone_scale] = scale;
    record[word::cone_offset] = -outer * scale;
  }
  if (light.range > 0) record[word::range] = 1.0f / (light.range * light.range);
  for (float& value : record) value = canonical(value);
  return record;
}

}  // namespace isoshade::scene
