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
void append_columns(const glm::mat4& model, std::vector<float>& words);

/// The words of lower::frame_word. `environment`: its first record, or -1.
std::vector<float> frame_words(const scene::Scene& scene, int environment);

/// The camera of lower::view_word, for an image of this size; matrices are appended to it.
std::vector<float> view_words(const scene::Camera& camera, const scene::View& view, int width, int height);

/// For an image that is wider than the camera's picture by a factor: camera rays lead to its edges.
void widen_rays(std::span<float> view_words, float factor);

/// Appends the matrix of a draw, object space -> clip space, and returns its first word.
int append_matrix(const glm::mat4& projected, std::vector<float>& view);

/// The images that a program reads: the arrays `layers` and `layer_records`.
struct Layers {
  std::vector<float> floats;
  std::vector<int32_t> records;

  /// Begins with the record of the image that the program makes.
  Layers(int width, int height);
  /// Appends an image, 1 or 4 floats a pixel, and its record. `camera`: see image_word.
  void add(std::span<const float> pixels, int width, int height, int camera = no_camera);
  /// Appends rows of an image of this size and number of floats a pixel, from `first_row` on: no others are read.
  void add_rows(std::span<const float> rows, int channels, int width, int height, int first_row);
  /// Appends the record of an image that is there already.
  void add_again(size_t record);
  /// Appends the record of an image that the program does not read. Posts may still ask for the size of the depth.
  void add_unread(int width = 0, int height = 0);
  /// Appends the camera of a view, then the depth and the color that it drew. A target without color gets the record of
  /// an image that is not read.
  void add_target(const backends::View& view, const backends::Image& drawn);

  /// Appends the records of a target that is not read.
  void add_no_target();

  static constexpr int no_camera = -1;

 private:
  void add_record(int64_t first, int width, int height, int camera);
};

}  // namespace isoshade::render
