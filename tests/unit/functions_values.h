// SPDX-License-Identifier: Apache-2.0
// Floats at which functions are likely to go wrong, and comparison by bits.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "compiler/ir/float_bits.h"

namespace isoshade::functions {

inline constexpr float inf = std::numeric_limits<float>::infinity();
inline constexpr float nan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float tiny = 0x1p-126f;
inline constexpr float huge = 0x1.fffffep127f;
inline constexpr float pi = 0x1.921fb6p1f;

/// What a stored float would be.
inline uint32_t bits_of(float x) { return ir::canonical_float(std::bit_cast<uint32_t>(x)); }

/// Hides a value from the optimiser, which else computes in its own float mode.
inline float hidden(float x) {
  volatile float value = x;
  return value;
}

inline const std::vector<float>& special_floats() {
  static const std::vector<float> values = [] {
    std::vector<float> list{0.0f, inf, nan, tiny, huge};
    for (float x :
         {1.0f,    0.5f,      2.0f,      3.0f,       1e-30f,   1e30f,  0x1p-24f,   0x1p-63f,   0x1p23f,
          0x1p24f, 0x1p31f,   0x1p64f,   0.0031308f, 0.04045f, 0.28f,  0.7071067f, 1.4142135f, pi,
          pi / 2,  87.33654f, 88.72284f, 126.0f,     127.0f,   128.0f, 129.0f,     8192.0f,    131072.0f})
      for (int step : {-1, 0, 1}) list.push_back(std::bit_cast<float>(std::bit_cast<int32_t>(x) + step));
    list.push_back(std::bit_cast<float>(std::bit_cast<int32_t>(tiny) + 1));
    list.push_back(std::bit_cast<float>(std::bit_cast<int32_t>(huge) - 1));
    for (size_t i = 0, n = list.size(); i < n; ++i) list.push_back(-list[i]);
    return list;
  }();
  return values;
}

/// A special float, any float, or one of moderate size.
template <class Random>
float any_float(Random& random) {
  const auto word = static_cast<uint32_t>(random());
  switch (random() % 4) {
    case 0: return special_floats()[word % special_floats().size()];
    case 1: return std::bit_cast<float>(ir::canonical_float(word));
    default: return static_cast<float>(static_cast<int32_t>(word)) * 0x1p-28f;
  }
}

}  // namespace isoshade::functions
