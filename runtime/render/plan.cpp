// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/plan.h"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include "compiler/ir/printer.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/lower/shadow.h"
#include "compiler/support/visible.h"
#include "runtime/environment/environment.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/render/clock.h"
#include "runtime/render/meshes.h"
#include "runtime/render/parameters.h"
#include "runtime/render/records.h"
#include "runtime/render/samples.h"
#include "runtime/render/shadows.h"
#include "runtime/render/skips.h"
#include "runtime/render/textures.h"
#include "runtime/render/visibility.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/placement.h"

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

class Planner {
 public:
  Planner(const Scene& scene, const PlanOptions& options, Diagnostics& diagnostics)
      : scene_(scene), options_(options), diagnostics_(diagnostics) {}

  std::optional<Plan> plan();

 private:
  struct PassPrograms {
    uint32_t vertex, pixel;  // in Frame::programs
  };

  bool compile_effects();
  bool compile_posts();
  /// What the programs are compiled for.
  driver::CompileOptions compile_options() const;
  /// Adds the maps of the environment to the textures; its first record, or -1 without one. Nothing after an error.
  std::optional<int> add_environment();
  support::Source read_document(const std::string& path, const support::Span& where);
  /// `cutout`: of a pixel program, the index of the one that belongs to it.
  uint32_t add_program(const driver::Program& program, uint32_t cutout = backends::Frame::no_program);
  bool may_read(const std::string& path, const support::Span& where);
  bool make_objects();
  std::optional<size_t> find_mesh(const Object& object);
  void note_largest_mesh(const Object& object, const StoredMesh& mesh);
  bool resolve_parts(const Object& object, const driver::Effect& effect, const StoredMesh& mesh,
                     const FindTexture& find_texture);
  void place_object(size_t o);
  /// Adds a view. The camera and the size of a pixel are those of an image of this size.
  void add_view(const scene::Camera& camera, const scene::View& view, int width, int height, backends::Target target);
  /// Adds the records of the lights, and a view for each of their shadow maps.
  void add_lights(const scene::View& picture);
  std::vector<Hull> find_hulls(const scene::View& picture) const;
  bool is_shadow_map(size_t view) const { return view + 1 < plan_.frame.views.size(); }
  /// One copy of an object in one view.
  struct Appearance {
    glm::mat4 projected;
    bool outside;     ///< of the view: passes that do not move vertices draw nothing
    int matrix = -1;  ///< the first word of `projected` in View::words, once a draw needs it
  };
  /// One copy of an object.
  struct Copy {
    Instance instance;
    ObjectTransforms place;
    std::span<Appearance> views;  ///< one for each view
  };
  void place_copy(size_t o, const Copy& copy, std::vector<PassSkips>& skipped);
  /// Appends the record of a draw.
  backends::Draw make_draw(const ObjectTransforms& place, const PassPrograms& programs, const MeshPart& part,
                           const std::vector<float>& parameters);
  /// Adds the draw to a view.
  void place_draw(backends::Draw draw, Appearance& appearance, backends::View& view);

  const Scene& scene_;
  const PlanOptions& options_;
  Diagnostics& diagnostics_;
  Plan plan_;
  std::vector<scene::View> cameras_;  ///< of each view of the frame
  std::vector<size_t> effect_of_object_;
  std::vector<std::vector<PassPrograms>> programs_of_effect_;
  std::map<std::string, uint32_t> program_by_text_;
  std::vector<std::vector<ParameterValues>> parameters_;  ///< of each object, for each part of its mesh
  MeshStore meshes_;
  uint32_t most_vertices_ = 0;  ///< of a mesh
  std::vector<size_t> mesh_of_object_;
  TextureStore textures_;
  std::vector<const driver::Post*> posts_;  ///< of each post of the scene
};

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
      programs.push_back({vertex, add_program(pass.pixel, cutout)});
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

/// Resolves the parameters of the next object for each part of its mesh.
bool Planner::resolve_parts(const Object& object, const driver::Effect& effect, const StoredMesh& mesh,
                            const FindTexture& find_texture) {
  std::vector<ParameterValues>& parameters = parameters_.emplace_back();
  for (const MeshPart& part : mesh.parts) {
    const scene::Material* material = part.material ? &*part.material : nullptr;
    const ParameterGiver giver{object.name, object.parameters, object.repeat, material, object.mesh_where};
    auto resolved = ParameterValues::resolve(effect.parameters, giver, find_texture, diagnostics_);
    if (!resolved) return false;  // further parts would report the same again
    parameters.push_back(*std::move(resolved));
  }
  return true;
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
    const bool resolved = resolve_parts(object, effect, mesh, find_texture);
    good = good && number.has_value() && resolved;
    if (!good) {
      if (diagnostics_.full()) return false;
      continue;
    }
    const int64_t draws = scene::instance_count(object) * static_cast<int64_t>(effect.passes.size());
    draws_of_views.total += draws * static_cast<int64_t>(mesh.parts.size() * views);
    mesh_of_object_.push_back(*number);
    note_largest_mesh(object, mesh);
    for (size_t part = 0; part < mesh.parts.size(); ++part) {
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
          .suggest("draw fewer copies, or meshes of fewer segments");
      return false;
    }
  }
  return good;
}

/// Places one pass after the other, each over all parts.
void Planner::place_copy(size_t o, const Copy& copy, std::vector<PassSkips>& skipped) {
  const Object& object = scene_.objects[o];
  const driver::Effect& effect = plan_.effects[effect_of_object_[o]];
  const StoredMesh& mesh = plan_.meshes[mesh_of_object_[o]];
  std::vector<std::vector<float>> parameters;
  for (const ParameterValues& part : parameters_[o])
    parameters.push_back(part.words(copy.instance, [&](int number) { return textures_.record(number); }));
  const glm::vec3& scale = object.transform.scale;
  const bool mirrored = ((scale.x < 0) != (scale.y < 0)) != (scale.z < 0);
  for (size_t p = 0; p < effect.passes.size(); ++p) {
    const driver::EffectPass& pass = effect.passes[p];
    const auto may_see = [&](size_t v) {
      if (is_shadow_map(v) && !(object.casts_shadow && pass.casts_shadow)) return false;
      return !copy.views[v].outside || pass.moves_vertices;
    };
    bool unseen = true;
    for (size_t v = 0; v < copy.views.size(); ++v) unseen = unseen && !may_see(v);
    bool left_out = false;
    for (size_t part = 0; part < mesh.parts.size(); ++part) {
      if (!options_.disabled && effect.parameters.is_off(pass.enabled, parameters[part])) {
        ++skipped[p].disabled;
      } else if (unseen) {
        left_out = true;
      } else {
        backends::Draw draw = make_draw(copy.place, programs_of_effect_[effect_of_object_[o]][p],
                                        mesh.parts[part], parameters[part]);
        draw.state = pass.state;
        if (effect.parameters.is_on(pass.double_sided, parameters[part])) draw.state.cull = interface::Cull::none;
        draw.mirrored = mirrored;
        draw.cutout = pass.cutout && effect.parameters.cuts_out(pass.cutoff, parameters[part]);
        if (pass.cutout && !draw.cutout) ++skipped[p].uncut;
        plan_.origins.push_back({draw.object, static_cast<uint32_t>(o), &pass});
        for (size_t v = 0; v < copy.views.size(); ++v) {
          if (!may_see(v)) continue;
          backends::Draw seen = draw;
          if (is_shadow_map(v)) seen.state = {interface::Cull::none, interface::DepthTest::nearer};
          place_draw(seen, copy.views[v], plan_.frame.views[v]);
        }
      }
    }
    if (left_out) ++skipped[p].unseen;
  }
}

backends::Draw Planner::make_draw(const ObjectTransforms& place, const PassPrograms& programs,
                                  const MeshPart& part, const std::vector<float>& parameters) {
  const size_t first = plan_.frame.objects.size();
  append_object(place, programs.pixel, parameters, plan_.frame.objects);
  backends::Draw draw;
  draw.vertex_program = programs.vertex;
  draw.pixel_program = programs.pixel;
  draw.object = static_cast<int>(first);
  draw.first_vertex = part.first_vertex;
  draw.vertex_count = part.vertex_count;
  draw.indices = part.indices;
  return draw;
}

void Planner::place_draw(backends::Draw draw, Appearance& appearance, backends::View& view) {
  if (appearance.matrix < 0) appearance.matrix = append_matrix(appearance.projected, view.words);
  draw.projected = appearance.matrix;
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
      views[v] = {projected,
                  options_.skip && outside_view(mesh.low, mesh.high, projected, target.width, target.height)};
    }
    place_copy(o, {instance, place, views}, skipped);
  }
  plan_.stats.copies += count;
  report_skips(object, effect, static_cast<int64_t>(mesh.parts.size()), skipped, plan_.stats.skips);
}

void Planner::add_view(const scene::Camera& camera, const scene::View& view, int width, int height,
                       backends::Target target) {
  cameras_.push_back(view);
  backends::View& added = plan_.frame.views.emplace_back();
  added.target = std::move(target);
  added.words = view_words(camera, view, width, height);
}

std::vector<Hull> Planner::find_hulls(const scene::View& picture) const {
  // Of a mesh whose passes move vertices; an author who moves them further leaves their shadows incomplete.
  constexpr float moved = 0.5f;
  std::vector<Hull> hulls;
  for (size_t o = 0; o < scene_.objects.size(); ++o) {
    const Object& object = scene_.objects[o];
    const StoredMesh& mesh = plan_.meshes[mesh_of_object_[o]];
    const std::vector<driver::EffectPass>& passes = plan_.effects[effect_of_object_[o]].passes;
    const bool casts = object.casts_shadow && std::ranges::any_of(passes, &driver::EffectPass::casts_shadow);
    const bool moves = std::ranges::any_of(passes, &driver::EffectPass::moves_vertices);
    const int64_t count = scene::instance_count(object);
    for (int64_t i = 0; i < count; ++i) {
      const glm::mat4 model = scene::model_matrix(object, scene::instance(object, i));
      const glm::mat4 projected = scene::multiply(picture.projection, model);
      const bool is_seen = moves || !outside_view(mesh.low, mesh.high, projected, scene::max_size, scene::max_size);
      hulls.push_back({corners_of(mesh.low, mesh.high, moves ? moved : 0.0f, model), casts,
                       object.receives_shadow && is_seen});
    }
  }
  return hulls;
}

void Planner::add_lights(const scene::View& picture) {
  namespace word = lower::light_word;
  const bool any = std::ranges::any_of(scene_.lights, [](const scene::Light& light) { return light.shadow.has_value(); });
  const std::vector<Hull> hulls = any ? find_hulls(picture) : std::vector<Hull>{};
  backends::Frame& frame = plan_.frame;
  for (const scene::Light& light : scene_.lights) {
    auto record = scene::light_record(light);
    const std::vector<ShadowMap> maps = light.shadow ? shadow_maps(light, hulls, picture) : std::vector<ShadowMap>{};
    if (light.shadow && maps.empty()) plan_.stats.skips.push_back({"shadow of " + light.name, "it darkens nothing that is seen"});
    if (!maps.empty()) {
      record[word::shadow] = static_cast<float>(1 + frame.views.size() * lower::shadow_map_records);
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
    const scene::View picture = scene::make_view(scene_.camera, width, height);
    add_lights(picture);
    const size_t shadow_maps = frame.views.size();
    add_view(scene_.camera, picture, width, height, {"the picture", side * width, side * height});
    for (size_t i = 0; i < shadow_maps; ++i) frame.views.back().reads.push_back(i);
    for (size_t i = 0; i < 4; ++i) frame.views.back().background[i] = scene::canonical(scene_.background[i]);
    for (size_t o = 0; o < scene_.objects.size(); ++o) place_object(o);
    auto posts = plan_posts(scene_, posts_, width, height, options_.skip, plan_.stats.skips, diagnostics_);
    if (!posts) return std::nullopt;
    plan_.posts = *std::move(posts);
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

}  // namespace

std::optional<Plan> plan_frame(const Scene& scene, const PlanOptions& options, Diagnostics& diagnostics) {
  return Planner(scene, options, diagnostics).plan();
}

}  // namespace isoshade::render
