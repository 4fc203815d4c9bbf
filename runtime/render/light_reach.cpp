// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/light_reach.h"

#include <algorithm>
#include <cmath>

namespace isoshade::render {
namespace {

namespace word = lower::light_word;

/// More than rounding in float changes of a distance, an angle's cosine, or a point of an object: each is a part of the
/// numbers that it is computed from.
constexpr double rounding = 0x1p-16;

/// Whether the box lies outside the cone of a spot, whose factor is saturate(cosine * scale + offset).
bool is_outside_cone(LightRecord light, const ReachBox& box) {
  double distance2 = 0, radius2 = 0, along = 0;
  for (size_t i = 0; i < 3; ++i) {
    const double half = 0.5 * (box.high[i] - box.low[i]);
    const double towards = light[word::position + i] - (box.low[i] + half);
    distance2 += towards * towards;
    radius2 += half * half;
    along += towards * light[word::direction + i];
  }
  const double distance = std::sqrt(distance2), radius = std::sqrt(radius2) * (1 + rounding);
  if (!(distance > radius)) return false;
  // No direction from the sphere around the box to the light is nearer to the axis.
  const double angle = std::acos(std::clamp(along / distance, -1.0, 1.0)) - std::asin(radius / distance);
  const double outer = -double{light[word::cone_offset]} / double{light[word::cone_scale]};
  return std::cos(std::max(angle, 0.0)) < outer - rounding;
}

}  // namespace

ReachBox box_around(const glm::vec3& low, const glm::vec3& high, const glm::mat4& model) {
  ReachBox box;
  for (int i = 0; i < 3; ++i) {
    double least = model[3][i], most = least, magnitude = std::abs(least);
    for (int axis = 0; axis < 3; ++axis) {
      const double a = double{model[axis][i]} * double{low[axis]},
                   b = double{model[axis][i]} * double{high[axis]};
      least += std::min(a, b);
      most += std::max(a, b);
      magnitude += std::max(std::abs(a), std::abs(b));
    }
    // The terms of a coordinate may cancel each other, their roundings do not.
    box.low[i] = least - rounding * magnitude;
    box.high[i] = most + rounding * magnitude;
  }
  return box;
}

bool may_be_left_out(const scene::Light& light) {
  const bool is_far = light.kind == scene::LightKind::directional;
  return light.intensity == 0 || light.color == glm::vec3(0) || (!is_far && light.range > 0) ||
         light.kind == scene::LightKind::spot;
}

bool is_black(LightRecord light) {
  return light[word::color] == 0 && light[word::color + 1] == 0 && light[word::color + 2] == 0;
}

double squared_distance(LightRecord light, const ReachBox& box) {
  double sum = 0;
  for (size_t i = 0; i < 3; ++i) {
    const double at = light[word::position + i];
    const double gap = std::max({box.low[i] - at, at - box.high[i], 0.0});
    sum += gap * gap;
  }
  return sum;
}

bool reaches(LightRecord light, const ReachBox& box) {
  const auto kind = static_cast<scene::LightKind>(light[word::kind]);
  if (kind == scene::LightKind::directional) return true;
  if (!std::ranges::all_of(light, [](float value) { return std::isfinite(value); })) return true;
  // The window of the falloff is saturate(1 - (distance^2 / range^2)^2).
  if (squared_distance(light, box) * light[word::range] > 1 + 4 * rounding) return false;
  return kind != scene::LightKind::spot || !is_outside_cone(light, box);
}

}  // namespace isoshade::render
