// SPDX-License-Identifier: Apache-2.0
// Where things stand: the matrices and light records of a frame. Computed under lanes::FpGuard, which the
// callers hold.
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "compiler/lower/frame_layout.h"
#include "runtime/scene/scene.h"

namespace isoshade::scene {

/// World space to clip space, y up. Depth is reversed: z = w on the near plane; in perspective z is near and
/// w the distance along the view, in orthographic projection w is 1 and z falls to 0 at `far`.
struct View {
  glm::mat4 view;        ///< world space -> view space: the camera at the origin, looking along -z, y up
  glm::mat4 inverse;     ///< view space -> world space
  glm::mat4 projection;  ///< world space -> clip space
  glm::mat4 clip_from_view;
  glm::vec4 eye;         ///< view_word::eye
  glm::vec2 pixel_size;  ///< view_word::pixel_size
};
View make_view(const Camera& camera, int width, int height);

/// The camera after a part of a full turn about its target, around its `up`; counter-clockwise seen from above.
Camera turned(const Camera& camera, int64_t part, int64_t whole);

/// Writes what posts read of the camera into an array of lower::view_word.
void store_camera(const Camera& camera, int width, int height, std::span<float> view);

/// Object space to world space.
glm::mat4 model_matrix(const Object& object, const Instance& instance);

/// A record of lower::light_word.
std::array<float, lower::light_word::stride> light_record(const Light& light);

}  // namespace isoshade::scene
