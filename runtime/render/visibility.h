// SPDX-License-Identifier: Apache-2.0
// Which meshes a view cannot see.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace isoshade::render {

/// Whether the whole box, transformed to clip space by `projected`, lies outside one side of the view, by more than
/// rounding and snapping can undo; then no point in it reaches a pixel. False in case of doubt, and if a coordinate is
/// not finite.
bool outside_view(const glm::vec3& low, const glm::vec3& high, const glm::mat4& projected, int width,
                  int height);

}  // namespace isoshade::render
