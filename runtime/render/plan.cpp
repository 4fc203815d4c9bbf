// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/planner.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <utility>

#include "compiler/lower/frame_layout.h"
#include "compiler/support/visible.h"
#include "runtime/environment/environment.h"
#include "runtime/lanes/lanes.h"
#include "runtime/render/clock.h"
#include "runtime/render/samples.h"
#include "runtime/scene/host_math.h"

namespace isoshade::render {

using scene::Object;
using scene::Scene;
using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

struct Size {
  int width, height;
};
Size size_of(const Scene& scene, const PlanOptions& options) {
  return {options.width > 0 ? options.width : scene.width, options.height > 0 ? options.height : scene.height};
}

}  // namespace

/// Finds whether any program reads the time.
bool Planner::find_time() {
  const auto reads = [](const driver::Program& program) {
    return std::ranges::any_of(program.bindings, [](const interface::Binding& binding) {
      return std::holds_alternative<interface::source::Time>(binding.source);
    });
  };
  const auto effect_reads = [&](const driver::Effect& effect) {
    return std::ranges::any_of(effect.passes, [&](const driver::EffectPass& pass) {
      bool any = false;
      driver::for_each_program(pass, [&](const driver::Program& program) { any = any || reads(program); });
      return any;
    });
  };
  plan_.views_read_time = std::ranges::any_of(plan_.effects, effect_reads);
  return plan_.views_read_time ||
         std::ranges::any_of(plan_.post_documents, [&](const driver::Post& post) { return reads(post.program); });
}

/// Whether the text at `where` may name the file. Files that the user names have no `where`, or one in an argument.
bool Planner::may_read(const std::string& path, const support::Span& where) {
  const check::Library* library = options_.compiler.library;
  return library == nullptr || graph::may_read(path, where, library->files(), *diagnostics_);
}

support::Source Planner::read_document(const std::string& path, const support::Span& where) {
  if (!may_read(path, where)) return nullptr;
  const check::Library* library = options_.compiler.library;
  return graph::read_document(path, library != nullptr ? library->files() : graph::FileRule{}, *diagnostics_,
                              where);
}

std::optional<size_t> Planner::find_mesh(size_t o) {
  const Object& object = scene_->objects[o];
  const bool is_file = object.mesh.kind == scene::MeshKind::file;
  if (is_file && !may_read(object.mesh.file, object.mesh_where)) return std::nullopt;
  return meshes_.find(scene_->objects, o, *diagnostics_);
}

void Planner::note_largest_mesh(const Object& object, const StoredMesh& mesh) {
  uint32_t count = 0;
  for (const MeshPart& part : mesh.parts) count += part.vertex_count;
  if (count <= most_vertices_) return;
  most_vertices_ = count;
  plan_.frame.largest_mesh = {
      "the mesh of " + quote(object.name) + ": " + std::to_string(count) + " vertices", object.mesh_where};
}

std::optional<Planner::PartValues> Planner::resolve_parts(const Object& object, const driver::Effect& effect,
                                                          const StoredMesh& mesh, const FindTexture& find_texture) {
  PartValues parameters;
  for (const MeshPart& part : mesh.parts) {
    const scene::Material* material = part.material ? &*part.material : nullptr;
    const ParameterGiver giver{object.name, object.parameters, object.repeat, material, object.mesh_where};
    auto resolved = ParameterValues::resolve(effect.parameters, giver, find_texture, *diagnostics_);
    if (!resolved) return std::nullopt;  // further parts would report the same again
    parameters.push_back(*std::move(resolved));
  }
  return parameters;
}

/// Of all passes over a part of one copy, in one view.
int64_t Planner::most_draws(const driver::Effect& effect, const ParameterValues& values) const {
  int64_t draws = 0;
  for (const driver::EffectPass& pass : effect.passes) {
    const std::optional<size_t> parameter = options_.disabled ? std::nullopt : pass.repeat.parameter;
    draws += parameter ? static_cast<int64_t>(values.most(effect.parameters.word_of(*parameter)))
                       : effect.parameters.most_repetitions(pass.repeat);
  }
  return draws;
}

Planner::Counts Planner::begin_counting() const {
  size_t views = 1;
  for (const scene::Light& light : scene_->lights) views += shadow_map_count(light);
  return {{"vertices", max_drawn_vertices},
          {"triangles", max_drawn_triangles},
          {"words of object records", max_object_words},
          {"draws, those of shadows too,", max_draws},
          views};
}

bool Planner::count_object(size_t o, Counts& counts) {
  const Object& object = scene_->objects[o];
  const StoredMesh& mesh = plan_.meshes[mesh_of_object_[o]];
  for (size_t part = 0; part < mesh.parts.size(); ++part) {
    const ParameterValues& values = parameters_[o][part];
    const int64_t draws =
        scene::instance_count(object) * most_draws(plan_.effects[effect_of_object_[o]], values);
    counts.draws.total += draws * static_cast<int64_t>(counts.views);
    counts.vertices.total += draws * mesh.parts[part].vertex_count;
    counts.triangles.total += draws * static_cast<int64_t>(mesh.parts[part].indices.size() / 3);
    counts.words.total +=
        draws * (lower::object_word::parameters + lower::view_word::matrix + values.word_count());
  }
  for (const Count* count : {&counts.vertices, &counts.triangles, &counts.words, &counts.draws}) {
    if (count->total <= count->limit) continue;
    diagnostics_
        ->report(Id::too_large, object.name_where,
                 "with object " + quote(object.name) + " the scene has more than " + std::to_string(count->limit) +
                     " " + std::string(count->what) + " to draw")
        .suggest("draw fewer copies, fewer repetitions of passes, or meshes of fewer segments");
    return false;
  }
  return true;
}

std::optional<int> Planner::find_texture(const ImageSource& source, const lower::ImageSlot& slot) {
  // An image inside another file was read with that file.
  if (source.bytes == nullptr && !may_read(source.path, source.where)) return std::nullopt;
  return textures_.find(source, slot.decoding, slot.mips, *diagnostics_);
}

/// Makes the mesh and the parameters of one object after the other, and stops when a limit is exceeded.
bool Planner::make_objects() {
  Counts counts = begin_counting();
  const StoredMesh no_mesh{{MeshPart{}}};
  bool good = true;
  const FindTexture find = [&](const ImageSource& source, const lower::ImageSlot& slot) {
    return good ? find_texture(source, slot) : std::nullopt;
  };
  for (size_t o = 0; o < scene_->objects.size(); ++o) {
    const Object& object = scene_->objects[o];
    const driver::Effect& effect = plan_.effects[effect_of_object_[o]];
    // After an error the rest is only checked for further errors.
    constexpr size_t none = ~size_t{0};
    const size_t number = good ? find_mesh(o).value_or(none) : none;
    const StoredMesh& mesh = number != none ? plan_.meshes[number] : no_mesh;
    auto resolved = resolve_parts(object, effect, mesh, find);
    good = good && number != none && resolved.has_value();
    parameters_.push_back(std::move(resolved).value_or(PartValues()));
    parameters_before_.emplace_back();
    if (good && &before(o) != &object) {
      auto earlier = resolve_parts(before(o), effect, mesh, find);
      good = earlier.has_value();
      parameters_before_.back() = std::move(earlier).value_or(PartValues());
    }
    if (!good) {
      if (diagnostics_->full()) return false;
      continue;
    }
    mesh_of_object_.push_back(number);
    note_largest_mesh(object, mesh);
    if (!count_object(o, counts)) return false;
  }
  return good;
}

bool Planner::update_objects(const PlanKeys& keys) {
  const size_t objects = scene_->objects.size();
  const bool new_meshes = keys.meshes != keys_.meshes;
  if (new_meshes) {
    meshes_.begin_again();
    most_vertices_ = 0;
    for (size_t o = 0; o < objects; ++o) {
      const auto number = find_mesh(o);
      if (!number) return false;
      mesh_of_object_[o] = *number;
      note_largest_mesh(scene_->objects[o], plan_.meshes[*number]);
    }
    meshes_.end_again();
    plan_.frame.revisions.vertices = next_revision();
  }
  Counts counts = begin_counting();
  const FindTexture find = [&](const ImageSource& source, const lower::ImageSlot& slot) {
    return find_texture(source, slot);
  };
  for (size_t o = 0; o < objects; ++o) {
    if (keys.objects[o] != keys_.objects[o] || keys.meshes[o] != keys_.meshes[o]) {
      const driver::Effect& effect = plan_.effects[effect_of_object_[o]];
      const StoredMesh& mesh = plan_.meshes[mesh_of_object_[o]];
      auto now = resolve_parts(scene_->objects[o], effect, mesh, find);
      auto earlier = now && &before(o) != &scene_->objects[o] ? resolve_parts(before(o), effect, mesh, find)
                                                               : std::optional(PartValues());
      if (!now || !earlier) return false;
      const auto same_images = [](const PartValues& a, const PartValues& b) {
        return std::ranges::equal(a, b, [](const ParameterValues& x, const ParameterValues& y) { return x.has_images_of(y); });
      };
      const auto or_now = [](const PartValues& values, const PartValues& values_now) -> const PartValues& {
        return values.empty() ? values_now : values;
      };
      // Textures are numbered in the order in which objects name them.
      if (!same_images(*now, parameters_[o]) ||
          !same_images(or_now(*earlier, *now), or_now(parameters_before_[o], parameters_[o])))
        return false;
      parameters_[o] = *std::move(now);
      parameters_before_[o] = *std::move(earlier);
      const lanes::FpGuard guard;
      if (!keeps_fixed(effect.parameters, effect.fixed, given_by_object(o, effect.parameters))) return false;
    }
    if (!count_object(o, counts)) return false;
  }
  return true;
}

bool Planner::reads_blurred_maps() const {
  if (!skips(interface::Skip::textures)) return true;
  const auto is_above_0 = [](const driver::EnvironmentReads& reads, const driver::ParameterBlock& block, const ParameterValues& values) {
    return std::ranges::any_of(reads.roughnesses, [&](size_t field) { return values.most(block.word_of(field)) > 0; });
  };
  for (size_t o = 0; o < parameters_.size(); ++o) {
    const driver::Effect& effect = plan_.effects[effect_of_object_[o]];
    if (effect.environment.blurred) return true;
    for (const ParameterValues& values : parameters_[o])
      if (is_above_0(effect.environment, effect.parameters, values)) return true;
  }
  for (size_t p = 0; p < posts_.size(); ++p) {
    const driver::Post& document = *posts_[p];
    if (document.environment.blurred) return true;
    if (document.environment.roughnesses.empty()) continue;
    const scene::Post& post = scene_->posts[p];
    Diagnostics unheard;  // plan_posts() reports them
    const auto values = ParameterValues::resolve(document.parameters, {post.name, post.parameters}, {}, unheard);
    if (values && is_above_0(document.environment, document.parameters, *values)) return true;
  }
  return false;
}

bool Planner::add_environment() {
  backends::Frame& frame = plan_.frame;
  frame.texels.resize(texels_of_textures_);
  frame.textures.resize(words_of_textures_);
  environment_ = -1;
  plan_.stats.environment = scene_->environment.has_value();
  if (scene_->environment) {
    const scene::Environment& environment = *scene_->environment;
    if (!environment.file.empty() && !may_read(environment.file, environment.file_where)) return false;
    Clock clock;
    has_blurred_maps_ = reads_blurred_maps();
    const auto made = environment::make_environment(
        environment,
        {options_.compiler.library, options_.cache, {.threads = workers_.count()}, !has_blurred_maps_}, *diagnostics_);
    if (!made) return false;
    plan_.stats.environment_cached = made->cached;
    environment_ = append_levels(made->maps, frame);
    plan_.stats.environment_seconds = clock.lap();
  }
  frame.revisions.texels = next_revision();
  frame.revisions.textures = next_revision();
  return true;
}

void Planner::begin(const Scene& scene, Diagnostics& diagnostics) {
  scene_ = &scene;
  diagnostics_ = &diagnostics;
  plan_.stats = {};
  plan_.skips = options_.compiler.skips;
}

bool Planner::plan(const Scene& scene, Diagnostics& diagnostics) {
  Clock clock;
  begin(scene, diagnostics);
  const auto [width, height] = size_of(scene, options_);
  if (!check_samples(scene, width, height, diagnostics)) return false;
  const bool effects = check_effects();
  if (!compile_posts() || !effects) return false;
  has_motion_ = may_read_motion();
  double compile_seconds = clock.lap();
  if (!make_objects()) return false;
  const double object_seconds = clock.lap();
  compile_effects();
  report_programs();
  reads_time_ = find_time();
  compile_seconds += clock.lap();
  backends::Frame& frame = plan_.frame;
  programs_without_motion_ = frame.programs.size();
  leave_out_images();
  if (!textures_.store(frame, diagnostics)) return false;
  texels_of_textures_ = frame.texels.size();
  words_of_textures_ = frame.textures.size();
  frame.revisions.vertices = next_revision();
  frame.revisions.texel_bytes = next_revision();
  if (!add_environment()) return false;
  keys_ = keys_of(scene);
  update_frame_words();
  place_all();
  if (!make_views(width, height)) return false;
  plan_.stats.compile_seconds = compile_seconds;
  finish_stats(object_seconds + clock.lap());
  return true;
}

bool Planner::plan_next(const Scene& scene, Diagnostics& diagnostics) {
  Clock clock;
  PlanKeys keys = keys_of(scene);
  if (keys.programs != keys_.programs) return false;
  begin(scene, diagnostics);
  const auto [width, height] = size_of(scene, options_);
  if (!check_samples(scene, width, height, diagnostics)) return false;
  const bool is_placed = keys.objects == keys_.objects && keys.meshes == keys_.meshes;
  if ((!is_placed && !update_objects(keys)) || !posts_keep_fixed()) return false;
  const bool is_lit = keys.environment == keys_.environment &&
                      (!scene.environment || has_blurred_maps_ == reads_blurred_maps());
  if (!is_lit && !add_environment()) return false;
  plan_.stats.environment = scene.environment.has_value();
  plan_.stats.environment_kept = is_lit && plan_.stats.environment;
  keys_ = std::move(keys);
  const bool same_frame = update_frame_words();
  if (!is_placed || !is_lit || (draws_read_frame_ && !same_frame)) place_all();
  if (!make_views(width, height)) return false;
  finish_stats(clock.lap());
  return true;
}

bool Planner::update_frame_words() {
  const lanes::FpGuard guard;
  const std::vector<float> now = std::exchange(frame_now_, frame_words(*scene_, environment_));
  const bool reads_time = reads_time_ || !skips(interface::Skip::frames);
  if (!reads_time) frame_now_[lower::frame_word::time] = 0;
  const std::vector<float> earlier = std::exchange(frame_earlier_, frame_now_);
  const double time = static_cast<double>(scene_->time) - 1 / static_cast<double>(scene_->frames_per_second);
  if (reads_time) frame_earlier_[lower::frame_word::time] =
      scene::canonical(scene_->before != nullptr ? scene_->before->time : static_cast<float>(time));
  return now == frame_now_ && (earlier == frame_earlier_ || !has_motion_);
}

void Planner::finish_stats(double seconds) {
  const backends::Frame& frame = plan_.frame;
  PlanStats& stats = plan_.stats;
  stats.meshes = static_cast<int64_t>(plan_.meshes.size());
  stats.mesh_vertices = static_cast<int64_t>(frame.vertices.size()) / lower::vertex_word::stride;
  stats.effects = static_cast<int64_t>(plan_.effects.size());
  stats.programs = static_cast<int64_t>(frame.programs.size());
  stats.textures = textures_.count();
  stats.texels = textures_.texel_count();
  stats.texture_bytes = static_cast<int64_t>(4 * (frame.texels.size() + frame.texel_bytes.size()));
  stats.lights = frame.light_count;
  stats.posts = static_cast<int64_t>(plan_.posts.steps.size());
  stats.sample_posts = plan_.samples > 1 ? static_cast<int64_t>(plan_.posts.sample_steps) : 0;
  stats.plan_seconds = seconds;
  stats.in_programs = skipped_in_programs_;
}

uint64_t next_revision() {
  static std::atomic<uint64_t> last = 0;
  return ++last;
}

FramePlanner::FramePlanner(const PlanOptions& options) : options_(options), compiled_(std::make_unique<Compiled>()) {
  if (options_.workers == nullptr) options_.workers = &own_workers_.emplace(0);
}

FramePlanner::~FramePlanner() = default;

const Plan* FramePlanner::plan(const Scene& scene, Diagnostics& diagnostics) {
  if (planner_ != nullptr) {
    // What is found on the way is found and reported again if all is planned anew.
    Diagnostics attempt = diagnostics;
    if (planner_->plan_next(scene, attempt)) {
      diagnostics = std::move(attempt);
      return &planner_->made();
    }
    options_.changing.insert(planner_->changed().begin(), planner_->changed().end());
  }
  planner_ = std::make_unique<Planner>(options_, *options_.workers, *compiled_);
  if (planner_->plan(scene, diagnostics)) return &planner_->made();
  planner_.reset();
  return nullptr;
}

std::optional<Plan> plan_frame(const Scene& scene, const PlanOptions& options, Diagnostics& diagnostics) {
  FramePlanner planner(options);
  if (planner.plan(scene, diagnostics) == nullptr) return std::nullopt;
  return std::move(planner.planner_->made());
}

}  // namespace isoshade::render
