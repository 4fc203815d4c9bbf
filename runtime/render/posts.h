// SPDX-License-Identifier: Apache-2.0
// The post chain: which posts run over which images, and how long each image is kept.
#pragma once

#include <optional>
#include <vector>

#include "backends/backend.h"
#include "compiler/driver/driver.h"
#include "runtime/render/stats.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

/// One post that is run. Images are numbered: 0 is the one that was drawn, and step i makes image 1 + i.
struct PostStep {
  const driver::Post* post = nullptr;
  std::vector<float> record;  ///< its parameters and numbers of taps
  int width = 0, height = 0;  ///< of the image that it makes
  /// The image that it goes over, then those that its document lists; not_read where it does not look at it.
  std::vector<int> sources;
  size_t post_number = 0;  ///< in Scene::posts
  static constexpr int not_read = -1;
};

/// What is run for a scene, in order.
struct PostChain {
  std::vector<PostStep> steps;
  std::vector<int> last_reader;  ///< of each image: the last step that reads it, or none
  int result = 0;                ///< the image that the scene becomes
  static constexpr int none = -1;

  /// Whether an image made before is not needed any more after a step.
  bool is_done(size_t image, size_t step) const {
    return last_reader[image] <= static_cast<int>(step) && static_cast<int>(image) != result;
  }
};

/// A limit that keeps hostile scenes harmless: the pixels of all images at a time.
inline constexpr int64_t max_kept_pixels = int64_t{4} * scene::max_size * scene::max_size;

/// Works out the chain: leaves out posts that are switched off, and those whose images nobody reads then, and says so
/// in `skips`; with `skip` off all run. `documents`: of each post of the scene. The sizes are the frame's. Computed
/// under lanes::FpGuard, which the caller holds. Reports inputs and parameters that a document has not, a result
/// that is not of the frame's size, and images beyond the limit.
std::optional<PostChain> plan_posts(const scene::Scene& scene,
                                    const std::vector<const driver::Post*>& documents, int width, int height,
                                    bool skip, std::vector<Skip>& skips, support::Diagnostics& diagnostics);

/// Runs the chain over the frame's picture. Depth stays as it is.
bool run_posts(const PostChain& chain, const backends::Frame& frame, backends::Backend& backend,
               backends::Image& image, DrawStats& stats, support::Diagnostics& diagnostics);

}  // namespace isoshade::render
