// SPDX-License-Identifier: Apache-2.0
// Texture coordinates and mip levels; compiler/lower/sampling.h uses them.
#pragma once

#include "compiler/functions/logarithm.h"
#include "compiler/functions/rounding.h"
#include "compiler/functions/vector.h"

namespace isoshade::functions {

/// Repeats the texture: maps a texture coordinate to [0, 1).
/// Domain: all floats; infinities and NaN give 0.
/// Error: 1 ULP.
template <class F>
F wrap(F x) {
  return fract(select(abs(x) < infinity, x, F(0.0f)));
}

/// Repeats the texture mirrored: maps a texture coordinate to [0, 1], reflecting it at every integer.
/// Domain: all floats; infinities and NaN give 0.
/// Error: 0 ULP.
template <class F>
F mirror(F x) {
  const F magnitude = abs(x);
  const F within = select(magnitude < infinity, magnitude, F(0.0f));
  const F in_two = within - floor(within * 0.5f) * 2.0f;
  return select(in_two > 1.0f, 2.0f - in_two, in_two);
}

/// The mip level whose texels are the size of a pixel: the base-2 logarithm of the longer of the two screen-space
/// gradients of the texture coordinate, in texels per pixel.
/// Domain: all floats. +inf if squares overflow, -inf if both gradients are 0; a NaN gradient gives NaN or is ignored.
/// Error: 2 ULP of 1 + |result|.
template <class F, int N>
F mip_level(vec<F, N> along_x, vec<F, N> along_y) {
  return log2(max(dot(along_x, along_x), dot(along_y, along_y))) * 0.5f;
}

}  // namespace isoshade::functions
