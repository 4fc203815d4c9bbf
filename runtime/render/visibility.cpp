// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/visibility.h"

#include <cmath>
#include <glm/vec4.hpp>

namespace isoshade::render {
namespace {

/// A corner in clip space, and for each coordinate the sum of magnitudes that bounds its rounding error. In double: it
/// decides what is drawn, never how.
struct Corner {
  double at[4];
  double magnitude[4];
};

Corner project(const glm::mat4& projected, double x, double y, double z) {
  Corner corner{};
  for (int r = 0; r < 4; ++r) {
    const double terms[4] = {projected[0][r] * x, projected[1][r] * y, projected[2][r] * z, projected[3][r]};
    for (const double term : terms) {
      corner.at[r] += term;
      corner.magnitude[r] += std::abs(term);
    }
  }
  return corner;
}

}  // namespace

bool outside_view(const glm::vec3& low, const glm::vec3& high, const glm::mat4& projected, int width,
                  int height) {
  // A point is left of the view if x + w < 0, and so on. All of these are linear, so the corners decide.
  // The sides get a margin of a pixel, for snapping; all planes get one of 2^-16 of the terms, for rounding in float.
  const double wide = 1 + 2.0 / width;
  const double tall = 1 + 2.0 / height;
  constexpr double rounding = 0x1p-16;
  struct Plane {
    double x, y, z, w;
  };
  const Plane planes[] = {
      {1, 0, 0, wide}, {-1, 0, 0, wide}, {0, 1, 0, tall}, {0, -1, 0, tall}, {0, 0, -1, 1}};
  bool outside[5] = {true, true, true, true, true};
  for (int i = 0; i < 8; ++i) {
    const Corner corner = project(projected, (i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                                  (i & 4) != 0 ? high.z : low.z);
    for (int p = 0; p < 5; ++p) {
      const double plane[4] = {planes[p].x, planes[p].y, planes[p].z, planes[p].w};
      double distance = 0;
      double magnitude = 0;
      for (int r = 0; r < 4; ++r) {
        distance += plane[r] * corner.at[r];
        magnitude += std::abs(plane[r]) * corner.magnitude[r];
      }
      outside[p] = outside[p] && distance < -rounding * magnitude;  // false for NaN and infinities
    }
  }
  return outside[0] || outside[1] || outside[2] || outside[3] || outside[4];
}

}  // namespace isoshade::render
