// SPDX-License-Identifier: Apache-2.0
// The records of a frame, which are the same for all backends, as words. Callers hold a lanes::FpGuard.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "backends/backend.h"
#include "runtime/scene/placement.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

/// Where a copy of an object stands.
struct ObjectTransforms {
  glm::mat4 model;    ///< object space -> world space
  glm::mat4 inverse;  ///< world space -> object space
  glm::mat3 normal;   ///< normals: object space -> world space, of any length
};
ObjectTransforms place_of(const scene::Object& object, const scene::Instance& instance);

/// Which repetition of a pass is drawn, and how many there are.
struct Repetition {
  int index = 0, count = 1;
};

/// Appends a record of lower::object_word, with the words of its parameters.
void append_object(const ObjectTransforms& place, uint32_t pixel_program, Repetition repetition,
                   std::span<const float> parameters, std::vector<float>& objects);

/// Appends four columns of 3, as object_word::model.
inline constexpr int columns_words = 12;
void append_columns(const glm::mat4& model, std::vector<float>& words);

/// The words of lower::frame_word. `environment`: its first record, or -1.
std::vector<float> frame_words(const scene::Scene& scene, int environment);

/// The camera of lower::view_word, for an image of this size; matrices are appended to it.
std::vector<float> view_words(const scene::Camera& camera, const scene::View& view, int width, int height);

/// For an image that is wider than the camera's picture by a factor: camera rays lead to its edges.
void widen_rays(std::span<float> view_words, float factor);

/// Appends the matrix of a draw, object space -> clip space, and returns its first word.
int append_matrix(const glm::mat4& projected, std::vector<float>& view);

}  // namespace isoshade::render
