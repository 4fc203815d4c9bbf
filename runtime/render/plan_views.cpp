// SPDX-License-Identifier: Apache-2.0
// The views of a frame and what each of them draws.
#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <utility>

#include "compiler/lower/frame_layout.h"
#include "runtime/render/planner.h"
#include "runtime/render/samples.h"
#include "runtime/render/visibility.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/placement.h"

namespace isoshade::render {

using scene::Object;

/// The draw of a repetition of a pass over a part, in no view yet.
backends::Draw Planner::draw_of(const PlacedCopy& copy, size_t p, size_t part, int repetition) const {
  const size_t o = copy.object, e = effect_of_object_[o];
  const driver::EffectPass& pass = plan_.effects[e].passes[p];
  const PassPrograms& programs = programs_of_effect_[e][p];
  const PlacedPass& placed = placed_.passes[copy.first_pass + p * parameters_[o].size() + part];
  const MeshPart& mesh = plan_.meshes[mesh_of_object_[o]].parts[part];
  const glm::vec3& scale = scene_->objects[o].transform.scale;
  backends::Draw draw;
  draw.vertex_program = programs.vertex;
  draw.pixel_program = placed.blended ? programs.blend : programs.pixel;
  draw.object = placed.record + repetition * record_words(o);
  draw.first_vertex = mesh.first_vertex;
  draw.vertex_count = mesh.vertex_count;
  draw.indices = mesh.indices;
  draw.state = pass.state;
  if (placed.double_sided) draw.state.cull = interface::Cull::none;
  draw.mirrored = ((scale.x < 0) != (scale.y < 0)) != (scale.z < 0);
  draw.cutout = placed.cutout;
  draw.blended = placed.blended;
  return draw;
}

void Planner::place_draw(backends::Draw draw, size_t v, Seen& seen) const {
  if (draw.blended && has_opaque_view_ && v == opaque_view()) return;
  Seen::OfView& view = seen.views[v];
  Appearance& appearance = seen.appearances[v];
  if (appearance.matrix < 0) appearance.matrix = append_matrix(appearance.projected, view.words);
  draw.projected = appearance.matrix;
  if (draw.blended)
    view.blended.push_back({appearance.nearness, draw});
  else
    view.draws.push_back(draw);
  ++seen.stats.draws;
  seen.stats.vertices += draw.vertex_count;
  seen.stats.triangles += static_cast<int64_t>(draw.indices.size() / 3);
}

/// Adds one pass over a copy to the views that may see it: one repetition after the other, each over all parts.
void Planner::see_pass(const PlacedCopy& copy, size_t number, size_t p, Seen& seen) const {
  const Object& object = scene_->objects[copy.object];
  const driver::Effect& effect = plan_.effects[effect_of_object_[copy.object]];
  const driver::EffectPass& pass = effect.passes[p];
  PassSkips& skipped = seen.skipped[copy.object][p];
  const size_t parts = parameters_[copy.object].size(), views = cameras_.size();
  const PlacedPass* const placed = &placed_.passes[copy.first_pass + p * parts];
  const auto may_see = [&](size_t v, bool blended) {
    const bool casts = object.casts_shadow && (blended ? pass.casts_blended_shadow : pass.casts_shadow);
    return (casts || !is_shadow_map(v)) && (!seen.appearances[v].outside || pass.moves_vertices);
  };
  const auto is_seen = [&](bool blended) {
    for (size_t v = 0; v < views; ++v)
      if (may_see(v, blended)) return true;
    return false;
  };

  int most = 0;  // repetitions
  bool left_out = false;
  for (size_t part = 0; part < parts; ++part) {
    const bool disabled = placed[part].repetitions == 0;
    if (disabled) {
      ++skipped.disabled;
    } else if (!is_seen(placed[part].blended)) {
      left_out = true;
    } else {
      most = std::max(most, placed[part].repetitions);
      if (pass.cutout && !placed[part].cutout) ++skipped.uncut;
      if (placed[part].repetitions > 1) ++seen.stats.repeated;
    }
  }
  if (left_out) ++skipped.unseen;

  int matrix_before = -1;
  for (int repetition = 0; repetition < most; ++repetition) {
    for (size_t part = 0; part < parts; ++part) {
      if (repetition >= placed[part].repetitions) continue;
      const backends::Draw draw = draw_of(copy, p, part, repetition);
      const int64_t before = seen.stats.draws;
      for (size_t v = 0; v < views; ++v) {
        if (!may_see(v, draw.blended)) continue;
        backends::Draw shown = draw;
        if (is_shadow_map(v)) {
          shown.state = {};
          shown.state.cull = interface::Cull::none;
          shown.blended = false;
        }
        place_draw(shown, v, seen);
        if (v + 1 < views || !placed[part].moves) continue;
        shown.projected = seen.appearances[v].matrix;
        see_motion(placed[part], number, repetition, shown, seen.appearances[v].nearness, matrix_before, seen);
      }
      if (placed[part].repetitions > 1) seen.stats.repetitions += seen.stats.draws - before;
    }
  }
}

void Planner::see_copy(size_t number, Seen& seen) const {
  const PlacedCopy& copy = placed_.copies[number];
  const Object& object = scene_->objects[copy.object];
  const StoredMesh& mesh = plan_.meshes[mesh_of_object_[copy.object]];
  const std::vector<driver::EffectPass>& passes = plan_.effects[effect_of_object_[copy.object]].passes;
  seen.views.resize(cameras_.size());
  seen.appearances.assign(cameras_.size(), {});
  const bool sorts = std::ranges::any_of(passes, [](const driver::EffectPass& pass) { return pass.blend.has_value(); });
  for (size_t v = 0; v < cameras_.size(); ++v) {
    if (is_shadow_map(v) && !object.casts_shadow) continue;
    const backends::Target& target = plan_.frame.views[v].target;
    Appearance& appearance = seen.appearances[v];
    appearance.projected = scene::multiply(cameras_[v].projection, copy.model);
    appearance.outside = skips(interface::Skip::objects) && outside_view(mesh.low, mesh.high, appearance.projected, target.width, target.height);
    if (!sorts) continue;
    const glm::vec4 middle(0.5f * mesh.low + 0.5f * mesh.high, 1.0f);
    appearance.nearness = scene::multiply(cameras_[v].view, scene::multiply(copy.model, middle)).z;
  }
  std::vector<PassSkips>& skipped = seen.skipped[copy.object];
  skipped.resize(passes.size());
  for (size_t p = 0; p < passes.size(); ++p) see_pass(copy, number, p, seen);
  ++seen.stats.copies;
}

/// Adds what some copies add, behind what those before them have added.
void Planner::append(Seen& seen, Seen& all) {
  const auto shift = [](auto& draws, size_t words) {
    for (auto& draw : draws) draw.projected += static_cast<int>(words);
  };
  const auto append_to = [](auto& to, auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  const size_t picture = cameras_.size() - 1, words_of_picture = plan_.frame.views[picture].words.size();
  for (size_t v = 0; v < seen.views.size(); ++v) {
    Seen::OfView& from = seen.views[v];
    backends::View& to = plan_.frame.views[v];
    shift(from.draws, to.words.size());
    for (BlendedDraw& blended : from.blended) blended.draw.projected += static_cast<int>(to.words.size());
    append_to(to.words, from.words);
    append_to(to.draws, from.draws);
    append_to(all.views[v].blended, from.blended);
  }
  if (plan_.motion) {
    std::vector<float>& words = plan_.motion->before.words;
    for (auto* moved : {&seen.moved, &seen.moved_blended}) {
      for (MovedDraw& draw : *moved) {
        draw.now.projected += static_cast<int>(words_of_picture);
        draw.before.projected += static_cast<int>(words.size());
      }
    }
    append_to(words, seen.words_before);
    append_to(all.moved, seen.moved);
    append_to(all.moved_blended, seen.moved_blended);
  }
  PlanStats& stats = plan_.stats;
  stats.copies += seen.stats.copies;
  stats.draws += seen.stats.draws;
  stats.vertices += seen.stats.vertices;
  stats.triangles += seen.stats.triangles;
  stats.repeated += seen.stats.repeated;
  stats.repetitions += seen.stats.repetitions;
  for (const auto& [object, passes] : seen.skipped) {
    std::vector<PassSkips>& sums = all.skipped[object];
    sums.resize(passes.size());
    for (size_t p = 0; p < passes.size(); ++p) {
      sums[p].unseen += passes[p].unseen;
      sums[p].disabled += passes[p].disabled;
      sums[p].uncut += passes[p].uncut;
    }
  }
  seen = {};
}

void Planner::add_view(const scene::Camera& camera, const scene::View& view, int width, int height,
                       backends::Target target) {
  cameras_.push_back(view);
  backends::View& added = plan_.frame.views.emplace_back();
  added.target = std::move(target);
  added.words = view_words(camera, view, width, height);
}

/// The shadow maps; then what is opaque if a pass reads that, with one sample a pixel; and last the picture.
void Planner::add_views(int width, int height) {
  const auto reads_scene = [](const driver::Effect& effect) {
    return std::ranges::any_of(effect.passes, &driver::EffectPass::reads_scene);
  };
  has_opaque_view_ = std::ranges::any_of(plan_.effects, reads_scene);
  const int side = samples_each_way(scene_->samples);
  const scene::View camera = scene::make_view(scene_->camera, width, height);
  std::vector<backends::View>& views = plan_.frame.views;
  add_lights(camera);
  shadow_maps_ = views.size();
  if (has_opaque_view_) add_view(scene_->camera, camera, width, height, {"what is opaque", width, height});
  const uint64_t opaque_words = uint64_t{5} * static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
  if (has_opaque_view_ && shadow_texels_ < opaque_words) plan_.frame.largest_shadow = {};
  add_view(scene_->camera, camera, width, height, {"the picture", side * width, side * height});
  for (size_t v = shadow_maps_; v < views.size(); ++v) {
    // Programs find what is opaque at the first place, and all of them find the shadow maps at the same ones behind it.
    if (has_opaque_view_) views[v].reads.push_back(v == opaque_view() ? backends::View::nothing : opaque_view());
    for (size_t map = 0; map < shadow_maps_; ++map) views[v].reads.push_back(map);
    for (size_t i = 0; i < 4; ++i) views[v].background[i] = scene::canonical(scene_->background[i]);
  }
}

void Planner::append_blended(Seen& all) {
  for (size_t v = 0; v < all.views.size(); ++v) {
    std::vector<BlendedDraw>& draws = all.views[v].blended;
    if (scene_->sort == scene::Sort::back_to_front) std::ranges::stable_sort(draws, {}, &BlendedDraw::nearness);
    for (const BlendedDraw& blended : draws) plan_.frame.views[v].draws.push_back(blended.draw);
  }
}

bool same_bits(std::span<const float> a, std::span<const float> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

namespace {

bool is_same(const backends::Draw& a, const backends::Draw& b) {
  const auto& [vertex_program, pixel_program, object, projected, first_vertex, vertex_count, indices, state, mirrored, cutout,
               blended] = a;
  return vertex_program == b.vertex_program && pixel_program == b.pixel_program && object == b.object &&
         projected == b.projected && first_vertex == b.first_vertex && vertex_count == b.vertex_count &&
         indices.data() == b.indices.data() && indices.size() == b.indices.size() && state == b.state &&
         mirrored == b.mirrored && cutout == b.cutout && blended == b.blended;
}

bool is_same(const backends::View& a, const backends::View& b) {
  const auto& [target, words, frame, draws, reads, background, depth_bias, revision] = a;
  return target == b.target && same_bits(words, b.words) && same_bits(frame, b.frame) &&
         std::ranges::equal(draws, b.draws, [](const auto& x, const auto& y) { return is_same(x, y); }) &&
         reads == b.reads && same_bits(background, b.background) &&
         same_bits(std::array{depth_bias.slope, depth_bias.relative, depth_bias.constant},
                   std::array{b.depth_bias.slope, b.depth_bias.relative, b.depth_bias.constant});
}

}  // namespace

/// Keeps the numbers of what is as it was in the frame before.
void Planner::number_revisions(const std::vector<backends::View>& former) {
  backends::Frame& frame = plan_.frame;
  backends::Revisions& revisions = frame.revisions;
  const auto keep_if = [](bool same, uint64_t& revision) {
    if (!same || revision == 0) revision = next_revision();
  };
  keep_if(frame.programs == programs_before_ && frame.cutouts == cutouts_before_, revisions.programs);
  programs_before_ = frame.programs;
  cutouts_before_ = frame.cutouts;
  keep_if(same_bits(frame.lights, lights_before_), revisions.lights);
  keep_if(same_bits(frame.frame, frame_before_), revisions.frame);
  for (size_t v = 0; v < frame.views.size(); ++v) {
    const bool is_kept = v < former.size() && is_same(frame.views[v], former[v]);
    frame.views[v].revision = is_kept ? former[v].revision : next_revision();
  }
}

/// Everything that depends on the camera or the time. False after an error.
bool Planner::make_views(int width, int height) {
  backends::Frame& frame = plan_.frame;
  const std::vector<backends::View> former = std::exchange(frame.views, {});
  lights_before_ = std::exchange(frame.lights, {});
  frame_before_ = std::exchange(frame.frame, {});
  frame.largest_shadow = {};
  frame.light_count = static_cast<int>(scene_->lights.size());
  cameras_.clear();
  shadow_maps_ = 0;
  shadow_texels_ = most_shadow_texels_ = 0;
  plan_.samples = scene_->samples;
  plan_.stats.skips = unread_images(plan_.effects);
  if (scene_->environment && !has_blurred_maps_)
    plan_.stats.skips.push_back({interface::Skip::textures, "blurred maps of the environment", "nothing reads them"});

  const lanes::FpGuard guard;
  frame.frame = frame_now_;
  add_views(width, height);
  list_lights();
  begin_motion(width, height);
  Seen all;
  all.views.resize(cameras_.size());
  auto parts = in_parts<Seen>(placed_.copies.size(), [&](size_t i, Seen& seen) { see_copy(i, seen); });
  for (Seen& part : parts) append(part, all);
  append_blended(all);
  finish_motion(all);
  for (size_t o = 0; o < scene_->objects.size(); ++o)
    report_skips(scene_->objects[o], plan_.effects[effect_of_object_[o]], static_cast<int64_t>(parameters_[o].size()),
                 all.skipped[static_cast<uint32_t>(o)], plan_.stats.skips);
  number_revisions(former);
  auto posts =
      plan_posts(*scene_, posts_, width, height, options_.compiler.skips, plan_.stats.skips, *diagnostics_);
  if (!posts) return false;
  plan_.posts = *std::move(posts);
  if (plan_.motion && !plan_.posts.reads_motion()) plan_.motion.reset();
  return true;
}

}  // namespace isoshade::render
