// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/planner.h"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include "compiler/ir/printer.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/visible.h"
#include "runtime/environment/environment.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/render/clock.h"
#include "runtime/render/meshes.h"
#include "runtime/render/samples.h"
#include "runtime/render/skips.h"

namespace isoshade::render {

using scene::Instance;
using scene::Object;
using scene::Scene;
using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

lower::LightKinds kinds_of(const std::vector<scene::Light>& lights) {
  lower::LightKinds kinds{false, false, false, {}};
  for (const scene::Light& light : lights) {
    kinds.directional |= light.kind == scene::LightKind::directional;
    kinds.point |= light.kind == scene::LightKind::point;
    kinds.spot |= light.kind == scene::LightKind::spot;
    kinds.shadows |= light.shadow.has_value();
  }
  return kinds;
}

}  // namespace

driver::CompileOptions Planner::compile_options() const {
  driver::CompileOptions options = options_.compiler;
  options.lights = kinds_of(scene_.lights);
  options.lights.environment = scene_.environment.has_value();
  return options;
}

bool Planner::compile_effects() {
  driver::CompileOptions options = compile_options();
  const bool shadows = options.lights.shadows;
  std::map<std::pair<std::string, bool>, size_t> known;
  bool good = true;
  for (const Object& object : scene_.objects) {
    options.lights.shadows = shadows && object.receives_shadow;
    const auto [found, is_new] =
        known.try_emplace({object.effect, options.lights.shadows}, plan_.effects.size());
    effect_of_object_.push_back(found->second);
    if (!is_new) continue;
    const bool is_reported = !good && known.contains({object.effect, !options.lights.shadows});
    const support::Source source = is_reported ? nullptr : read_document(object.effect, object.effect_where);
    auto effect = source != nullptr ? driver::compile_effect(source, options, diagnostics_) : std::nullopt;
    if (!effect && !is_reported && !diagnostics_.full() && !diagnostics_.all().empty()) {
      diagnostics_.all().back().note(object.effect_where, "the effect of " + quote(object.name));
    }
    good = good && effect.has_value();
    plan_.effects.push_back(effect ? *std::move(effect) : driver::Effect{});
  }
  if (!good) return false;
  // Only now, because the effects no longer move.
  for (const driver::Effect& effect : plan_.effects) {
    std::vector<PassPrograms>& programs = programs_of_effect_.emplace_back();
    for (const driver::EffectPass& pass : effect.passes) {
      const uint32_t vertex = add_program(pass.vertex);
      const uint32_t cutout = pass.cutout ? add_program(*pass.cutout) : backends::Frame::no_program;
      const uint32_t pixel = add_program(pass.pixel, cutout);
      programs.push_back({vertex, pixel, pass.blend ? add_program(*pass.blend, cutout) : pixel});
    }
  }
  return true;
}

/// Whether the text at `where` may name the file. Files that the user names have no `where`, or one in an argument.
bool Planner::may_read(const std::string& path, const support::Span& where) {
  const check::Library* library = options_.compiler.library;
  return library == nullptr || graph::may_read(path, where, library->files(), diagnostics_);
}

support::Source Planner::read_document(const std::string& path, const support::Span& where) {
  if (!may_read(path, where)) return nullptr;
  const check::Library* library = options_.compiler.library;
  return graph::read_document(path, library != nullptr ? library->files() : graph::FileRule{}, diagnostics_,
                              where);
}

bool Planner::compile_posts() {
  const driver::CompileOptions options = compile_options();
  std::map<std::string, size_t> known;
  std::vector<size_t> document_of_post;
  bool good = true;
  for (const scene::Post& post : scene_.posts) {
    const auto [found, is_new] = known.try_emplace(post.effect, plan_.post_documents.size());
    document_of_post.push_back(found->second);
    if (!is_new) continue;
    const support::Source source = read_document(post.effect, post.effect_where);
    auto compiled =
        source != nullptr ? driver::compile_post(source, options, diagnostics_) : std::nullopt;
    if (!compiled && !diagnostics_.full() && !diagnostics_.all().empty())
      diagnostics_.all().back().note(post.effect_where, "the effect of post " + quote(post.name));
    good = good && compiled.has_value();
    plan_.post_documents.push_back(compiled ? *std::move(compiled) : driver::Post{});
  }
  // Only now, because the documents no longer move.
  for (const size_t document : document_of_post) posts_.push_back(&plan_.post_documents[document]);
  return good;
}

/// Equal programs share an index: most effects have the same vertex program.
uint32_t Planner::add_program(const driver::Program& program, uint32_t cutout) {
  std::string text = std::to_string(static_cast<int>(program.stage)) + "\n" + std::to_string(cutout) + "\n" +
                     std::to_string(program.entry) + "\n" + ir::print(program.module);
  const auto next = static_cast<uint32_t>(plan_.frame.programs.size());
  const auto [found, is_new] = program_by_text_.try_emplace(std::move(text), next);
  std::vector<uint32_t>& cutouts = plan_.frame.cutouts;
  if (is_new) plan_.frame.programs.push_back(&program);
  if (is_new && (cutout != backends::Frame::no_program || !cutouts.empty())) {
    cutouts.resize(plan_.frame.programs.size(), backends::Frame::no_program);
    cutouts.back() = cutout;
  }
  return found->second;
}

std::optional<size_t> Planner::find_mesh(const Object& object) {
  const bool is_file = object.mesh.kind == scene::MeshKind::file;
  if (is_file && !may_read(object.mesh.file, object.mesh_where)) return std::nullopt;
  return meshes_.find(object, plan_.meshes, plan_.frame.vertices, diagnostics_);
}

void Planner::note_largest_mesh(const Object& object, const StoredMesh& mesh) {
  uint32_t count = 0;
  for (const MeshPart& part : mesh.parts) count += part.vertex_count;
  if (count <= most_vertices_) return;
  most_vertices_ = count;
  plan_.frame.largest_mesh = {
      "the mesh of " + quote(object.name) + ": " + std::to_string(count) + " vertices", object.mesh_where};
}

/// Resolves the parameters of an object for each part of its mesh.
std::optional<std::vector<ParameterValues>> Planner::resolve_parts(const Object& object, const driver::Effect& effect,
                                                                   const StoredMesh& mesh,
                                                                   const FindTexture& find_texture) {
  std::vector<ParameterValues> parameters;
  for (const MeshPart& part : mesh.parts) {
    const scene::Material* material = part.material ? &*part.material : nullptr;
    const ParameterGiver giver{object.name, object.parameters, object.repeat, material, object.mesh_where};
    auto resolved = ParameterValues::resolve(effect.parameters, giver, find_texture, diagnostics_);
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

/// Makes the mesh and the parameters of one object after the other, and stops when a limit is exceeded.
bool Planner::make_objects() {
  struct Count {
    std::string_view what;
    int64_t limit;
    int64_t total = 0;
  };
  Count vertices{"vertices", max_drawn_vertices};
  Count triangles{"triangles", max_drawn_triangles};
  Count words{"words of object records", max_object_words};
  size_t views = 1;
  for (const scene::Light& light : scene_.lights) views += shadow_map_count(light);
  Count draws_of_views{"draws, those of shadows too,", max_draws};
  const StoredMesh no_mesh{{MeshPart{}}};
  bool good = true;
  const FindTexture find_texture = [&](const ImageSource& source,
                                       const lower::ImageSlot& slot) -> std::optional<int> {
    // An image inside another file was read with that file.
    if (!good || (source.bytes == nullptr && !may_read(source.path, source.where))) return std::nullopt;
    return textures_.find(source, slot.decoding, slot.mips, diagnostics_);
  };
  for (size_t o = 0; o < scene_.objects.size(); ++o) {
    const Object& object = scene_.objects[o];
    const driver::Effect& effect = plan_.effects[effect_of_object_[o]];
    // After an error the rest is only checked for further errors.
    const auto number = good ? find_mesh(object) : std::nullopt;
    const StoredMesh& mesh = number ? plan_.meshes[*number] : no_mesh;
    auto resolved = resolve_parts(object, effect, mesh, find_texture);
    good = good && number.has_value() && resolved.has_value();
    parameters_.push_back(std::move(resolved).value_or(std::vector<ParameterValues>()));
    if (good && !before_.objects.empty()) {
      auto earlier = resolve_parts(before(o), effect, mesh, find_texture);
      good = earlier.has_value();
      parameters_before_.push_back(std::move(earlier).value_or(std::vector<ParameterValues>()));
    }
    if (!good || !number) {
      if (diagnostics_.full()) return false;
      continue;
    }
    mesh_of_object_.push_back(*number);
    note_largest_mesh(object, mesh);
    for (size_t part = 0; part < mesh.parts.size(); ++part) {
      const int64_t draws = scene::instance_count(object) * most_draws(effect, parameters_.back()[part]);
      draws_of_views.total += draws * static_cast<int64_t>(views);
      vertices.total += draws * mesh.parts[part].vertex_count;
      triangles.total += draws * static_cast<int64_t>(mesh.parts[part].indices.size() / 3);
      words.total += draws * (lower::object_word::parameters + lower::view_word::matrix +
                              parameters_.back()[part].word_count());
    }
    for (const Count* count : {&vertices, &triangles, &words, &draws_of_views}) {
      if (count->total <= count->limit) continue;
      diagnostics_
          .report(Id::too_large, object.name_where,
                  "with object " + quote(object.name) + " the scene has more than " +
                      std::to_string(count->limit) + " " + std::string(count->what) + " to draw")
          .suggest("draw fewer copies, fewer repetitions of passes, or meshes of fewer segments");
      return false;
    }
  }
  return good;
}

std::optional<int> Planner::add_environment() {
  if (!scene_.environment) return -1;
  const scene::Environment& environment = *scene_.environment;
  if (!environment.file.empty() && !may_read(environment.file, environment.file_where)) return std::nullopt;
  Clock clock;
  const auto made = environment::make_environment(
      environment, {options_.compiler.library, options_.cache, {}}, diagnostics_);
  if (!made) return std::nullopt;
  plan_.stats.environment = true;
  plan_.stats.environment_cached = made->cached;
  plan_.stats.environment_seconds = clock.lap();
  return append_levels(made->maps, plan_.frame);
}

std::optional<Plan> Planner::plan() {
  Clock clock;
  const int width = options_.width > 0 ? options_.width : scene_.width;
  const int height = options_.height > 0 ? options_.height : scene_.height;
  if (!check_samples(scene_, width, height, diagnostics_)) return std::nullopt;
  const bool effects = compile_effects();
  if (!compile_posts() || !effects) return std::nullopt;
  plan_.stats.compile_seconds = clock.lap();
  if (scene_.before != nullptr && scene_.before->objects.size() == scene_.objects.size()) before_ = *scene_.before;
  if (!make_objects()) return std::nullopt;
  textures_.store(plan_.frame);
  const std::optional<int> environment = add_environment();
  if (!environment) return std::nullopt;
  plan_.stats.skips = unread_images(plan_.effects);

  backends::Frame& frame = plan_.frame;
  plan_.samples = scene_.samples;
  const int side = samples_each_way(scene_.samples);
  {
    const lanes::FpGuard guard;
    frame.frame = frame_words(scene_, *environment);
    add_views(width, height, side);
    begin_motion(width, height);
    for (size_t o = 0; o < scene_.objects.size(); ++o) place_object(o);
    append_blended();
    finish_motion();
    auto posts = plan_posts(scene_, posts_, width, height, options_.skip, plan_.stats.skips, diagnostics_);
    if (!posts) return std::nullopt;
    plan_.posts = *std::move(posts);
    if (plan_.motion && !plan_.posts.reads_motion()) plan_.motion.reset();
  }
  frame.light_count = static_cast<int>(scene_.lights.size());

  PlanStats& stats = plan_.stats;
  stats.meshes = static_cast<int64_t>(plan_.meshes.size());
  stats.mesh_vertices = static_cast<int64_t>(frame.vertices.size()) / lower::vertex_word::stride;
  stats.effects = static_cast<int64_t>(plan_.effects.size());
  stats.programs = static_cast<int64_t>(frame.programs.size());
  stats.textures = static_cast<int64_t>(textures_.count());
  stats.texels = textures_.texel_count();
  stats.texture_bytes = static_cast<int64_t>(4 * (frame.texels.size() + frame.texel_bytes.size()));
  stats.lights = frame.light_count;
  stats.posts = static_cast<int64_t>(plan_.posts.steps.size());
  stats.sample_posts = plan_.samples > 1 ? static_cast<int64_t>(plan_.posts.sample_steps) : 0;
  stats.plan_seconds = clock.lap();
  return std::move(plan_);
}

std::optional<Plan> plan_frame(const Scene& scene, const PlanOptions& options, Diagnostics& diagnostics) {
  return Planner(scene, options, diagnostics).plan();
}

}  // namespace isoshade::render
