// SPDX-License-Identifier: Apache-2.0
// The post chain: which posts process which images, and how long each image is kept.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "backends/backend.h"
#include "compiler/driver/driver.h"
#include "runtime/render/stats.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

/// A post that runs. Images are numbered: 0 is the rendered image, and step i makes image 1 + i.
struct PostStep {
  const driver::Post* post = nullptr;
  std::vector<float> record;  ///< its parameters and numbers of taps
  int width = 0, height = 0;  ///< of its image
  /// The image that it processes, then those that its document lists; not_read if the program does not read it.
  std::vector<int> sources;
  size_t post_number = 0;  ///< in Scene::posts
  static constexpr int not_read = -1, motion = -2;  ///< motion: how far things have moved, which is not numbered
};

/// The posts that run for a scene, in order.
struct PostChain {
  std::vector<PostStep> steps;
  std::vector<int> last_reader;  ///< of each image: the last step that reads it, or none
  int result = 0;                ///< the image that the scene becomes
  /// How many steps at the beginning are run for each sample, where a pixel has several: up to the last one that reads
  /// the depth, if all of them look at no pixel but their own, and nothing else reads what they make. Posts that are
  /// left out count here, too.
  size_t sample_steps = 0;
  static constexpr int none = -1;

  bool reads_motion() const {
    return std::ranges::any_of(steps, [](const PostStep& step) {
      return std::ranges::find(step.sources, PostStep::motion) != step.sources.end();
    });
  }

  /// Whether no step after this one needs an earlier image.
  bool is_done(size_t image, size_t step) const {
    return last_reader[image] <= static_cast<int>(step) && static_cast<int>(image) != result;
  }
};

/// A limit that keeps hostile scenes harmless: the pixels of all images at a time.
inline constexpr int64_t max_kept_pixels = int64_t{4} * scene::max_size * scene::max_size;

/// Plans the chain: leaves out posts that are switched off and posts whose images are then unused, and records them in
/// `skipped`; without Skip::posts all run. `documents`: one for each post of the scene. The size is that of the frame. The
/// caller holds lanes::FpGuard. Reports inputs and parameters that a document does not have, a result that does not have
/// the size of the frame, and images beyond the limit.
std::optional<PostChain> plan_posts(const scene::Scene& scene,
                                    const std::vector<const driver::Post*>& documents, int width, int height,
                                    interface::Skips skips, std::vector<Skipped>& skipped, support::Diagnostics& diagnostics);

}  // namespace isoshade::render
