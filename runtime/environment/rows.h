// SPDX-License-Identifier: Apache-2.0
// The rows of the maps: what each is computed from. Every texel has its own lane, and sums run in a fixed order, so the
// bits do not depend on the number of lanes. Callers hold an FpGuard.
#pragma once

#include <span>
#include <vector>

#include "compiler/functions/environment.h"

namespace isoshade::environment {

/// Texels have 4 floats: r g b, and 1.
inline constexpr int channels = 4;

/// An image in equirectangular projection. Its middle is at -z, its right half at +x, its top at +y.
struct Equirect {
  const float* texels;
  int width, height;
  float sin, cos;  ///< of the angle by which it is turned about y
};

/// How many rays go through a texel of the map that is made of an Equirect, in each direction.
inline constexpr int rays_each_way = 4;

/// The levels of a map in one array, each with its border. Level 0 has functions::environment_side texels a side.
struct Pyramid {
  static constexpr int levels = 7;
  static constexpr int side_of(int level) { return functions::environment_side >> level; }
  static constexpr int width_of(int level) { return side_of(level) + 2 * functions::environment_border; }

  int first[levels];  ///< the first float of each
  std::vector<float> texels;

  Pyramid();
  float* level(int l) { return texels.data() + first[l]; }
  const float* level(int l) const { return texels.data() + first[l]; }
};

/// A direction that reflects light to a viewer who looks along the normal, as many as the lobe has.
struct Ray {
  float x, along, z;  ///< of a unit vector: across the normal, along it
  float weight;
  float level;  ///< of the pyramid that has texels of the size of its share of the lobe, on the axes
};

/// A row of a level of the map of radiance whose lobes are narrow: the mean over some rays.
struct RaysJob {
  const Pyramid& source;
  std::span<const Ray> rays;
  int side;
};

/// A row of a level whose lobes are wide: the mean over all texels of a level of the source. With a roughness of 1
/// the weight is the cosine, and the mean is the irradiance divided by pi.
struct LobeJob {
  const Pyramid& source;
  int level;
  std::span<const float> directions;  ///< of its texels: x y z of a unit vector, and the solid angle
  float roughness;
  int side;
};

namespace detail {
#define ISOSHADE_ROWS(lanes)                                                    \
  void make_row_##lanes(const Equirect& image, int row, float* texels);       \
  void make_row_##lanes(const RaysJob& job, int row, float* texels);          \
  void make_row_##lanes(const LobeJob& job, int row, float* texels);
ISOSHADE_ROWS(1)
ISOSHADE_ROWS(4)
ISOSHADE_ROWS(8)
ISOSHADE_ROWS(16)
#undef ISOSHADE_ROWS
}  // namespace detail

}  // namespace isoshade::environment
