// SPDX-License-Identifier: Apache-2.0
// Which meshes cannot be seen.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace isoshade::render {

/// Whether all of a box lies outside of the view, on one side of it and by more than rounding and snapping
/// could undo: then no point in it reaches a pixel, once projected to clip space by `projected`. Where that
/// is in doubt, or a coordinate is not finite, it does not.
bool outside_view(const glm::vec3& low, const glm::vec3& high, const glm::mat4& projected, int width,
                  int height);

}  // namespace isoshade::render
