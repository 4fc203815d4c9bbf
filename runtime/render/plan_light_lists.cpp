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

namespace assume = interface::assume;

/// Interpolated values exceed those of vertices by rounding; coordinates in view space are differences of others.
constexpr float limit = static_cast<float>(assume::limit) / 8;

bool lie_within(std::span<const float> words, double low, double high) {
  return std::ranges::all_of(words, [&](float word) { return word >= low && word <= high; });
}

/// Whether the vertices of a mesh are as `isoshade check` assumes, but for corner normals, on which no light depends.
bool has_ordinary_vertices(const StoredMesh& mesh, std::span<const float> vertices) {
  namespace word = lower::vertex_word;
  constexpr double most_coordinate = assume::texture_coordinate.hi / 2, most_color = assume::color.hi / 2;
  for (const MeshPart& part : mesh.parts) {
    for (size_t v = 0; v < part.vertex_count; ++v) {
      const std::span vertex = vertices.subspan((part.first_vertex + v) * word::stride, word::stride);
      if (!lie_within(vertex.first(word::corner_normals), -double{limit}, limit) ||
          !lie_within(vertex.subspan(word::texcoord, 2), -most_coordinate, most_coordinate) ||
          !lie_within(vertex.subspan(word::texcoord1, 2), -most_coordinate, most_coordinate) ||
          !lie_within(vertex.subspan(word::color, 4), assume::color.lo, most_color))
        return false;
    }
  }
  return true;
}

}  // namespace

/// Whether all numbers that programs may read of a copy are as `isoshade check` assumes, see prove::BlackLights.
bool Planner::is_ordinary(const PlacedCopy& copy) const {
  namespace word = lower::object_word;
  const size_t passes =
      plan_.effects[effect_of_object_[copy.object]].passes.size() * parameters_[copy.object].size();
  // Behind them lies what is computed of them.
  const auto words = static_cast<size_t>(record_words(copy.object)) - plan_.effects[effect_of_object_[copy.object]].draw_words;
  for (size_t p = copy.first_pass; p < copy.first_pass + passes; ++p) {
    const PlacedPass& pass = placed_.passes[p];
    if (pass.repetitions == 0) continue;
    const std::span record = std::span(plan_.frame.objects).subspan(static_cast<size_t>(pass.record), words);
    if (!lie_within(record.first(word::program), -double{limit}, limit) ||
        !lie_within(record.subspan(word::parameters), -assume::limit, assume::limit))
      return false;
  }
  return true;
}

/// The lights that are not black, and of these those that reach a copy.
Planner::LightsOfCopy Planner::lights_of(const PlacedCopy& copy) const {
  const size_t count = scene_->lights.size();
  LightsOfCopy lights;
  const StoredMesh& mesh = plan_.meshes[mesh_of_object_[copy.object]];
  const ReachBox box = box_around(mesh.low, mesh.high, copy.model);
  for (size_t i = 0; i < count; ++i) {
    constexpr int stride = lower::light_word::stride;
    const LightRecord record = std::span(plan_.frame.lights).subspan(i * stride).first<stride>();
    lights.shining.push_back(!is_black(record));
    lights.reaching.push_back(lights.shining[i] && reaches(record, box));
  }
  return lights;
}

void Planner::list_lights() {
  namespace word = lower::object_word;
  const auto has_lists = [](const driver::Effect& effect) {
    return std::ranges::any_of(effect.passes, &driver::EffectPass::black_lights_add_nothing);
  };
  if (std::ranges::none_of(plan_.effects, has_lists)) return;
  backends::Frame& frame = plan_.frame;
  const size_t count = scene_->lights.size(), first = frame.lights.size();
  const std::vector<bool> all(count, true);
  LightLists lists{.lights = frame.lights};
  const glm::vec3 eye = glm::abs(scene_->camera.position);
  lists.is_eye_ordinary = std::max({eye.x, eye.y, eye.z}) <= limit;
  if (lists.is_eye_ordinary == light_lists_.is_eye_ordinary &&
      light_lists_.objects == frame.revisions.objects && same_bits(lists.lights, light_lists_.lights)) {
    frame.lights.insert(frame.lights.end(), light_lists_.words.begin(), light_lists_.words.end());
    plan_.stats.skips.insert(plan_.stats.skips.end(), light_lists_.skips.begin(), light_lists_.skips.end());
    plan_.stats.left_out_lights = light_lists_.left_out;
    return;
  }

  if (!has_ordinary_texels_)
    has_ordinary_texels_ =
        lie_within(std::span(frame.texels).first(texels_of_textures_), assume::color.lo, assume::color.hi);
  if (vertices_of_ordinary_ != frame.revisions.vertices) {
    vertices_of_ordinary_ = frame.revisions.vertices;
    has_ordinary_mesh_.clear();
    for (const StoredMesh& mesh : plan_.meshes)
      has_ordinary_mesh_.push_back(has_ordinary_vertices(mesh, frame.vertices));
  }
  const bool may_leave_out = lists.is_eye_ordinary && *has_ordinary_texels_;
  struct Part {
    std::vector<LightsOfCopy> copies;
  };
  const auto parts = in_parts<Part>(placed_.copies.size(), [&](size_t i, Part& part) {
    const PlacedCopy& copy = placed_.copies[i];
    const bool leaves_out = may_leave_out && has_lists(plan_.effects[effect_of_object_[copy.object]]) &&
                            has_ordinary_mesh_[mesh_of_object_[copy.object]] && is_ordinary(copy);
    part.copies.push_back(leaves_out ? lights_of(copy) : LightsOfCopy{all, all});
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
        if (!pass.black_lights_add_nothing || placed.repetitions == 0) continue;
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
