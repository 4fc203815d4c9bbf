// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/samples.h"

#include <algorithm>

#include "runtime/raster/clip.h"

namespace isoshade::render {

bool check_samples(const scene::Scene& scene, int width, int height, support::Diagnostics& diagnostics) {
  const int largest = raster::max_image_size / samples_each_way(scene.samples);
  if (std::max(width, height) <= largest) return true;
  diagnostics
      .report(support::Id::too_large, scene.samples_where,
              "an image of " + std::to_string(scene.samples) + " samples a pixel has at most " +
                  std::to_string(largest) + " pixels each way, and this one has " + std::to_string(width) +
                  "x" + std::to_string(height))
      .suggest("ask for fewer samples, or a smaller size");
  return false;
}

}  // namespace isoshade::render
