// SPDX-License-Identifier: Apache-2.0
// From a scene to a frame: everything that is the same for all backends, computed once.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "backends/backend.h"
#include "compiler/driver/driver.h"
#include "runtime/render/meshes.h"
#include "runtime/render/posts.h"
#include "runtime/render/stats.h"
#include "runtime/scene/scene.h"
#include "runtime/threads/workers.h"

namespace isoshade::render {

/// Limits that keep hostile scenes harmless, over all draws of a view.
inline constexpr int64_t max_drawn_vertices = 8'000'000;   ///< 16 bytes each, after the vertex stage
inline constexpr int64_t max_drawn_triangles = 8'000'000;  ///< 64 bytes each, once clipped and snapped
inline constexpr int64_t max_object_words = 16'000'000;    ///< of all records and matrices
inline constexpr int64_t max_draws = 4'000'000;            ///< of all views

struct PlanOptions {
  int width = 0;  ///< of the image; 0: the scene's own size
  int height = 0;
  std::string cache;                ///< the folder for maps of environments; empty: the usual one
  bool disabled = false;            ///< draw the passes that a parameter disables, too; for programs that change it later
  std::set<std::string> changing;   ///< parameters, of any object or post, that later scenes give other values
  driver::CompileOptions compiler;  ///< `lights` and `fixed` are set by the scene; `skips` are those of the whole frame
  threads::Workers* workers = nullptr;  ///< that may help; null: one for each core
};

/// What a record of Frame::objects belongs to.
struct RecordOrigin {
  int record;       ///< its first word
  uint32_t object;  ///< in Scene::objects
  const driver::EffectPass* pass;
};

/// How far what the picture shows has moved since the frame before. Both views have the same draws in the same order:
/// the picture's that write depth.
struct MotionPlan {
  backends::View before;        ///< places the vertices where they were
  backends::View now;           ///< draws the motion
  std::vector<float> backdrop;  ///< the record of driver::backdrop_motion_program
  const driver::Program* complete = nullptr;  ///< that program
};

/// A frame and everything that it points to. It is made once; any number of backends draw it. It can be moved: what the
/// frame points to keeps its address.
struct Plan {
  std::vector<driver::Effect> effects;
  std::vector<StoredMesh> meshes;
  std::vector<driver::Post> post_documents;
  int samples = 1;        ///< in each pixel of the picture: 1, 4 or 16
  backends::Frame frame;  ///< the target of the picture has the size in samples, see render/samples.h
  std::vector<RecordOrigin> origins;  ///< of the records of frame.objects but for those of motion, in their order
  std::optional<MotionPlan> motion;  ///< if a post reads it
  PostChain posts;
  interface::Skips skips;  ///< those of the options
  bool views_read_time = false;  ///< a program of a view may; posts may read it, too
  PlanStats stats;

  Plan() = default;
  Plan(Plan&&) = default;
  Plan& operator=(Plan&&) = default;
};

/// Compiles each effect once, makes each mesh once, and fills the arrays of the frame: one record for each repetition of
/// each pass over each part of each copy of each object that is not disabled, whether or not a view sees it. The draws of
/// a view are those that it may see, in the order of the scene, with all parts before the next repetition of a pass, and
/// all repetitions before the next pass. Reports effects that do not compile, unknown or unsuitable parameters, and scenes
/// beyond the limits.
std::optional<Plan> plan_frame(const scene::Scene& scene, const PlanOptions& options,
                               support::Diagnostics& diagnostics);

class Planner;
class Compiled;

/// Plans one scene after the other, such as the frames of an animation, and keeps what the next one has in common with
/// the last: effects, meshes, textures, maps of environments, values of parameters, and records. Each plan is what
/// plan_frame() makes of its scene; arrays that have not changed keep their revisions. If a parameter changes for whose
/// value programs were compiled, it becomes one of PlanOptions::changing, so that this happens once. Files are read once:
/// what is written to them later has no effect.
class FramePlanner {
 public:
  /// What the options point to must outlive the planner.
  explicit FramePlanner(const PlanOptions& options);
  ~FramePlanner();
  /// The plan is valid until the next call. Null after an error.
  const Plan* plan(const scene::Scene& scene, support::Diagnostics& diagnostics);

 private:
  friend std::optional<Plan> plan_frame(const scene::Scene&, const PlanOptions&, support::Diagnostics&);
  PlanOptions options_;
  std::optional<threads::Workers> own_workers_;
  std::unique_ptr<Compiled> compiled_;  ///< in its scenes so far
  std::unique_ptr<Planner> planner_;    ///< of the last scene, if it could be planned
};

}  // namespace isoshade::render
