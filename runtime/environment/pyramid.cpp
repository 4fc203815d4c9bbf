// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "runtime/environment/prefilter.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::environment {
namespace {

/// The solid angle of a texel, of any unit: a square of the unfolded octahedron has 1 / distance^3.
float solid_angle(int x, int y, int side) {
  const float size = static_cast<float>(side);
  const auto place = [&](int at) { return (static_cast<float>(at) + 0.5f) / size; };
  const auto d = functions::octahedral_direction(lanes::vec<float, 2>(place(x), place(y)));
  const float square = (d.x * d.x + d.y * d.y) + d.z * d.z;
  return 1.0f / (square * lanes::sqrt(square));
}

}  // namespace

Pyramid::Pyramid() {
  int next = 0;
  for (int l = 0; l < levels; ++l) {
    first[l] = next;
    next += channels * width_of(l) * width_of(l);
  }
  texels.resize(static_cast<size_t>(next));
}

void fill_border(float* texels, int side) {
  const int width = side + 2;
  const auto copy = [&](int from_x, int from_y, int x, int y) {
    std::copy_n(texels + channels * (from_y * width + from_x), channels, texels + channels * (y * width + x));
  };
  // Beyond an edge of the square lies its other half, for two halves of an edge are the same fold. All four corners are
  // one point.
  for (int i = 1; i <= side; ++i) {
    const int other = side + 1 - i;
    copy(1, other, 0, i);
    copy(side, other, side + 1, i);
    copy(other, 1, i, 0);
    copy(other, side, i, side + 1);
  }
  for (const int x : {0, side + 1})
    for (const int y : {0, side + 1}) copy(x == 0 ? side : 1, y == 0 ? side : 1, x, y);
}

void fill_levels(Pyramid& pyramid) {
  const lanes::FpGuard guard;
  fill_border(pyramid.level(0), Pyramid::side_of(0));
  for (int l = 1; l < Pyramid::levels; ++l) {
    const int side = Pyramid::side_of(l), width = Pyramid::width_of(l), finer = Pyramid::width_of(l - 1);
    const float* const from = pyramid.level(l - 1);
    float* const to = pyramid.level(l);
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        float sum[channels] = {}, weights = 0;
        for (int i = 0; i < 4; ++i) {
          const int fine_x = 2 * x + (i & 1), fine_y = 2 * y + (i >> 1);
          const float weight = solid_angle(fine_x, fine_y, 2 * side);
          const float* const texel = from + channels * ((fine_y + 1) * finer + fine_x + 1);
          for (int c = 0; c < channels; ++c) sum[c] += texel[c] * weight;
          weights += weight;
        }
        float* const texel = to + channels * ((y + 1) * width + x + 1);
        for (int c = 0; c < channels; ++c) texel[c] = sum[c] / weights;
      }
    }
    fill_border(to, side);
  }
}

}  // namespace isoshade::environment
