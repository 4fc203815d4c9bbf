// SPDX-License-Identifier: Apache-2.0
// Which lights each copy of an object sums up: those that may add something to what it shows.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "compiler/lower/frame_layout.h"
#include "runtime/render/light_reach.h"
#include "runtime/render/planner.h"

namespace isoshade::render {
namespace {

/// Boxes beyond this are not looked at: squares of distances in them may not be finite.
constexpr double limit = 0x1p60;

bool lies_within(const ReachBox& box) {
  const auto is_near = [](double at) { return std::abs(at) <= limit; };
  return std::ranges::all_of(box.low, is_near) && std::ranges::all_of(box.high, is_near);
}

}  // namespace

/// The lights that are not black, and of these those that reach a copy.
Planner::LightsOfCopy Planner::lights_of(const PlacedCopy& copy) const {
  const size_t count = scene_->lights.size();
  LightsOfCopy lights;
  const StoredMesh& mesh = plan_.meshes[mesh_of_object_[copy.object]];
  const ReachBox box = box_around(mesh.low, mesh.high, copy.model);
  const bool is_known = lies_within(box);
  for (size_t i = 0; i < count; ++i) {
    constexpr int stride = lower::light_word::stride;
    const LightRecord record = std::span(plan_.frame.lights).subspan(i * stride).first<stride>();
    lights.shining.push_back(!is_black(record));
    lights.reaching.push_back(lights.shining[i] && (!is_known || reaches(record, box)));
  }
  return lights;
}

void Planner::list_lights() {
  namespace word = lower::object_word;
  if (std::ranges::none_of(plan_.effects, &driver::Effect::lists_lights)) return;
  backends::Frame& frame = plan_.frame;
  const size_t count = scene_->lights.size(), first = frame.lights.size();
  const std::vector<bool> all(count, true);
  LightLists lists{.lights = frame.lights};
  if (light_lists_.objects == frame.revisions.objects && same_bits(lists.lights, light_lists_.lights)) {
    frame.lights.insert(frame.lights.end(), light_lists_.words.begin(), light_lists_.words.end());
    plan_.stats.skips.insert(plan_.stats.skips.end(), light_lists_.skips.begin(), light_lists_.skips.end());
    plan_.stats.left_out_lights = light_lists_.left_out;
    return;
  }

  struct Part {
    std::vector<LightsOfCopy> copies;
  };
  const auto parts = in_parts<Part>(placed_.copies.size(), [&](size_t i, Part& part) {
    const PlacedCopy& copy = placed_.copies[i];
    const bool has_list = plan_.effects[effect_of_object_[copy.object]].lists_lights;
    part.copies.push_back(has_list ? lights_of(copy) : LightsOfCopy{all, all});
  });

  std::map<std::vector<bool>, size_t> list_at;  ///< word in Frame::lights
  const auto find_list = [&](const std::vector<bool>& lights) {
    const auto [found, is_new] = list_at.try_emplace(lights, first + lists.words.size());
    // A word of a record holds whole numbers up to here. There is always room for the list of all, which comes first.
    constexpr size_t most_words = size_t{1} << 24;
    if (is_new && first + lists.words.size() + count > most_words)
      return list_at.erase(found), list_at.at(all);
    if (is_new)
      for (size_t i = 0; i < count; ++i)
        if (lights[i]) lists.words.push_back(static_cast<float>(i * lower::light_word::stride));
    return found->second;
  };
  find_list(all);
  bool has_changed = false;
  const auto put = [&](size_t at, size_t value) {
    float& to = frame.objects[at];
    has_changed = has_changed || to != static_cast<float>(value);
    to = static_cast<float>(value);
  };
  std::vector<int64_t> left_out(scene_->objects.size()), asked(scene_->objects.size());
  size_t number = 0;
  for (const Part& part : parts) {
    for (const LightsOfCopy& lights : part.copies) {
      const PlacedCopy& copy = placed_.copies[number++];
      const driver::Effect& effect = plan_.effects[effect_of_object_[copy.object]];
      const size_t material_parts = parameters_[copy.object].size();
      for (size_t p = 0; p < effect.passes.size() * material_parts; ++p) {
        const driver::EffectPass& pass = effect.passes[p / material_parts];
        const PlacedPass& placed = placed_.passes[copy.first_pass + p];
        if (!effect.lists_lights || placed.repetitions == 0) continue;
        const std::vector<bool>& of_pass = pass.moves_vertices ? lights.shining : lights.reaching;
        const size_t list = find_list(of_pass);
        const bool is_all = list == first;
        const auto listed = is_all ? static_cast<int64_t>(count) : std::ranges::count(of_pass, true);
        for (int repetition = 0; repetition < placed.repetitions; ++repetition) {
          const auto record = static_cast<size_t>(placed.record + repetition * record_words(copy.object));
          put(record + word::first_light, list);
          put(record + word::light_count, static_cast<size_t>(listed));
        }
        if (!pass.sums_lights) continue;
        asked[copy.object] += static_cast<int64_t>(count) * placed.repetitions;
        left_out[copy.object] += (static_cast<int64_t>(count) - listed) * placed.repetitions;
      }
    }
  }
  if (has_changed) frame.revisions.objects = next_revision();
  for (size_t o = 0; o < left_out.size(); ++o) {
    if (left_out[o] == 0) continue;
    lists.left_out += left_out[o];
    lists.skips.push_back({interface::Skip::lights,
                           std::to_string(left_out[o]) + " of " + std::to_string(asked[o]) + " lights of " +
                               scene_->objects[o].name,
                           "they are black or do not reach it"});
  }
  lists.objects = frame.revisions.objects;
  frame.lights.insert(frame.lights.end(), lists.words.begin(), lists.words.end());
  plan_.stats.skips.insert(plan_.stats.skips.end(), lists.skips.begin(), lists.skips.end());
  plan_.stats.left_out_lights = lists.left_out;
  light_lists_ = std::move(lists);
}

}  // namespace isoshade::render
