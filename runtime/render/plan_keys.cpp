// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/plan_keys.h"

#include <bit>
#include <span>
#include <type_traits>

#include "runtime/render/light_reach.h"

namespace isoshade::render {
namespace {

/// Appends values. Strings and lists begin with their lengths, so that no two lists of values give the same bytes. A
/// struct is taken apart whole: a member that is added to it later does not compile here until it is decided on.
class Key {
 public:
  template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  Key& add(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Key& add(const std::string& text) {
    add(text.size());
    bytes_ += text;
    return *this;
  }
  Key& add(const glm::vec3& v) { return add(v.x).add(v.y).add(v.z); }
  template <class T, size_t n>
  Key& add(const std::array<T, n>& values) {
    for (const T& value : values) add(value);
    return *this;
  }
  template <class T>
  Key& add(const std::vector<T>& values) {
    add(values.size());
    for (const T& value : values) add(value);
    return *this;
  }
  template <class T>
  Key& add(const std::optional<T>& value) {
    add(value.has_value());
    return value ? add(*value) : *this;
  }

  Key& add(const graph::Literal& literal) {
    const auto& [kind, boolean, integral, number, integer, numbers, string] = literal;
    return add(kind).add(boolean).add(integral).add(number).add(integer).add(numbers).add(string);
  }
  /// Paths are relative to the file, and may lead out of its folder if it is an argument.
  Key& add(const support::Span& where) {
    add(where.file != nullptr);
    return where.file != nullptr ? add(where.file->path()).add(where.file->origin()) : *this;
  }
  Key& add(const scene::Parameter& parameter) {
    const auto& [name, value, name_where, value_where] = parameter;
    return add(name).add(value).add(value_where);
  }
  Key& add(const scene::Variation& variation) {
    const auto& [name, values, listed, name_where, value_where] = variation;
    return add(name).add(values).add(listed).add(value_where);
  }
  Key& add(const scene::Repeat& repeat) {
    const auto& [count, step, variations] = repeat;
    return add(count).add(step).add(variations);
  }
  Key& add(const scene::Transform& transform) {
    const auto& [translate, rotate, rotation, scale] = transform;
    return add(translate).add(rotate).add(rotation).add(scale);
  }
  /// Without the mesh and the effect.
  Key& add(const scene::Object& object) {
    const auto& [name, mesh, effect, transform, parameters, repeat, casts_shadow, receives_shadow, name_where,
                 effect_where, mesh_where] = object;
    return add(name).add(transform).add(parameters).add(repeat).add(casts_shadow).add(receives_shadow);
  }
  Key& add(const scene::ProfilePoint& point) {
    const auto& [radius, height, smooth] = point;
    return add(radius).add(height).add(smooth);
  }
  Key& add(const scene::MeshShape& shape) {
    const auto& [kind, size, segments, rings, caps, profile, file, format, fit] = shape;
    return add(kind).add(size).add(segments).add(rings).add(caps).add(profile).add(file).add(format).add(fit);
  }
  Key& add(const scene::Sun& sun) {
    const auto& [direction, color, intensity, size] = sun;
    return add(direction).add(color).add(intensity).add(size);
  }
  Key& add(const scene::Sky& sky) {
    const auto& [horizon, zenith, ground, haze, sun] = sky;
    return add(horizon).add(zenith).add(ground).add(haze).add(sun);
  }
  Key& add(const scene::Environment& environment) {
    const auto& [file, sky, rotate, intensity, where, file_where] = environment;
    return add(file).add(sky).add(rotate).add(intensity).add(file_where);
  }
  Key& add(const scene::PostInput& input) {
    const auto& [image, source, image_where, source_where] = input;
    return add(image).add(source);
  }

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Without the environment, which is a part of its own, and the values of posts.
std::string key_of_programs(const scene::Scene& scene) {
  const auto& [name, source, width, height, samples, samples_where, time, frames_per_second, camera, lights, environment,
               background, objects, sort, posts, output, animated, before] = scene;
  Key key;
  key.add(environment.has_value()).add(lights.size());
  for (const scene::Light& light : lights) key.add(light.kind).add(light.shadow.has_value()).add(may_be_left_out(light));
  key.add(objects.size());
  for (const scene::Object& object : objects)
    key.add(object.effect).add(object.effect_where).add(object.receives_shadow);
  key.add(posts.size());
  for (const scene::Post& post : posts) key.add(post.effect).add(post.effect_where).add(post.inputs);
  // Programs are compiled for values that do not move.
  key.add(animated.size());
  for (const scene::AnimatedParameter& parameter : animated) key.add(parameter.owner).add(parameter.parameter);
  return key.take();
}

}  // namespace

const scene::Object& object_before(const scene::Scene& scene, size_t object) {
  const bool has_one = scene.before != nullptr && scene.before->objects.size() == scene.objects.size();
  return has_one ? scene.before->objects[object] : scene.objects[object];
}

std::string key_of(const scene::MeshShape& shape) { return Key().add(shape).take(); }

PlanKeys keys_of(const scene::Scene& scene) {
  PlanKeys keys;
  keys.programs = key_of_programs(scene);
  keys.environment = Key().add(scene.environment).take();
  for (size_t o = 0; o < scene.objects.size(); ++o) {
    const scene::Object& object = scene.objects[o];
    keys.meshes.push_back(Key().add(object.mesh).add(object.mesh_where).take());
    keys.objects.push_back(Key().add(object).add(object_before(scene, o)).take());
  }
  return keys;
}

}  // namespace isoshade::render
