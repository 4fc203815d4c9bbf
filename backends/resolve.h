// SPDX-License-Identifier: Apache-2.0
// From samples to pixels.
#pragma once

namespace isoshade::backends {

/// Replaces each two by two samples by their mean, in place and separately for r, g, b, a and the depth. Sides are even;
/// rows of the result are half as long. The caller holds a lanes::FpGuard.
///
/// The mean of the (reversed) depth gives the best posts, of those that are not run for each sample. Fog over the resolved
/// picture should equal the mean of fog over each sample; in scenes/fog_valley.json the mean depth misses it by a root
/// mean square of 0.0022 in encoded color, and the nearest, the farthest, a fixed or the middle sample by 0.0027 to 0.0080.
void halve(float* rgba, float* depth, int width, int height);

/// Halves until each pixel had `side` x `side` samples.
inline void resolve(float* rgba, float* depth, int width, int height, int side) {
  for (; side > 1; side /= 2, width /= 2, height /= 2) halve(rgba, depth, width, height);
}

/// The color of a pixel all of whose `side` x `side` samples have this one.
void resolve_color(const float (&sample)[4], int side, float (&pixel)[4]);

}  // namespace isoshade::backends
