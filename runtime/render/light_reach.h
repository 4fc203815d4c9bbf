// SPDX-License-Identifier: Apache-2.0
// Whether light arrives at a box.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "compiler/lower/frame_layout.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

using LightRecord = std::span<const float, lower::light_word::stride>;

/// A box in world space along the axes. In double: it decides what is drawn, never how.
struct ReachBox {
  double low[3], high[3];
};
/// Around a box in object space. It is wider by more than what rounding moves points that are interpolated between
/// vertices.
ReachBox box_around(const glm::vec3& low, const glm::vec3& high, const glm::mat4& model);

/// Whether a light may be left out for some object.
bool may_be_left_out(const scene::Light& light);

bool is_black(LightRecord light);
/// From the light's position to the nearest point of the box.
double squared_distance(LightRecord light, const ReachBox& box);
/// False if the colour that arrives (lower::light_values) is 0 at every point of the box. True if the light is not
/// finite.
bool reaches(LightRecord light, const ReachBox& box);

}  // namespace isoshade::render
