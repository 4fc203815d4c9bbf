// SPDX-License-Identifier: Apache-2.0
// Octahedral encoding of unit vectors in one float: a point on the unit octahedron, unfolded to a grid of 4095 x 4095
// points, as column + 4096 * row. Source: Cigolle et al. 2014, A Survey of Efficient Representations for Independent
// Unit Vectors.
#pragma once

#include "compiler/functions/comparison.h"

namespace isoshade::functions {

inline constexpr float octahedral_half = 2047.0f;  ///< steps from the centre of the square to its edge
inline constexpr float octahedral_rows = 4096.0f;

/// Moves `x` towards 0 by `by`: folds the lower half.
template <class F>
F folded(F x, F by) {
  return select(x < 0.0f, x + by, x - by);
}

/// Decodes a vector; its length is between 0.57 and 1.
/// Domain: results of octahedral_encode.
/// Error: axis directions are exact; others differ by at most 1.1e-3 radians.
template <class F>
vec<F, 3> octahedral_decode(F packed) {
  const F row = floor(packed * (1.0f / octahedral_rows));
  const F column = packed - row * octahedral_rows;
  const F x = (column - octahedral_half) / octahedral_half;
  const F y = (row - octahedral_half) / octahedral_half;
  const F z = (1.0f - abs(x)) - abs(y);
  const F below = max(F(0.0f) - z, F(0.0f));
  return {folded(x, below), folded(y, below), z};
}

/// Encodes the direction of a vector of any positive length.
inline float octahedral_encode(vec<float, 3> v) {
  const float sum = abs(v[0]) + abs(v[1]) + abs(v[2]);
  float x = v[0] / sum, y = v[1] / sum;
  if (v[2] < 0.0f) {
    const float unfolded_x = (1.0f - abs(y)) * (x < 0.0f ? -1.0f : 1.0f);
    y = (1.0f - abs(x)) * (y < 0.0f ? -1.0f : 1.0f);
    x = unfolded_x;
  }
  const float column = floor(x * octahedral_half + octahedral_half + 0.5f);
  const float row = floor(y * octahedral_half + octahedral_half + 0.5f);
  return column + octahedral_rows * row;
}

}  // namespace isoshade::functions
