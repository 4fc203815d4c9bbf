// SPDX-License-Identifier: Apache-2.0
// The copies of a repeated object. The callers hold lanes::FpGuard.
#include <algorithm>

#include "runtime/scene/scene.h"

namespace isoshade::scene {

int64_t instance_count(const Object& object) {
  int64_t count = 1;
  for (const Repeat& repeat : object.repeat) count *= repeat.count;
  return count;
}

Instance instance(const Object& object, int64_t index) {
  Instance instance;
  for (size_t axis = 0; axis < object.repeat.size(); ++axis) {
    instance.place[axis] = index % object.repeat[axis].count;
    index /= object.repeat[axis].count;
  }
  return instance;
}

std::string instance_name(const Object& object, const Instance& instance) {
  if (object.repeat.empty()) return object.name;
  std::string name = object.name + "[";
  for (size_t axis = 0; axis < object.repeat.size(); ++axis) {
    if (axis != 0) name += ",";
    name += std::to_string(instance.place[axis]);
  }
  return name + "]";
}

glm::vec3 instance_translation(const Object& object, const Instance& instance) {
  glm::vec3 translation = object.transform.translate;
  for (size_t axis = 0; axis < object.repeat.size(); ++axis)
    translation += static_cast<float>(instance.place[axis]) * object.repeat[axis].step;
  return translation;
}

graph::Literal variation_value(const Variation& variation, int64_t place, int64_t count) {
  if (variation.listed) return variation.values[static_cast<size_t>(place)];
  const graph::Literal& from = variation.values[0];
  const graph::Literal& to = variation.values[1];
  const float t = count == 1 ? 0.0f : static_cast<float>(place) / static_cast<float>(count - 1);
  // Rounding could leave the interval, and with it the parameter's range.
  const auto between = [t](float a, float b) {
    return t == 1.0f ? b : std::clamp(a * (1.0f - t) + b * t, std::min(a, b), std::max(a, b));
  };
  graph::Literal value;
  value.kind = from.kind;
  value.number = between(from.number, to.number);
  for (size_t i = 0; i < from.numbers.size(); ++i)
    value.numbers.push_back(between(from.numbers[i], to.numbers[i]));
  return value;
}

}  // namespace isoshade::scene
