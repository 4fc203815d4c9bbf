// SPDX-License-Identifier: Apache-2.0
// Several samples a pixel.
#pragma once

#include "compiler/support/diagnostics.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

/// The samples of a pixel along each axis: 1, 2 or 4 for 1, 4 or 16 samples a pixel.
constexpr int samples_each_way(int samples) { return samples >= 16 ? 4 : samples >= 4 ? 2 : 1; }

/// Reports images for which the scene has too many samples: at most raster::max_image_size along each axis.
bool check_samples(const scene::Scene& scene, int width, int height, support::Diagnostics& diagnostics);

}  // namespace isoshade::render
