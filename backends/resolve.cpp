// SPDX-License-Identifier: Apache-2.0
#include "backends/resolve.h"

#include <algorithm>
#include <cstddef>

#include "compiler/functions/blending.h"
#include "compiler/support/assert.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::backends {

void halve(float* rgba, float* depth, int width, int height) {
  using Color = lanes::Float<4, 1>;
  const auto wide = static_cast<size_t>(width);
  const size_t columns = wide / 2, rows = static_cast<size_t>(height) / 2;
  // A pixel overwrites only samples that have been read.
  for (size_t y = 0; y < rows; ++y) {
    for (size_t x = 0; x < columns; ++x) {
      const size_t upper = 2 * y * wide + 2 * x, lower = upper + wide;
      const auto color_at = [&](size_t at) { return lanes::load_lanes<Color>(rgba + 4 * at); };
      const auto depth_at = [&](size_t at) { return depth[at]; };
      const auto mean = [&](const auto& at) {
        return functions::mean_of_four(at(upper), at(upper + 1), at(lower), at(lower + 1));
      };
      // NaN is one value, also where infinities cancel.
      lanes::store_lanes(rgba + 4 * (y * columns + x), from_bits_normal(bits(mean(color_at))));
      depth[y * columns + x] = lanes::from_bits_normal(lanes::bits(mean(depth_at)));
    }
  }
}

void resolve_color(const float (&sample)[4], int side, float (&pixel)[4]) {
  const lanes::FpGuard guard;
  constexpr int most = 16;
  support::assert_that(side * side <= most, "a pixel of too many samples");
  float rgba[4 * most], depth[most] = {};
  for (int i = 0; i < side * side; ++i) std::copy_n(sample, 4, rgba + 4 * i);
  resolve(rgba, depth, side, side, side);
  std::copy_n(rgba, 4, pixel);
}

}  // namespace isoshade::backends
