// SPDX-License-Identifier: Apache-2.0
// Texture coordinates and mip levels. What is made of them: compiler/lower/sampling.h.
#pragma once

#include "compiler/functions/logarithm.h"
#include "compiler/functions/rounding.h"
#include "compiler/functions/vector.h"

namespace isoshade::functions {

/// A texture coordinate brought into [0, 1) by leaving out whole pictures.
/// Domain: all floats; infinities and NaN give 0.
/// Error: 1 ULP.
template <class F>
F wrap(F x) {
  return fract(select(abs(x) < infinity, x, F(0.0f)));
}

/// A texture coordinate brought into [0, 1] by mirrors at all whole numbers.
/// Domain: all floats; infinities and NaN give 0.
/// Error: 0 ULP.
template <class F>
F mirror(F x) {
  const F magnitude = abs(x);
  const F within = select(magnitude < infinity, magnitude, F(0.0f));
  const F in_two = within - floor(within * 0.5f) * 2.0f;
  return select(in_two > 1.0f, 2.0f - in_two, in_two);
}

/// The mip level whose texels are as large as a pixel: the logarithm to base 2 of the longer of two gradients, each
/// what the place in the texture changes by along one side of a pixel, in texels.
/// Domain: all floats. +inf where squares overflow, -inf where both gradients are 0; NaN or by the other where one is.
/// Error: 2 ULP of 1 + |result|.
template <class F, int N>
F mip_level(vec<F, N> along_x, vec<F, N> along_y) {
  return log2(max(dot(along_x, along_x), dot(along_y, along_y))) * 0.5f;
}

}  // namespace isoshade::functions
