// SPDX-License-Identifier: Apache-2.0
// Random numbers that are the same on every machine (splitmix64, Steele et al. 2014).
#pragma once

#include <cstdint>

namespace isoshade::vulkan {

class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}

  uint32_t bits() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<uint32_t>((z ^ (z >> 31)) >> 32);
  }
  /// From first to last, both included.
  int between(int first, int last) {
    return first + static_cast<int>(bits() % static_cast<uint32_t>(last - first + 1));
  }

 private:
  uint64_t state_;
};

}  // namespace isoshade::vulkan
