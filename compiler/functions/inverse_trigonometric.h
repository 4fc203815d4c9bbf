// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/functions/body.h"

namespace isoshade::functions {

/// The angle from the x axis to the point (x, y), in [-pi, pi].
/// Domain: all floats; NaN gives NaN. As IEEE-754, except that -0 counts as +0: atan2(-0, -1) = pi.
/// Error: 2 ULP.
/// Source: polynomial by Sollya's fpminimax on [0, 1]; pi in 24 + 24 bits.
template <class F>
F atan2(F y, F x) {
  const F height = abs(y);
  const F width = abs(x);
  const auto steep = height > width;
  const F lesser = select(steep, width, height);
  const F greater = select(steep, height, width);
  const F ratio = select(lesser < greater, lesser / greater, select(lesser > 0.0f, F(1.0f), lesser));
  const F s = ratio * ratio;
  const F q =
      polynomial(s, {-0x1.449a16p-9f, 0x1.c62ea6p-7f, -0x1.2a759ap-5f, 0x1.01e514p-4f, -0x1.636df2p-4f,
                     0x1.c423eep-4f, -0x1.246f74p-3f, 0x1.99984cp-3f, -0x1.555554p-2f});
  const F flat = ratio + (ratio * s) * q;
  const F right = select(steep, (0x1.921fb6p0f - flat) + -0x1.777a5cp-25f, flat);
  const F upper = select(x < 0.0f, (0x1.921fb6p1f - right) + -0x1.777a5cp-24f, right);
  return select(x == x, select(y < 0.0f, negate(upper), upper), x);
}

/// The angle in [-pi/2, pi/2] whose tangent is x.
/// Domain: all floats; NaN gives NaN.
/// Error: 2 ULP.
template <class F>
F atan(F x) {
  return atan2(x, F(1.0f));
}

/// The angle in [-pi/2, pi/2] whose sine is x.
/// Domain: [-1, 1]; other arguments give NaN.
/// Error: 3 ULP.
template <class F>
F asin(F x) {
  return atan2(x, sqrt((1.0f - x) * (1.0f + x)));
}

/// The angle in [0, pi] whose cosine is x.
/// Domain: [-1, 1]; other arguments give NaN.
/// Error: 2.5 ULP.
template <class F>
F acos(F x) {
  return atan2(sqrt((1.0f - x) * (1.0f + x)), x);
}

}  // namespace isoshade::functions
