// SPDX-License-Identifier: Apache-2.0
// Rendering pictures of one scene, one after the other.
#pragma once

#include <memory>
#include <optional>

#include "runtime/cli/session.h"
#include "runtime/render/render.h"

namespace isoshade::cli {

/// Renders as the arguments say. The backend, with the programs that it has compiled, the library, and what plans have in
/// common stay from one picture to the next.
class SceneRenderer {
 public:
  SceneRenderer(const RenderArguments& arguments, const Common& common);
  /// The plan is valid until the next call. Null after an error.
  const render::Plan* plan(const scene::Scene& scene, support::Diagnostics& diagnostics) {
    return planner_.plan(scene, diagnostics);
  }
  /// Opens the backend when it first draws, and reports what was drawn after the first picture, if the arguments say so.
  bool draw(const render::Plan& plan, render::DrawStats& stats, support::Diagnostics& diagnostics);
  /// The picture that was drawn last; valid until the next draw().
  scene::ImageView image() { return renderer_->image(); }
  /// Null before the first draw().
  const backends::Backend* backend() const { return backend_.get(); }

 private:
  render::PlanOptions plan_options();

  const RenderArguments& arguments_;
  const Common& common_;
  check::Library library_;
  threads::Workers workers_;
  render::FramePlanner planner_;
  std::unique_ptr<backends::Backend> backend_;
  std::optional<render::Renderer> renderer_;
  bool has_reported_ = false;
};

/// `render --frames`: renders each frame and writes its file before the next one is begun, or one file of all; without an
/// output only measures. Returns the exit code.
int render_frames(const RenderArguments& arguments, const Common& common, support::Diagnostics& diagnostics);

}  // namespace isoshade::cli
