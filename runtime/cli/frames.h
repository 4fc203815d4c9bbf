// SPDX-License-Identifier: Apache-2.0
// Rendering pictures of one scene, one after the other.
#pragma once

#include <memory>
#include <optional>

#include "runtime/cli/session.h"
#include "runtime/render/render.h"

namespace isoshade::cli {

/// Renders as the arguments say. The backend, with the programs that it has compiled, and the library stay from one
/// picture to the next.
class SceneRenderer {
 public:
  SceneRenderer(const RenderArguments& arguments, const Common& common);
  std::optional<render::Plan> plan(const scene::Scene& scene, support::Diagnostics& diagnostics);
  /// Opens the backend when it first draws.
  bool draw(const render::Plan& plan, backends::Image& image, render::DrawStats& stats,
            support::Diagnostics& diagnostics);

 private:
  const RenderArguments& arguments_;
  const Common& common_;
  check::Library library_;
  std::unique_ptr<backends::Backend> backend_;
};

/// `render --frames`: renders each frame and writes its file before the next one is begun, or one file of all. Returns the
/// exit code.
int render_frames(const RenderArguments& arguments, const Common& common, support::Diagnostics& diagnostics);

}  // namespace isoshade::cli
