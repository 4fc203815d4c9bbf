// SPDX-License-Identifier: Apache-2.0
// How long each step of each frame takes: the table of `render --frames --stats`, and its JSON.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/render/stats.h"

namespace isoshade::cli {

// STEP(name, what it does for the schema)
#define ISOSHADE_STEPS(STEP)                                                                       \
  STEP(load, "reads the scene, or makes it for the time of the frame")                             \
  STEP(plan, "compiles effects to programs, makes meshes and textures, and lists what views draw") \
  STEP(build, "compiles machine code and shaders, or finds them in the cache")                     \
  STEP(vertices, "runs the vertex programs")                                                       \
  STEP(clip, "clips triangles and snaps them to the grid")                                         \
  STEP(draw, "finds what is visible and shades it")                                                \
  STEP(posts, "runs the chain of posts")                                                           \
  STEP(write, "encodes the picture and writes it")                                                 \
  STEP(frame, "the whole frame, with what is in no other step")

#define ISOSHADE_STEP(name, doc) name,
enum class Step : size_t { ISOSHADE_STEPS(ISOSHADE_STEP) };
#undef ISOSHADE_STEP
#define ISOSHADE_STEP(name, doc) +1
inline constexpr size_t step_count = 0 ISOSHADE_STEPS(ISOSHADE_STEP);
#undef ISOSHADE_STEP

/// The seconds of each step of a frame.
class StepTimes {
 public:
  double& operator[](Step step) { return seconds_[static_cast<size_t>(step)]; }
  double operator[](Step step) const { return seconds_[static_cast<size_t>(step)]; }

 private:
  std::array<double, step_count> seconds_{};
};

/// What was measured.
struct Measured {
  std::string scene, backend;
  int threads = 1, width = 0, height = 0, samples = 1;
  int64_t kept_frames = 0;        ///< were as the one before, and not drawn
  int64_t views = 0, kept_views = 0;  ///< of all frames: shadow maps and pictures, and those that were not drawn
  std::vector<StepTimes> frames;  ///< in their order; at least one
  std::vector<render::Skipped> skipped;  ///< of the first frame
};

/// A table in milliseconds: the first frame, and of the others median, quartiles and the distance between these.
std::string text(const Measured& measured);
/// The same and the times of each frame, by the schema.
std::string json(const Measured& measured);
/// The JSON Schema (draft-07) of json().
std::string measured_schema();

}  // namespace isoshade::cli
