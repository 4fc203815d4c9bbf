// SPDX-License-Identifier: Apache-2.0
// The records of all copies of all objects, whichever of them a view sees.
#include <algorithm>
#include <cstring>
#include <utility>

#include "compiler/lower/frame_layout.h"
#include "runtime/lanes/lanes.h"
#include "runtime/render/planner.h"
#include "runtime/scene/placement.h"

namespace isoshade::render {

using scene::Instance;
using scene::Object;

int Planner::repetitions_of(const driver::Effect& effect, const driver::EffectPass& pass,
                            std::span<const float> parameters) const {
  return options_.disabled ? effect.parameters.most_repetitions(pass.repeat)
                           : effect.parameters.repetitions(pass.repeat, parameters);
}

/// The words of each record of an object.
int Planner::record_words(size_t o) const {
  const driver::Effect& effect = plan_.effects[effect_of_object_[o]];
  const int64_t values = parameters_[o].front().word_count();
  const bool has_columns = effect.reads_previous || effect.draw_words != 0;
  return static_cast<int>(lower::object_word::parameters + values + (has_columns ? columns_words : 0) + effect.draw_words);
}

Hull Planner::hull_of(size_t o, const glm::mat4& model) const {
  // Of a mesh whose passes move vertices; shadows may miss a surface that an author moves further.
  constexpr float moved = 0.5f;
  const Object& object = scene_->objects[o];
  const StoredMesh& mesh = plan_.meshes[mesh_of_object_[o]];
  const std::vector<driver::EffectPass>& passes = plan_.effects[effect_of_object_[o]].passes;
  Hull hull;
  hull.moves = std::ranges::any_of(passes, &driver::EffectPass::moves_vertices);
  hull.corners = corners_of(mesh.low, mesh.high, hull.moves ? moved : 0.0f, model);
  hull.box = box_around(mesh.low, mesh.high, model);
  hull.casts = object.casts_shadow && std::ranges::any_of(passes, &driver::EffectPass::casts_shadow);
  hull.casts_anywhere = hull.casts && std::ranges::any_of(passes, [](const driver::EffectPass& pass) {
    return pass.casts_shadow && pass.moves_vertices;
  });
  hull.may_show = object.receives_shadow;
  hull.may_darken = object.receives_shadow && std::ranges::any_of(passes, &driver::EffectPass::receives_shadow);
  return hull;
}

void Planner::append_record(size_t o, const driver::EffectPass& pass, bool blended, const ObjectTransforms& place,
                            uint32_t program, Repetition repetition, std::span<const float> words, Placed& placed,
                            bool before) const {
  const size_t first = placed.objects.size();
  append_object(place, program, repetition, words, placed.objects);
  if (plan_.effects[effect_of_object_[o]].draw_words == 0) return;
  placed.objects.resize(first + static_cast<size_t>(record_words(o)));
  std::optional<DrawEvaluator>& evaluator = before ? placed.evaluator_before : placed.evaluator;
  if (!evaluator) {
    evaluator.emplace();
    evaluator->bind(lower::FrameBuffer::frame, before ? frame_earlier_ : frame_now_);
    evaluator->bind(lower::FrameBuffer::textures, plan_.frame.textures);
  }
  const std::span<float> record = std::span(placed.objects).subspan(first);
  evaluator->fill(pass.vertex.draw, record);
  if (pass.cutout) evaluator->fill(pass.cutout->draw, record);
  evaluator->fill((blended ? *pass.blend : pass.pixel).draw, record);
}

/// Writes the records of one copy: of one pass after the other, those over each part.
void Planner::place_copy(size_t o, int64_t number, Placed& placed) const {
  const Object& object = scene_->objects[o];
  const driver::Effect& effect = plan_.effects[effect_of_object_[o]];
  const Instance instance = scene::instance(object, number);
  const ObjectTransforms place = place_of(object, instance);
  placed.copies.push_back({place.model, static_cast<uint32_t>(o), static_cast<uint32_t>(placed.passes.size())});
  if (std::ranges::any_of(scene_->lights, [](const scene::Light& light) { return light.shadow.has_value(); }))
    placed.hulls.push_back(hull_of(o, place.model));
  const bool needs_before = has_motion_ || effect.reads_previous;
  const glm::mat4 model_before = needs_before ? scene::model_matrix(before(o), instance) : glm::mat4(1);
  if (has_motion_) placed.models_before.push_back(model_before);

  std::vector<std::vector<float>> values;
  for (const ParameterValues& part : parameters_[o])
    values.push_back(part.words(instance, [&](int texture) { return textures_.record(texture); }));
  for (size_t p = 0; p < effect.passes.size(); ++p) {
    const driver::EffectPass& pass = effect.passes[p];
    const PassPrograms& programs = programs_of_effect_[effect_of_object_[o]][p];
    for (size_t part = 0; part < values.size(); ++part) {
      PlacedPass& made = placed.passes.emplace_back();
      made.record = static_cast<int>(placed.objects.size());
      if (!options_.disabled && effect.parameters.is_off(pass.enabled, values[part])) continue;
      made.repetitions = repetitions_of(effect, pass, values[part]);
      made.blended = pass.blend && !effect.parameters.is_off(pass.blended, values[part]);
      made.double_sided = effect.parameters.is_on(pass.double_sided, values[part]);
      made.cutout = pass.cutout && effect.parameters.cuts_out(pass.cutoff, values[part]);
      made.moves = has_motion_ && (!made.blended || pass.state.depth_write == interface::DepthWrite::on);
      std::vector<float> words = values[part];
      if (effect.reads_previous) append_columns(model_before, words);
      for (int repetition = 0; repetition < made.repetitions; ++repetition) {
        placed.origins.push_back({static_cast<int>(placed.objects.size()), static_cast<uint32_t>(o), &pass});
        append_record(o, pass, made.blended, place, made.blended ? programs.blend : programs.pixel,
                      {repetition, made.repetitions}, words, placed);
      }
      if (made.moves) append_motion_records(o, instance, part, pass, PlacedPass(made), placed);
    }
  }
}

void Planner::append(Placed& part) {
  std::vector<float>& objects = plan_.frame.objects;
  const auto words = static_cast<int>(objects.size());
  const auto passes = static_cast<uint32_t>(placed_.passes.size());
  for (PlacedCopy& copy : part.copies) copy.first_pass += passes;
  for (PlacedPass& pass : part.passes) pass.record += words;
  for (RecordOrigin& origin : part.origins) origin.record += words;
  const auto move = [](auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); };
  move(part.copies, placed_.copies);
  move(part.passes, placed_.passes);
  move(part.models_before, placed_.models_before);
  move(part.hulls, placed_.hulls);
  move(part.objects, objects);
  move(part.origins, plan_.origins);
  part = {};
}

void Planner::place_all() {
  const lanes::FpGuard guard;
  std::vector<int64_t> first{0};  // copy of each object, and the number of all copies
  for (const Object& object : scene_->objects) first.push_back(first.back() + scene::instance_count(object));
  auto parts = in_parts<Placed>(static_cast<size_t>(first.back()), [&](size_t i, Placed& placed) {
    const auto number = static_cast<int64_t>(i);
    const auto object = std::ranges::upper_bound(first, number) - first.begin() - 1;
    place_copy(static_cast<size_t>(object), number - first[static_cast<size_t>(object)], placed);
  });
  placed_ = {};
  backends::Frame& frame = plan_.frame;
  const std::vector<float> objects_before = std::exchange(frame.objects, {});
  plan_.origins.clear();
  size_t words = 0;
  for (const Placed& part : parts) words += part.objects.size();
  frame.objects.reserve(words);
  for (Placed& part : parts) append(part);

  // Programs for motion only now, because they are added to the frame in the order of the scene.
  frame.programs.resize(programs_without_motion_);
  if (!frame.cutouts.empty()) frame.cutouts.resize(programs_without_motion_);
  motion_programs_.clear();
  if (has_motion_) {
    for (const PlacedCopy& copy : placed_.copies) {
      const int stride = record_words(copy.object);
      const size_t parts_of_copy = parameters_[copy.object].size();
      const auto& programs = programs_of_effect_[effect_of_object_[copy.object]];
      for (size_t i = 0; i < programs.size() * parts_of_copy; ++i) {
        const PlacedPass& pass = placed_.passes[copy.first_pass + i];
        if (!pass.moves) continue;
        const PassPrograms& of_pass = programs[i / parts_of_copy];
        const auto program = static_cast<float>(motion_program(pass.blended ? of_pass.blend : of_pass.pixel));
        for (int record = pass.repetitions; record < 3 * pass.repetitions; ++record)
          frame.objects[static_cast<size_t>(pass.record + record * stride) + lower::object_word::program] = program;
      }
    }
  }
  const bool is_same = objects_before.size() == frame.objects.size() && frame.revisions.objects != 0 &&
                       std::memcmp(objects_before.data(), frame.objects.data(), frame.objects.size() * sizeof(float)) == 0;
  if (!is_same) frame.revisions.objects = next_revision();
}

}  // namespace isoshade::render
