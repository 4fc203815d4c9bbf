// SPDX-License-Identifier: Apache-2.0
// How far what the picture shows has moved since the frame before: a view of its own, whose vertices are placed twice.
#include <algorithm>

#include "compiler/lower/frame_layout.h"
#include "runtime/render/planner.h"
#include "runtime/scene/host_math.h"

namespace isoshade::render {
namespace {

bool may_read_motion(const scene::Scene& scene, const std::vector<const driver::Post*>& documents) {
  const auto is_motion = [](const scene::PostInput& input) { return input.source == scene::motion_image; };
  for (size_t p = 0; p < scene.posts.size(); ++p)
    if (documents[p]->motion || std::ranges::any_of(scene.posts[p].inputs, is_motion)) return true;
  return false;
}

/// The rows x, y and w of a matrix, without what it does to points alone.
void append_rows(const glm::mat4& matrix, std::vector<float>& words) {
  for (const int row : {0, 1, 3})
    for (int column = 0; column < 3; ++column) words.push_back(scene::canonical(matrix[column][row]));
}

}  // namespace

void Planner::begin_motion(int width, int height) {
  if (!may_read_motion(scene_, posts_)) return;
  MotionPlan& motion = plan_.motion.emplace();
  const scene::Camera& camera = scene_.before != nullptr ? scene_.before->camera : scene_.camera;
  const scene::View view = scene::make_view(camera, width, height);
  projection_before_ = view.projection;
  motion.before.target = motion.now.target = {"the motion", width, height};
  motion.before.words = view_words(camera, view, width, height);
  motion.before.frame = plan_.frame.frame;
  const double earlier = static_cast<double>(scene_.time) - 1 / static_cast<double>(scene_.frames_per_second);
  motion.before.frame[lower::frame_word::time] =
      scene::canonical(scene_.before != nullptr ? scene_.before->time : static_cast<float>(earlier));
  append_rows(scene::make_view(scene_.camera, width, height).projection, motion.backdrop);
  append_rows(view.projection, motion.backdrop);
  motion.complete = &driver::backdrop_motion_program(options_.compiler.reference);
}

uint32_t Planner::motion_program(uint32_t pixel) {
  backends::Frame& frame = plan_.frame;
  const uint32_t cutout = frame.cutouts.empty() ? backends::Frame::no_program : frame.cutouts[pixel];
  const auto [found, is_new] = motion_programs_.try_emplace(cutout, static_cast<uint32_t>(frame.programs.size()));
  if (!is_new) return found->second;
  frame.programs.push_back(&driver::motion_program(options_.compiler.reference));
  if (!frame.cutouts.empty()) frame.cutouts.push_back(cutout);
  return found->second;
}

void Planner::place_motion(size_t o, const Copy& copy, size_t part, const backends::Draw& draw,
                           const Appearance& appearance) {
  std::vector<float>& objects = plan_.frame.objects;
  const driver::Effect& effect = plan_.effects[effect_of_object_[o]];
  MovedDraw moved{appearance.nearness, draw, draw};
  moved.now.blended = moved.before.blended = false;
  moved.now.pixel_program = motion_program(draw.pixel_program);
  const std::vector<float> record(objects.begin() + draw.object, objects.end());
  moved.now.object = static_cast<int>(objects.size());
  objects.insert(objects.end(), record.begin(), record.end());
  objects[static_cast<size_t>(moved.now.object) + lower::object_word::program] =
      static_cast<float>(moved.now.pixel_program);

  const ObjectTransforms place = place_of(before(o), copy.instance);
  const auto& parameters = parameters_before_.empty() ? parameters_ : parameters_before_;
  std::vector<float> words =
      parameters[o][part].words(copy.instance, [&](int number) { return textures_.record(number); });
  if (effect.reads_previous) append_columns(place.model, words);
  moved.before.object = static_cast<int>(objects.size());
  const Repetition repetition{static_cast<int>(record[lower::object_word::pass_index]),
                              static_cast<int>(record[lower::object_word::pass_count])};
  append_object(place, moved.now.pixel_program, repetition, words, objects);
  moved.before.projected =
      append_matrix(scene::multiply(projection_before_, place.model), plan_.motion->before.words);
  (draw.blended ? moved_blended_ : moved_).push_back(std::move(moved));
}

void Planner::finish_motion() {
  if (!plan_.motion) return;
  plan_.motion->now.words = plan_.frame.picture().words;
  if (scene_.sort == scene::Sort::back_to_front) std::ranges::stable_sort(moved_blended_, {}, &MovedDraw::nearness);
  for (const std::vector<MovedDraw>* all : {&moved_, &moved_blended_}) {
    for (const MovedDraw& draw : *all) {
      plan_.motion->now.draws.push_back(draw.now);
      plan_.motion->before.draws.push_back(draw.before);
    }
  }
}

}  // namespace isoshade::render
