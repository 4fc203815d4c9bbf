// SPDX-License-Identifier: Apache-2.0
// The maps of an environment: which direction is where, and which level has which roughness. Kernels read the maps by
// this, and the runtime makes them by it. Both are squares in octahedral form (Cigolle et al. 2014), with y as the axis:
// the upper half of the sphere is the diamond in the middle of the square.
#pragma once

#include "compiler/functions/comparison.h"
#include "compiler/functions/vector.h"

namespace isoshade::functions {

/// The levels of the map of radiance, and the texels of each side: each level has half of those before, but not fewer than
/// the last.
inline constexpr int environment_levels = 7;
inline constexpr int environment_side = 512, environment_last_side = 32;
constexpr int environment_side_of(int level) {
  const int side = environment_side >> level;
  return side > environment_last_side ? side : environment_last_side;
}
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

/// The level of a roughness (alpha of GGX), 0 to the last level: with p = sqrt(roughness), p (2 - p) of the last level.
/// So the lobes of the levels are wider than their texels, and grow evenly.
/// Domain: all floats; NaN counts as 0, and what is beyond [0, 1] as the nearer end.
/// Error: 3 ULP.
template <class F>
F environment_level(F roughness) {
  const F from_0 = select(roughness > 0.0f, roughness, F(0.0f));
  const F p = sqrt(select(from_0 < 1.0f, from_0, F(1.0f)));
  return (p * (2.0f - p)) * static_cast<float>(environment_levels - 1);
}

/// The roughness of a level: the inverse of environment_level.
/// Domain: [0, environment_levels - 1].
template <class F>
F environment_roughness(F level) {
  const F p = 1.0f - sqrt(1.0f - level / static_cast<float>(environment_levels - 1));
  return p * p;
}

}  // namespace isoshade::functions
