// SPDX-License-Identifier: Apache-2.0
// What was drawn, what was skipped and why: `render --stats`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "backends/backend.h"
#include "compiler/driver/skipped.h"
#include "runtime/render/finite.h"

namespace isoshade::render {

using driver::Skipped;

struct PlanStats {
  int64_t copies = 0;                     ///< of all objects, those skipped too
  int64_t draws = 0;                      ///< passes over parts of copies, of all views
  int64_t repetitions = 0;                ///< draws of passes that are repeated
  int64_t repeated = 0;                   ///< passes over parts of copies that are repeated
  int64_t vertices = 0, triangles = 0;    ///< of all draws
  int64_t meshes = 0, mesh_vertices = 0;  ///< stored
  int64_t effects = 0, programs = 0;      ///< compiled
  int64_t textures = 0, texels = 0;       ///< stored; with mip levels
  bool environment = false;
  bool environment_cached = false;  ///< its maps were found in the cache
  bool environment_kept = false;    ///< its maps are those of the frame before
  double environment_seconds = 0;   ///< to compute or find its maps
  int64_t texture_bytes = 0;              ///< that they take
  int64_t lights = 0;
  int64_t left_out_lights = 0;  ///< summed over what is drawn: lights that it does not sum up
  int64_t posts = 0;  ///< that are run
  int64_t sample_posts = 0;  ///< of them, those that are run for each sample
  double compile_seconds = 0, plan_seconds = 0;
  std::vector<Skipped> skips;       ///< of this frame
  std::vector<Skipped> in_programs;  ///< of the programs, when they were compiled
};

struct DrawStats {
  int64_t triangles = 0;      ///< left by clipping and culling
  int64_t made_vertices = 0;  ///< by clipping
  int samples = 1;            ///< a pixel
  int64_t views = 0;          ///< of the frame: shadow maps, the picture
  int64_t kept_views = 0;     ///< that show what they showed in the last frame, and were not drawn again
  bool is_kept = false;       ///< nothing has changed since the last frame, and nothing was drawn
  int64_t kept_images = 0;    ///< the most images that the post chain kept at a time, with the new one
  int64_t fused_posts = 0;    ///< posts that were run right after what is before them, pixel by pixel
  backends::TileCounts tiles;
  std::vector<Skipped> skips;  ///< while the frame was drawn
  NonFiniteReport non_finite;
  double build_seconds = 0;  ///< the backend's, for machine code; not part of the following
  std::vector<backends::DeviceStep> device;  ///< the steps of this frame on a device
  double transform_seconds = 0, clip_seconds = 0, draw_seconds = 0, post_seconds = 0;
};

/// Lines of text, each with its end.
std::string text(const PlanStats& stats);
std::string text(const DrawStats& stats);

}  // namespace isoshade::render
