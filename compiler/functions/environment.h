// SPDX-License-Identifier: Apache-2.0
// The maps of an environment: which direction is where, and which level has which roughness. Kernels read the maps by
// this, and the runtime makes them by it. Both are squares in octahedral form (Cigolle et al. 2014), with y as the axis:
// the upper half of the sphere is the diamond in the middle of the square.
#pragma once

#include "compiler/functions/comparison.h"
#include "compiler/functions/vector.h"

namespace isoshade::functions {

/// The levels of the map of radiance: texels of each side. Texels are narrower than the lobes, because bilinear filters show
/// the folds of the octahedron where texels are wide.
inline constexpr int environment_sides[] = {512, 256, 256, 128, 64, 64, 64, 64};
inline constexpr int environment_levels = static_cast<int>(sizeof environment_sides / sizeof environment_sides[0]);
inline constexpr int environment_side = environment_sides[0];
/// Texels of each side of the map of irradiance.
inline constexpr int irradiance_side = 64;
/// Around each level lie texels that repeat those beyond its edges, so that filters need not wrap around.
inline constexpr int environment_border = 1;

/// The place of a direction of any length but 0: (0, 0) is one corner of the square, (1, 1) the opposite one.
/// Domain: all floats; 0, infinities and NaN give places in the square.
/// Error: 2e-7.
template <class F>
vec<F, 2> octahedral_place(vec<F, 3> direction) {
  const F sum = (abs(direction[0]) + abs(direction[1])) + abs(direction[2]);
  const F x = direction[0] / sum, z = direction[2] / sum;
  const bool_of<F> above = direction[1] >= 0.0f;
  const auto unfolded = [&](F here, F other) {
    const F away = 1.0f - abs(other);
    return select(above, here, select(here < 0.0f, negate(away), away));
  };
  // NaN becomes 0.
  const auto fraction = [](F from_middle) {
    const F at = from_middle * 0.5f + 0.5f;
    return select(at > 0.0f, select(at < 1.0f, at, F(1.0f)), F(0.0f));
  };
  return {fraction(unfolded(x, z)), fraction(unfolded(z, x))};
}

/// A direction at a place in the square; its length is between 0.57 and 1.
/// Domain: [0, 1].
/// Error: 2e-7.
template <class F>
vec<F, 3> octahedral_direction(vec<F, 2> place) {
  const F x = place[0] * 2.0f - 1.0f, z = place[1] * 2.0f - 1.0f;
  const F y = (1.0f - abs(x)) - abs(z);
  const F below = max(F(0.0f) - y, F(0.0f));
  const auto folded = [&](F at) { return select(at < 0.0f, at + below, at - below); };
  return {folded(x), y, folded(z)};
}

/// The level of a roughness (alpha of GGX), 0 to the last level: with p = sqrt(roughness), p (3 - p) / 2 of the last
/// level.
/// Domain: all floats; NaN counts as 0, and what is beyond [0, 1] as the nearer end.
/// Error: 3 ULP.
template <class F>
F environment_level(F roughness) {
  const F from_0 = select(roughness > 0.0f, roughness, F(0.0f));
  const F p = sqrt(select(from_0 < 1.0f, from_0, F(1.0f)));
  return (p * (3.0f - p)) * (0.5f * static_cast<float>(environment_levels - 1));
}

/// The roughness of a level: the inverse of environment_level.
/// Domain: [0, environment_levels - 1].
template <class F>
F environment_roughness(F level) {
  const F p = 1.5f - sqrt(2.25f - level / (0.5f * static_cast<float>(environment_levels - 1)));
  return p * p;
}

}  // namespace isoshade::functions
