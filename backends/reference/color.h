// SPDX-License-Identifier: Apache-2.0
// Color functions as their standards define them, over any number type.
#pragma once

#include "backends/reference/geometry.h"

namespace isoshade::reference {

/// IEC 61966-2-1; the pieces meet at the float nearest to 0.0031308. Values outside [0, 1] are clamped.
template <class R>
R srgb_encode(R x) {
  x = saturate(x);
  if (x <= R(0.0031308f)) return x * 1292 / 100;
  return R(1055) / 1000 * pow(x, R(10) / 24) - R(55) / 1000;
}
template <class R>
R srgb_decode(R x) {
  x = saturate(x);
  if (x <= R(4045) / 100000) return x * 100 / 1292;
  return pow((x + R(55) / 1000) / (R(1055) / 1000), R(24) / 10);
}

template <class R>
R luminance(Vector<R, 3> c) {
  return (2126 * c[0] + 7152 * c[1] + 722 * c[2]) / 10000;
}

/// The six cases of the textbook.
template <class R>
Vector<R, 3> hsv_to_rgb(Vector<R, 3> hsv) {
  const R h = 6 * (hsv[0] - floor(hsv[0])), s = hsv[1], v = hsv[2];
  const auto sixth = static_cast<int64_t>(h);
  const R f = h - sixth;
  const R p = v * (1 - s), q = v * (1 - s * f), t = v * (1 - s * (1 - f));
  switch (sixth) {
    case 0: return {{v, t, p}};
    case 1: return {{q, v, p}};
    case 2: return {{p, v, t}};
    case 3: return {{p, q, v}};
    case 4: return {{t, p, v}};
    default: return {{v, p, q}};
  }
}
template <class R>
Vector<R, 3> hsv_magnitude(Vector<R, 3> hsv) {
  return vector<3>([&](int) { return abs(hsv[2]); });
}
template <class R>
Vector<R, 3> rgb_to_hsv(Vector<R, 3> c) {
  const R most = std::max({c[0], c[1], c[2]}), least = std::min({c[0], c[1], c[2]});
  if (most == least || most <= 0) return {{0, 0, most}};
  const int k = c[0] == most ? 0 : c[1] == most ? 1 : 2;
  const R h = (2 * k + (c[(k + 1) % 3] - c[(k + 2) % 3]) / (most - least)) / 6;
  return {{h < 0 ? h + 1 : h, (most - least) / most, most}};
}

}  // namespace isoshade::reference
