// SPDX-License-Identifier: Apache-2.0
// The transfer function of sRGB in the fast tier: one polynomial for the whole curve, in the distance from
// its lower end, which keeps rounding small. Both directions rise
// monotonically over all floats.
#pragma once

#include "compiler/functions/comparison.h"

namespace isoshade::functions::fast {

/// Linear light to sRGB.
/// Domain: all floats; below 0 and NaN give 0, above 1 gives 1. Exact at 0 and 1.
/// Error: 115 ULP, 7e-6 of the result.
/// Source: of the fourth root; polynomial by Sollya's fpminimax.
template <class F>
F srgb_encode(F x) {
  constexpr float joint = 0x1.4b5da4p-5f;
  const F curve = polynomial(sqrt(sqrt(x)) - 0x1.e4p-3f,
                             {0x1.85f5c2p-4f, -0x1.1e6a86p-2f, 0x1.894b7ep-2f, -0x1.a1c73cp-2f,
                              0x1.e3eaf2p-1f, 0x1.58298ep-1f, 0x1.4a2b3p-5f});
  const F within = select(x <= 0.0031308f, min(x * 12.92f, F(joint)), max(curve, F(joint)));
  const F below_one = select(x < 1.0f, min(within, F(1.0f)), F(1.0f));
  return select(x > 0.0f, below_one, F(0.0f));
}

/// sRGB to linear light.
/// Domain: all floats; below 0 and NaN give 0, above 1 gives 1. Exact at 0 and 1.
/// Error: 35 ULP, 2e-6 of the result.
/// Source: of sqrt(x + 0.055), to whose power of 4.8 the curve rises; polynomial by Sollya's fpminimax.
template <class F>
F srgb_decode(F x) {
  const F curve =
      polynomial(sqrt(x + 0.055f) - 0x1.3cp-2f, {-0x1.1c797cp-5f, 0x1.51ca2p-1f, 0x1.5260dep0f, 0x1.cd365p-1f,
                                                 0x1.3166e2p-2f, 0x1.8cb80ap-5f, 0x1.9818b6p-9f});
  const F within = select(x <= 0.04045f, x * 0x1.3d0722p-4f, max(curve, F(0x1.9a5c62p-9f)));
  const F below_one = select(x < 1.0f, min(within, F(1.0f)), F(1.0f));
  return select(x > 0.0f, below_one, F(0.0f));
}

}  // namespace isoshade::functions::fast
