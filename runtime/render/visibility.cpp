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

/// The corners of a box; false if a coordinate is not finite.
bool project(const glm::mat4& projected, const glm::vec3& low, const glm::vec3& high, Corner (&corners)[8]) {
  bool is_finite = true;
  for (int r = 0; r < 4; ++r) {
    double terms[3][2];
    for (int axis = 0; axis < 3; ++axis) {
      terms[axis][0] = double{projected[axis][r]} * double{low[axis]};
      terms[axis][1] = double{projected[axis][r]} * double{high[axis]};
    }
    const double offset = projected[3][r];
    for (int i = 0; i < 8; ++i) {
      const double x = terms[0][i & 1], y = terms[1][i >> 1 & 1], z = terms[2][i >> 2];
      corners[i].at[r] = x + y + z + offset;
      corners[i].magnitude[r] = std::abs(x) + std::abs(y) + std::abs(z) + std::abs(offset);
      is_finite = is_finite && std::isfinite(corners[i].magnitude[r]);
    }
  }
  return is_finite;
}

}  // namespace

bool outside_view(const glm::vec3& low, const glm::vec3& high, const glm::mat4& projected, int width,
                  int height) {
  // A point is left of the view if x + w < 0, and so on. All of these are linear, so the corners decide.
  // The sides get a margin of a pixel, for snapping; all planes get one of 2^-16 of the terms, for rounding in float.
  const double wide = 1 + 2.0 / width;
  const double tall = 1 + 2.0 / height;
  constexpr double rounding = 0x1p-16;
  Corner corners[8];
  if (!project(projected, low, high, corners)) return false;
  const auto is_outside = [&](int r, double sign, double w) {
    for (const Corner& corner : corners) {
      const double distance = sign * corner.at[r] + w * corner.at[3];
      const double magnitude = corner.magnitude[r] + w * corner.magnitude[3];
      if (!(distance < -rounding * magnitude)) return false;
    }
    return true;
  };
  return is_outside(0, 1, wide) || is_outside(0, -1, wide) || is_outside(1, 1, tall) || is_outside(1, -1, tall) ||
         is_outside(2, -1, 1);
}

}  // namespace isoshade::render
