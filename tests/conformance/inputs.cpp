// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <bit>

#include "tests/conformance/cases.h"

namespace isoshade::conformance {

namespace {

constexpr std::array<uint32_t, 36> special_floats{
    0x00000000, 0x80000000,                          // zeros
    0x00000001, 0x807fffff,                          // denormal bits
    0x00800000, 0x80800000, 0x00800001, 0x00ffffff,  // the smallest normals
    0x7f7fffff, 0xff7fffff, 0x7f000000,              // the largest
    0x7f800000, 0xff800000,                          // infinities
    0x7fc00000, 0xffc00001, 0x7f800001, 0x7fabcdef,  // NaN payloads, quiet and signalling
    0x3f800000, 0xbf800000, 0x3f7fffff, 0x3f800001, 0x3f000000, 0x3effffff, 0x40000000,
    0x40490fdb, 0x4b000000, 0x4b7fffff, 0xcb000001, 0x4effffff, 0x4f000000, 0xcf000000,  // around 2^23, 2^31
    0x20000000, 0x1f800001, 0x1fffffff, 0x5f7fffff,  // products that fall just below or above the normals
    0x43000000};

constexpr std::array<uint32_t, 16> special_ints{
    0,          1,          0xffffffff, 0x7fffffff, 0x80000000, 0x80000001, 0x00800000, 0x007fffff,
    0x7f800000, 0x3f800000, 31,         32,         0x0000ffff, 0xffff0000, 0x01000001, 0xfeffffff};

/// splitmix64 (Steele, Lea, Flood 2014).
class Random {
 public:
  uint32_t bits() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<uint32_t>((z ^ (z >> 31)) >> 32);
  }
  uint32_t below(uint32_t n) { return static_cast<uint32_t>((uint64_t{bits()} * n) >> 32); }

 private:
  uint64_t state_ = 2026;
};

uint32_t enter(uint32_t bits) {
  if ((bits & 0x7f800000u) == 0) return bits & 0x80000000u;
  if ((bits & 0x7fffffffu) > 0x7f800000u) return 0x7fc00000u;
  return bits;
}

}  // namespace

std::vector<int32_t> inputs(size_t rows) {
  Random random;
  std::vector<int32_t> words;
  words.reserve(rows * input_words);
  const auto any_float = [&](size_t row) -> uint32_t {
    switch (row % 4) {
      case 0: return random.bits();
      case 1: return 0x3f800000u - (random.bits() >> 8);  // (0.125, 1]
      case 2:
        return (random.bits() & 0x80ffffffu) | (60 + random.below(40)) << 23;  // magnitudes near tininess
      default: return (random.bits() & 0x807fffffu) | (120 + random.below(20)) << 23;
    }
  };
  for (size_t row = 0; row < rows; ++row) {
    std::array<uint32_t, 3> f;
    const size_t n = special_floats.size();
    if (row < n * n * 4) {  // every pair of specials, with four thirds
      f = {special_floats[row % n], special_floats[row / n % n], special_floats[random.below(n)]};
    } else {
      f = {any_float(row), any_float(row), any_float(row)};
      if (row % 8 >= 6) f[1] = f[0] + random.below(7) - 3;  // near-equal
      if (row % 16 == 0) f[random.below(3)] = special_floats[random.below(n)];
    }
    for (uint32_t bits : f) words.push_back(std::bit_cast<int32_t>(enter(bits)));
    for (int k = 0; k < 2; ++k)
      words.push_back(
          std::bit_cast<int32_t>(random.below(2) != 0 ? random.bits() : special_ints[random.below(16)]));
  }
  return words;
}

}  // namespace isoshade::conformance
