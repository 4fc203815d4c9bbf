// SPDX-License-Identifier: Apache-2.0
// The records of a frame that are the same for all backends, as words. All is computed under lanes::FpGuard, which the
// caller holds.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "runtime/scene/placement.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

/// Where a copy of an object stands.
struct ObjectTransforms {
  glm::mat4 model;      ///< object space -> world space
  glm::mat4 inverse;    ///< world space -> object space
  glm::mat4 projected;  ///< object space -> clip space
  glm::mat3 normal;     ///< normals: object space -> world space, of any length
};
ObjectTransforms place_of(const scene::Object& object, const scene::Instance& instance, const scene::View& view);

/// Appends a record of lower::object_word, with the words of its parameters.
void append_object(const ObjectTransforms& place, uint32_t pixel_program, std::span<const float> parameters,
                   std::vector<float>& objects);

/// The words of lower::frame_word.
std::vector<float> frame_words(const scene::Scene& scene);

/// The camera of lower::view_word, for an image of this size; matrices are appended to it.
std::vector<float> view_words(const scene::Camera& camera, const scene::View& view, int width, int height);

/// Appends the matrix of a draw, and gives its first word.
int append_matrix(const glm::mat4& projected, std::vector<float>& view);

}  // namespace isoshade::render
