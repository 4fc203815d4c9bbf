// SPDX-License-Identifier: Apache-2.0
// Integrals over the hemisphere of lobes around GGX's microfacet normals.
#pragma once

#include <array>
#include <cmath>
#include <vector>

namespace isoshade::accuracy {

using Direction = std::array<double, 3>;

/// A light's direction and what its radiance counts for.
struct Sample {
  Direction half;   ///< unit
  Direction light;  ///< unit, above the surface
  double weight;
};

/// Midpoints of `count` squared normals, distributed about as D (n.h) for this roughness about n = z, and the lights that
/// they mirror to a viewer with this cosine. The integral of f (n.l) is the sum of f times weight.
inline std::vector<Sample> mirrored_lights(double roughness, double n_dot_v, int count) {
  const Direction v = {std::sqrt(1 - n_dot_v * n_dot_v), 0, n_dot_v};
  std::vector<Sample> all;
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < count; ++k) {
      const double w = (i + 0.5) / count, phi = 2 * M_PI * (k + 0.5) / count;
      const double tangent2 =
          roughness * roughness * (1 / (w * w * w) - 1);  // more of them in the lobe's long tail
      const double cosine = 1 / std::sqrt(1 + tangent2), sine = std::sqrt(tangent2) * cosine;
      const Direction h = {sine * std::cos(phi), sine * std::sin(phi), cosine};
      const double v_dot_h = v[0] * h[0] + v[2] * h[2];
      const Direction l = {2 * v_dot_h * h[0] - v[0], 2 * v_dot_h * h[1] - v[1], 2 * v_dot_h * h[2] - v[2]};
      if (v_dot_h <= 0 || l[2] <= 0) continue;
      // The density of h is D (n.h); that of l is less by 4 (v.h).
      const double root = (1 - cosine * cosine) + cosine * cosine * roughness * roughness;
      const double d = roughness * roughness / (M_PI * root * root);
      all.push_back({h, l, l[2] * 4 * v_dot_h / (d * cosine) * 3 * w * w / (count * count)});
    }
  }
  return all;
}

}  // namespace isoshade::accuracy
