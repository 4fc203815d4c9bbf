// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/records.h"

#include "compiler/lower/frame_layout.h"
#include "runtime/scene/host_math.h"

namespace isoshade::render {
namespace {

/// The first rows, column by column.
template <class Matrix>
void store_rows(const Matrix& matrix, int rows, float* words) {
  for (int c = 0; c < Matrix::length(); ++c)
    for (int r = 0; r < rows; ++r) words[rows * c + r] = scene::canonical(matrix[c][r]);
}

}  // namespace

ObjectTransforms place_of(const scene::Object& object, const scene::Instance& instance) {
  const glm::mat4 model = scene::model_matrix(object, instance);
  return {model, scene::affine_inverse(model), scene::normal_matrix(model)};
}

void append_object(const ObjectTransforms& place, uint32_t pixel_program, Repetition repetition,
                   std::span<const float> parameters, std::vector<float>& objects) {
  namespace word = lower::object_word;
  const size_t first = objects.size();
  objects.resize(first + word::parameters);
  float* record = &objects[first];
  store_rows(place.model, 3, record + word::model);
  store_rows(place.inverse, 3, record + word::inverse);
  store_rows(place.normal, 3, record + word::normal);
  record[word::program] = static_cast<float>(pixel_program);
  record[word::pass_index] = static_cast<float>(repetition.index);
  record[word::pass_count] = static_cast<float>(repetition.count);
  objects.insert(objects.end(), parameters.begin(), parameters.end());
}

void append_columns(const glm::mat4& model, std::vector<float>& words) {
  words.resize(words.size() + columns_words);
  store_rows(model, 3, &words[words.size() - columns_words]);
}

std::vector<float> frame_words(const scene::Scene& scene, int environment) {
  std::vector<float> words(lower::frame_word::count);
  words[lower::frame_word::time] = scene::canonical(scene.time);
  words[lower::frame_word::environment] = static_cast<float>(environment);
  return words;
}

std::vector<float> view_words(const scene::Camera& camera, const scene::View& view, int width, int height) {
  namespace word = lower::view_word;
  std::vector<float> words(word::camera_words);
  for (int i = 0; i < 4; ++i) words[word::eye + i] = scene::canonical(view.eye[i]);
  store_rows(view.view, 3, &words[word::view]);
  store_rows(view.inverse, 3, &words[word::inverse_view]);
  store_rows(view.clip_from_view, 4, &words[word::projection]);
  for (int i = 0; i < 2; ++i)
    words[static_cast<size_t>(word::pixel_size + i)] = scene::canonical(view.pixel_size[i]);
  scene::store_camera(camera, width, height, words);
  return words;
}

void widen_rays(std::span<float> view_words, float factor) {
  namespace word = lower::view_word;
  // Behind the vector in the middle stand the differences to the right and to the lower edge.
  for (const int first : {word::view_ray + 3, word::ray_origin + 3})
    for (float& difference : view_words.subspan(static_cast<size_t>(first), 6)) difference = scene::canonical(difference * factor);
}

int append_matrix(const glm::mat4& projected, std::vector<float>& view) {
  const size_t first = view.size();
  view.resize(first + lower::view_word::matrix);
  store_rows(projected, 4, &view[first]);
  return static_cast<int>(first);
}

}  // namespace isoshade::render
