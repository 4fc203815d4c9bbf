// SPDX-License-Identifier: Apache-2.0
// What the tests of properties measure with.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "tests/accuracy/samples.h"

namespace isoshade::accuracy {

/// The unit in the last place of x.
inline double last_place(double x) {
  return x == 0 ? 0x1p-149 : std::ldexp(1.0, std::max(std::ilogb(x), -126) - 23);
}
inline float before(float x) { return from_order(order(x) - 1); }
inline float after(float x) { return from_order(order(x) + 1); }

class Random {
 public:
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
  }
  /// Spread over the sphere, of length 1 but for rounding.
  std::array<float, 3> direction() {
    double v[3], square = 0;
    do {
      square = 0;
      for (double& c : v) c = between(-1, 1), square += c * c;
    } while (square > 1 || square < 1e-4);
    std::array<float, 3> unit;
    for (size_t i = 0; i < 3; ++i) unit[i] = static_cast<float>(v[i] / std::sqrt(square));
    return unit;
  }

 private:
  std::mt19937_64 bits_{5};
};

}  // namespace isoshade::accuracy
