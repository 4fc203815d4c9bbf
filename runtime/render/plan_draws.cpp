// SPDX-License-Identifier: Apache-2.0
// The views of a frame and what each of them draws.
#include <algorithm>
#include <utility>

#include "compiler/lower/frame_layout.h"
#include "compiler/lower/shadow.h"
#include "compiler/support/visible.h"
#include "runtime/render/planner.h"
#include "runtime/render/visibility.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/placement.h"

namespace isoshade::render {

using scene::Instance;
using scene::Object;
using support::quote;

int Planner::repetitions_of(const driver::Effect& effect, const driver::EffectPass& pass,
                            std::span<const float> parameters) const {
  return options_.disabled ? effect.parameters.most_repetitions(pass.repeat)
                           : effect.parameters.repetitions(pass.repeat, parameters);
}

/// Places one pass after the other, each over all parts.
void Planner::place_copy(size_t o, const Copy& copy, std::vector<PassSkips>& skipped) {
  std::vector<std::vector<float>> parameters;
  for (const ParameterValues& part : parameters_[o])
    parameters.push_back(part.words(copy.instance, [&](int number) { return textures_.record(number); }));
  for (size_t p = 0; p < skipped.size(); ++p) place_pass(o, p, copy, parameters, skipped[p]);
}

void Planner::place_pass(size_t o, size_t p, const Copy& copy, std::span<const std::vector<float>> parameters,
                         PassSkips& skipped) {
  const Object& object = scene_.objects[o];
  const driver::Effect& effect = plan_.effects[effect_of_object_[o]];
  const driver::EffectPass& pass = effect.passes[p];
  const std::vector<MeshPart>& parts = plan_.meshes[mesh_of_object_[o]].parts;
  const glm::vec3& scale = object.transform.scale;
  const bool mirrored = ((scale.x < 0) != (scale.y < 0)) != (scale.z < 0);
  const auto is_blended = [&](const std::vector<float>& values) {
    return pass.blend && !effect.parameters.is_off(pass.blended, values);
  };
  const auto may_see = [&](size_t v, bool blended) {
    const bool casts = object.casts_shadow && (blended ? pass.casts_blended_shadow : pass.casts_shadow);
    return (casts || !is_shadow_map(v)) && (!copy.views[v].outside || pass.moves_vertices);
  };

  std::vector<int> counts;  // of each part; 0 where nothing is drawn
  bool left_out = false;
  for (const std::vector<float>& values : parameters) {
    bool unseen = true;
    for (size_t v = 0; v < copy.views.size(); ++v) unseen = unseen && !may_see(v, is_blended(values));
    const bool disabled = !options_.disabled && effect.parameters.is_off(pass.enabled, values);
    if (disabled) ++skipped.disabled;
    left_out |= unseen && !disabled;
    counts.push_back(disabled || unseen ? 0 : repetitions_of(effect, pass, values));
    if (counts.back() == 0) continue;
    if (pass.cutout && !effect.parameters.cuts_out(pass.cutoff, values)) ++skipped.uncut;
    if (counts.back() > 1) ++plan_.stats.repeated;
  }
  if (left_out) ++skipped.unseen;

  const int most = *std::ranges::max_element(counts);
  for (int repetition = 0; repetition < most; ++repetition) {
    for (size_t part = 0; part < parts.size(); ++part) {
      if (repetition >= counts[part]) continue;
      const std::vector<float>& values = parameters[part];
      PassPrograms programs = programs_of_effect_[effect_of_object_[o]][p];
      const bool blended = is_blended(values);
      if (blended) programs.pixel = programs.blend;
      std::vector<float> words = values;
      if (effect.reads_previous) append_columns(place_of(before(o), copy.instance).model, words);
      backends::Draw draw = make_draw(copy.place, programs, parts[part], {repetition, counts[part]}, words);
      draw.state = pass.state;
      draw.blended = blended;
      if (effect.parameters.is_on(pass.double_sided, values)) draw.state.cull = interface::Cull::none;
      draw.mirrored = mirrored;
      draw.cutout = pass.cutout && effect.parameters.cuts_out(pass.cutoff, values);
      plan_.origins.push_back({draw.object, static_cast<uint32_t>(o), &pass});
      const int64_t before = plan_.stats.draws;
      for (size_t v = 0; v < copy.views.size(); ++v) {
        if (!may_see(v, blended)) continue;
        backends::Draw seen = draw;
        if (is_shadow_map(v)) {
          seen.state = {};
          seen.state.cull = interface::Cull::none;
          seen.blended = false;
        }
        place_draw(seen, copy.views[v], v);
        const bool writes_depth = !blended || pass.state.depth_write == interface::DepthWrite::on;
        if (plan_.motion && v + 1 == copy.views.size() && writes_depth) {
          seen.projected = copy.views[v].matrix;
          place_motion(o, copy, part, seen, copy.views[v]);
        }
      }
      if (counts[part] > 1) plan_.stats.repetitions += plan_.stats.draws - before;
    }
  }
}

backends::Draw Planner::make_draw(const ObjectTransforms& place, const PassPrograms& programs,
                                  const MeshPart& part, Repetition repetition,
                                  const std::vector<float>& parameters) {
  const size_t first = plan_.frame.objects.size();
  append_object(place, programs.pixel, repetition, parameters, plan_.frame.objects);
  backends::Draw draw;
  draw.vertex_program = programs.vertex;
  draw.pixel_program = programs.pixel;
  draw.object = static_cast<int>(first);
  draw.first_vertex = part.first_vertex;
  draw.vertex_count = part.vertex_count;
  draw.indices = part.indices;
  return draw;
}

void Planner::place_draw(backends::Draw draw, Appearance& appearance, size_t v) {
  if (draw.blended && has_opaque_view_ && v == opaque_view()) return;
  backends::View& view = plan_.frame.views[v];
  if (appearance.matrix < 0) appearance.matrix = append_matrix(appearance.projected, view.words);
  draw.projected = appearance.matrix;
  if (draw.blended)
    blended_[v].push_back({appearance.nearness, draw});
  else
    view.draws.push_back(draw);
  ++plan_.stats.draws;
  plan_.stats.vertices += draw.vertex_count;
  plan_.stats.triangles += static_cast<int64_t>(draw.indices.size() / 3);
}

void Planner::place_object(size_t o) {
  const Object& object = scene_.objects[o];
  const StoredMesh& mesh = plan_.meshes[mesh_of_object_[o]];
  const int64_t count = scene::instance_count(object);
  const driver::Effect& effect = plan_.effects[effect_of_object_[o]];
  std::vector<PassSkips> skipped(effect.passes.size());
  std::vector<Appearance> views(cameras_.size());
  for (int64_t i = 0; i < count; ++i) {
    const Instance instance = scene::instance(object, i);
    const ObjectTransforms place = place_of(object, instance);
    for (size_t v = 0; v < views.size(); ++v) {
      const backends::Target& target = plan_.frame.views[v].target;
      const glm::mat4 projected = scene::multiply(cameras_[v].projection, place.model);
      const glm::vec4 middle(0.5f * mesh.low + 0.5f * mesh.high, 1.0f);
      views[v] = {projected,
                  options_.skip && outside_view(mesh.low, mesh.high, projected, target.width, target.height),
                  scene::multiply(cameras_[v].view, scene::multiply(place.model, middle)).z};
    }
    place_copy(o, {instance, place, views}, skipped);
  }
  plan_.stats.copies += count;
  report_skips(object, effect, static_cast<int64_t>(mesh.parts.size()), skipped, plan_.stats.skips);
}

void Planner::add_view(const scene::Camera& camera, const scene::View& view, int width, int height,
                       backends::Target target) {
  cameras_.push_back(view);
  blended_.emplace_back();
  backends::View& added = plan_.frame.views.emplace_back();
  added.target = std::move(target);
  added.words = view_words(camera, view, width, height);
}

std::vector<Hull> Planner::find_hulls(const scene::View& picture) const {
  // Of a mesh whose passes move vertices; shadows may miss a surface that an author moves further.
  constexpr float moved = 0.5f;
  std::vector<Hull> hulls;
  for (size_t o = 0; o < scene_.objects.size(); ++o) {
    const Object& object = scene_.objects[o];
    const StoredMesh& mesh = plan_.meshes[mesh_of_object_[o]];
    const std::vector<driver::EffectPass>& passes = plan_.effects[effect_of_object_[o]].passes;
    const bool casts = object.casts_shadow && std::ranges::any_of(passes, &driver::EffectPass::casts_shadow);
    const bool moves = std::ranges::any_of(passes, &driver::EffectPass::moves_vertices);
    const bool moves_what_casts = casts && std::ranges::any_of(passes, [](const driver::EffectPass& pass) {
      return pass.casts_shadow && pass.moves_vertices;
    });
    const bool receives = object.receives_shadow && std::ranges::any_of(passes, &driver::EffectPass::receives_shadow);
    const int64_t count = scene::instance_count(object);
    for (int64_t i = 0; i < count; ++i) {
      const glm::mat4 model = scene::model_matrix(object, scene::instance(object, i));
      const glm::mat4 projected = scene::multiply(picture.projection, model);
      const bool is_seen = moves || !outside_view(mesh.low, mesh.high, projected, scene::max_size, scene::max_size);
      hulls.push_back({corners_of(mesh.low, mesh.high, moves ? moved : 0.0f, model), casts, moves_what_casts,
                       object.receives_shadow && is_seen, receives && is_seen, moves});
    }
  }
  return hulls;
}

void Planner::note_largest_shadow(const scene::Light& light, size_t maps) {
  if (maps == 0) return;
  const auto side = static_cast<uint64_t>(light.shadow->size);
  const uint64_t texels = maps * side * side;
  shadow_texels_ += texels;
  if (texels <= most_shadow_texels_) return;
  most_shadow_texels_ = texels;
  const std::string size = std::to_string(side);
  plan_.frame.largest_shadow = {"the shadow of light " + quote(light.name) + ", " + std::to_string(maps) +
                                    (maps == 1 ? " map of " : " maps of ") + size + " x " + size + " pixels",
                                light.shadow_where};
}

void Planner::add_lights(const scene::View& picture) {
  namespace word = lower::light_word;
  const bool any = std::ranges::any_of(scene_.lights, [](const scene::Light& light) { return light.shadow.has_value(); });
  const std::vector<Hull> hulls = any ? find_hulls(picture) : std::vector<Hull>{};
  backends::Frame& frame = plan_.frame;
  for (const scene::Light& light : scene_.lights) {
    auto record = scene::light_record(light);
    const bool is_black = light.intensity == 0 || light.color == glm::vec3(0);
    const std::vector<ShadowMap> maps =
        light.shadow && !is_black ? shadow_maps(light, hulls, picture) : std::vector<ShadowMap>{};
    if (light.shadow && maps.empty())
      plan_.stats.skips.push_back(
          {"shadow of " + light.name, is_black ? "the light is black" : "it darkens nothing that is seen"});
    note_largest_shadow(light, maps.size());
    if (!maps.empty()) {
      const size_t place = frame.views.size() + (has_opaque_view_ ? 1 : 0);
      record[word::shadow] = static_cast<float>(1 + place * lower::shadow_map_records);
      record[word::shadow_maps] = static_cast<float>(maps.size());
      record[word::softness] = scene::canonical(light.shadow->softness);
    }
    for (const ShadowMap& map : maps) {
      const int size = light.shadow->size;
      add_view(map.camera, map.view, size, size, {"the shadow of light " + quote(light.name), size, size, false});
      frame.views.back().depth_bias = map.bias;
      widen_rays(frame.views.back().words, map.margin);
    }
    frame.lights.insert(frame.lights.end(), record.begin(), record.end());
  }
}

/// The shadow maps; then what is opaque if a pass reads that, with one sample a pixel; and last the picture.
void Planner::add_views(int width, int height, int side) {
  const auto reads_scene = [](const driver::Effect& effect) {
    return std::ranges::any_of(effect.passes, &driver::EffectPass::reads_scene);
  };
  has_opaque_view_ = std::ranges::any_of(plan_.effects, reads_scene);
  const scene::View camera = scene::make_view(scene_.camera, width, height);
  std::vector<backends::View>& views = plan_.frame.views;
  add_lights(camera);
  shadow_maps_ = views.size();
  if (has_opaque_view_) add_view(scene_.camera, camera, width, height, {"what is opaque", width, height});
  const uint64_t opaque_words = uint64_t{5} * static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
  if (has_opaque_view_ && shadow_texels_ < opaque_words) plan_.frame.largest_shadow = {};
  add_view(scene_.camera, camera, width, height, {"the picture", side * width, side * height});
  for (size_t v = shadow_maps_; v < views.size(); ++v) {
    // Programs find what is opaque at the first place, and all of them find the shadow maps at the same ones behind it.
    if (has_opaque_view_) views[v].reads.push_back(v == opaque_view() ? backends::View::nothing : opaque_view());
    for (size_t map = 0; map < shadow_maps_; ++map) views[v].reads.push_back(map);
    for (size_t i = 0; i < 4; ++i) views[v].background[i] = scene::canonical(scene_.background[i]);
  }
}

void Planner::append_blended() {
  for (size_t v = 0; v < blended_.size(); ++v) {
    if (scene_.sort == scene::Sort::back_to_front)
      std::ranges::stable_sort(blended_[v], {}, &BlendedDraw::nearness);
    for (const BlendedDraw& blended : blended_[v]) plan_.frame.views[v].draws.push_back(blended.draw);
  }
}

}  // namespace isoshade::render
