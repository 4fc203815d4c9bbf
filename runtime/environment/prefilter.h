// SPDX-License-Identifier: Apache-2.0
// The maps of an environment: its radiance at each level of roughness, and its irradiance.
#pragma once

#include <vector>

#include "runtime/environment/rows.h"
#include "runtime/scene/texture.h"

namespace isoshade::environment {

/// functions::environment_levels levels of radiance, then the irradiance, all with a border.
using Maps = std::vector<scene::TextureLevel>;

struct PrefilterOptions {
  int lanes = 0;    ///< 1, 4, 8 or 16; 0: as many as the machine has
  int threads = 0;  ///< 0: as many as there are cores
};

/// Level 0 of an image. The image has at most 8192 texels a side, finite numbers and 1 or more rows and columns.
/// `rotate`: degrees about y. Negative numbers count as 0, and no number stays above 1e6.
Pyramid project(scene::TextureLevel image, float rotate, float intensity, const PrefilterOptions& options);

/// Fills the border of a level.
void fill_border(float* texels, int side);

/// Fills the levels of the pyramid from its level 0, whose border need not be filled.
void fill_levels(Pyramid& pyramid);

/// The maps of a pyramid whose levels are filled. The bits do not depend on the options.
Maps prefilter(const Pyramid& source, const PrefilterOptions& options);

/// The rays for a level of roughness whose lobes are narrow, from 1 on.
std::vector<Ray> rays_of_level(int level);

}  // namespace isoshade::environment
