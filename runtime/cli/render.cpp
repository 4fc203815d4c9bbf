// SPDX-License-Identifier: Apache-2.0
// isoshade render: renders a scene to an image file.
#include "runtime/cli/frames.h"

#include <cstdio>
#include <utility>

#include "runtime/scene/image_file.h"
#include "runtime/scene/load.h"
#include "runtime/scene/mesh_formats.h"

namespace isoshade::cli {

namespace {

/// Puts the glTF file in place of the mesh of the only glTF object, or of the only object. Reports scenes where the
/// object is ambiguous.
bool replace_mesh(scene::Scene& scene, const std::string& file, support::Diagnostics& diagnostics) {
  scene::Object* only = nullptr;
  int models = 0;
  for (scene::Object& object : scene.objects) {
    if (object.mesh.kind != scene::MeshKind::file) continue;
    only = &object;
    ++models;
  }
  if (models == 0 && scene.objects.size() == 1) only = &scene.objects[0];
  if (only == nullptr || models > 1) {
    diagnostics.report(support::Id::unknown_setting,
                       "--mesh needs a scene with one glTF mesh or one object; this scene has " +
                           std::to_string(models) + " glTF meshes and " +
                           std::to_string(scene.objects.size()) + " objects");
    return false;
  }
  only->mesh = {};
  only->mesh.kind = scene::MeshKind::file;
  only->mesh.file = file;
  only->mesh.format = scene::mesh_format_of(file);
  only->mesh.fit = true;
  only->mesh_where = {};
  return true;
}

}  // namespace

std::optional<scene::Scene> load_scene(const std::string& path, const SceneChanges& changes,
                                       const Common& common, support::Diagnostics& diagnostics) {
  const support::Source source = graph::read_source(path, diagnostics);
  if (source == nullptr) return std::nullopt;
  auto scene = scene::load_scene(source, changes.settings, make_library(common).files(), diagnostics, changes.time);
  if (!scene || !apply_changes(changes, *scene, diagnostics)) return std::nullopt;
  return scene;
}

bool apply_changes(const SceneChanges& changes, scene::Scene& scene, support::Diagnostics& diagnostics) {
  if (!changes.mesh.empty() && !replace_mesh(scene, changes.mesh, diagnostics)) return false;
  if (changes.samples) {
    scene.samples = *changes.samples;
    scene.samples_where = {};
  }
  return true;
}

namespace {

/// Returns the exit code.
int render_to_file(const RenderArguments& arguments, const Common& common,
                   support::Diagnostics& diagnostics) {
  auto output = image_output(arguments.output, arguments.output_choice, arguments.choice.threads, diagnostics);
  if (!output) return failure;
  const auto scene = load_scene(arguments.scene, arguments.changes, common, diagnostics);
  if (!scene) return failure;
  SceneRenderer renderer(arguments, common);
  const render::Plan* plan = renderer.plan(*scene, diagnostics);
  if (plan == nullptr || !may_write(arguments.output, diagnostics)) return failure;
  render::DrawStats stats;
  if (!renderer.draw(*plan, stats, diagnostics)) return failure;
  output->options.encoding = scene->output.encoding;
  output->options.exposure = scene->output.exposure;
  if (!scene::write_image(arguments.output, *output->format, renderer.image(), output->options, diagnostics)) return failure;
  render::warn_non_finite(*scene, *plan, stats.non_finite, diagnostics);
  if (!arguments.fail_on_nan || stats.non_finite.none()) return success;
  std::fputs(not_finite_text, stderr);
  return different;
}

}  // namespace

SceneRenderer::SceneRenderer(const RenderArguments& arguments, const Common& common)
    : arguments_(arguments),
      common_(common),
      library_(make_library(common)),
      workers_(arguments.choice.threads),
      planner_(plan_options()) {}

render::PlanOptions SceneRenderer::plan_options() {
  render::PlanOptions options;
  if (arguments_.size) {
    options.width = arguments_.size->width;
    options.height = arguments_.size->height;
  }
  options.compiler.library = &library_;
  options.compiler.reference = arguments_.backend == "reference";
  options.compiler.tier = arguments_.precision;
  options.compiler.skips = arguments_.skips;
  options.workers = &workers_;
  return options;
}

bool SceneRenderer::draw(const render::Plan& plan, render::DrawStats& stats, support::Diagnostics& diagnostics) {
  if (backend_ == nullptr) {
    backend_ = make_backend(arguments_.backend, arguments_.choice, common_, diagnostics);
    if (backend_ == nullptr) return false;
    progress(common_, "rendering on " + backend_->description());
    renderer_.emplace(*backend_);
  }
  if (!renderer_->draw(plan, stats, diagnostics)) return false;
  if (arguments_.stats && !std::exchange(has_reported_, true))
    std::fputs((backend_->description() + "\n" + render::text(plan.stats) + render::text(stats)).c_str(), stderr);
  return true;
}

int render(const RenderArguments& arguments, const Common& common) {
  support::Diagnostics diagnostics = make_diagnostics(common);
  const int result = arguments.frames ? render_frames(arguments, common, diagnostics)
                                      : render_to_file(arguments, common, diagnostics);
  return flush(diagnostics, common) ? failure : result;
}

}  // namespace isoshade::cli
