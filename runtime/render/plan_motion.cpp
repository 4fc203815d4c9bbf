// SPDX-License-Identifier: Apache-2.0
// How far what the picture shows has moved since the frame before: a view of its own, whose vertices are placed twice.
#include <algorithm>

#include "compiler/lower/frame_layout.h"
#include "runtime/render/planner.h"
#include "runtime/scene/host_math.h"

namespace isoshade::render {
namespace {

/// The rows x, y and w of a matrix, without what it does to points alone.
void append_rows(const glm::mat4& matrix, std::vector<float>& words) {
  for (const int row : {0, 1, 3})
    for (int column = 0; column < 3; ++column) words.push_back(scene::canonical(matrix[column][row]));
}

}  // namespace

bool Planner::may_read_motion() const {
  const auto is_motion = [](const scene::PostInput& input) { return input.source == scene::motion_image; };
  for (size_t p = 0; p < scene_->posts.size(); ++p)
    if (posts_[p]->motion || std::ranges::any_of(scene_->posts[p].inputs, is_motion)) return true;
  return false;
}

void Planner::begin_motion(int width, int height) {
  plan_.motion.reset();
  if (!has_motion_) return;
  MotionPlan& motion = plan_.motion.emplace();
  const scene::Camera& camera = scene_->before != nullptr ? scene_->before->camera : scene_->camera;
  const scene::View view = scene::make_view(camera, width, height);
  projection_before_ = view.projection;
  motion.before.target = motion.now.target = {"the motion", width, height};
  motion.before.words = view_words(camera, view, width, height);
  motion.before.frame = frame_earlier_;
  append_rows(scene::make_view(scene_->camera, width, height).projection, motion.backdrop);
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

/// Appends the records of a pass again, and then those at the frame before. place_all() writes their program.
void Planner::append_motion_records(size_t o, const scene::Instance& instance, size_t part, const driver::EffectPass& pass,
                                    const PlacedPass& made, Placed& placed) const {
  const std::vector<float> now(placed.objects.begin() + made.record, placed.objects.end());
  placed.objects.insert(placed.objects.end(), now.begin(), now.end());
  const ObjectTransforms place = place_of(before(o), instance);
  const PartValues& parameters = parameters_before_[o].empty() ? parameters_[o] : parameters_before_[o];
  std::vector<float> words = parameters[part].words(instance, [&](int number) { return textures_.record(number); });
  if (plan_.effects[effect_of_object_[o]].reads_previous) append_columns(place.model, words);
  for (int repetition = 0; repetition < made.repetitions; ++repetition)
    append_record(o, pass, made.blended, place, 0, {repetition, made.repetitions}, words, placed, true);
}

void Planner::see_motion(const PlacedPass& pass, size_t copy, int repetition, const backends::Draw& draw, float nearness,
                         int& matrix_before, Seen& seen) const {
  MovedDraw moved{nearness, draw, draw};
  moved.now.blended = moved.before.blended = false;
  const int stride = record_words(placed_.copies[copy].object);
  moved.now.object = pass.record + (pass.repetitions + repetition) * stride;
  moved.before.object = pass.record + (2 * pass.repetitions + repetition) * stride;
  moved.now.pixel_program = static_cast<uint32_t>(
      plan_.frame.objects[static_cast<size_t>(moved.now.object) + lower::object_word::program]);
  if (matrix_before < 0)
    matrix_before =
        append_matrix(scene::multiply(projection_before_, placed_.models_before[copy]), seen.words_before);
  moved.before.projected = matrix_before;
  (draw.blended ? seen.moved_blended : seen.moved).push_back(std::move(moved));
}

void Planner::finish_motion(Seen& all) {
  if (!plan_.motion) return;
  plan_.motion->now.words = plan_.frame.picture().words;
  if (scene_->sort == scene::Sort::back_to_front)
    std::ranges::stable_sort(all.moved_blended, {}, &MovedDraw::nearness);
  for (const std::vector<MovedDraw>* moved : {&all.moved, &all.moved_blended}) {
    for (const MovedDraw& draw : *moved) {
      plan_.motion->now.draws.push_back(draw.now);
      plan_.motion->before.draws.push_back(draw.before);
    }
  }
}

}  // namespace isoshade::render
