// SPDX-License-Identifier: Apache-2.0
// From a scene to a frame: everything that is the same for all backends, worked out once.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backends/backend.h"
#include "compiler/driver/driver.h"
#include "runtime/render/meshes.h"
#include "runtime/render/posts.h"
#include "runtime/render/stats.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

/// Limits that keep hostile scenes harmless, over all draws of a frame.
inline constexpr int64_t max_drawn_vertices = 8'000'000;   ///< 16 bytes each, after the vertex stage
inline constexpr int64_t max_drawn_triangles = 8'000'000;  ///< 64 bytes each, once clipped and snapped
inline constexpr int64_t max_object_words = 16'000'000;    ///< of all records

struct PlanOptions {
  int width = 0;  ///< of the image; 0: the scene's own size
  int height = 0;
  bool skip = true;          ///< leave out what cannot be seen; off, the image has the same bits
  driver::CompileOptions compiler;  ///< `lights` is set by the scene
};

/// What a draw of the frame is of.
struct DrawOrigin {
  uint32_t object;  ///< in Scene::objects
  const driver::EffectPass* pass;
};

/// A frame and all that it points into; made once, drawn by as many backends as are asked. Can be moved: what
/// the frame points to stays where it is.
struct Plan {
  std::vector<driver::Effect> effects;
  std::vector<StoredMesh> meshes;
  std::vector<driver::Post> post_documents;
  int samples = 1;        ///< of each pixel of the image: 1, 4 or 16
  backends::Frame frame;  ///< of as many samples as the image has, see render/samples.h
  std::vector<DrawOrigin> origins;  ///< of each of frame.draws
  PostChain posts;
  PlanStats stats;

  Plan() = default;
  Plan(Plan&&) = default;
  Plan& operator=(Plan&&) = default;
};

/// Compiles the effects, each once, makes the meshes, each once, and fills the arrays of the frame: one
/// record for each pass over each part of each copy of each object that the camera may see, in the order of the
/// scene; all parts before the next pass.
/// Reports effects that do not compile, parameters that an effect has not or that do not fit, and scenes
/// beyond the limits.
std::optional<Plan> plan_frame(const scene::Scene& scene, const PlanOptions& options,
                               support::Diagnostics& diagnostics);

}  // namespace isoshade::render
