// SPDX-License-Identifier: Apache-2.0
// Several samples a pixel: the picture is drawn larger, window by window, and each window is resolved to pixels. The
// samples of a window have the bits that they have in the whole picture, so the result does not depend on how the
// picture is divided.
#pragma once

#include <functional>
#include <span>

#include "backends/backend.h"
#include "runtime/render/stats.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

/// The samples of a pixel along each axis: 1, 2 or 4 for 1, 4 or 16 samples a pixel.
constexpr int samples_each_way(int samples) { return samples >= 16 ? 4 : samples >= 4 ? 2 : 1; }

/// A window has at most this many samples each way: 20 MiB of them.
inline constexpr int max_part_size = 1024;

/// Reports images for which the scene has too many samples: at most raster::max_image_size along each axis.
bool check_samples(const scene::Scene& scene, int width, int height, support::Diagnostics& diagnostics);

/// Replaces each two by two samples by their mean, separately for r, g, b, a and depth. Sides are even.
///
/// The mean of the (reversed) depth gives the best posts, of those that are not run for each sample. Fog over the resolved
/// picture should equal the mean of fog over each sample; in scenes/fog_valley.json the mean depth misses it by a root
/// mean square of 0.0022 in encoded color, and the nearest, the farthest, a fixed or the middle sample by 0.0027 to 0.0080.
void halve(backends::Image& image);

/// What is done to the samples of rows of the picture, of which the first is `first_row`, before they are resolved.
using ProcessSamples = std::function<bool(int first_row, backends::Image& samples)>;

/// Draws a view, whose target has samples_each_way(samples) samples in each pixel of the image along each axis; a
/// target without color has one sample a pixel. Notes pixels of the picture that are not finite. `process` may be empty;
/// it may use the backend.
bool draw(const backends::ViewPass& pass, int samples, std::span<const float> vertices,
          std::span<const int32_t> triangles, const ProcessSamples& process, backends::Backend& backend,
          backends::Image& image, DrawStats& stats, support::Diagnostics& diagnostics);

}  // namespace isoshade::render
