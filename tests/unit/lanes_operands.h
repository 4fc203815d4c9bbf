// SPDX-License-Identifier: Apache-2.0
//
// The operands on which the kernels of lanes_kernels.h are compared.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "tests/unit/lanes_kernels.h"

namespace isoshade::lanes::test {

inline const std::vector<uint32_t>& special_bits() {
  static const std::vector<uint32_t> bits = [] {
    std::vector<uint32_t> magnitudes = {
        0x00000000, 0x00000001, 0x00000002, 0x00012345, 0x007fffff,              // zero, denormals
        0x00800000, 0x00800001, 0x00ffffff, 0x01000000, 0x0c800000, 0x1f800000,  // tiny; square root of tiny
        0x20000000, 0x33800000, 0x34000000, 0x3effffff, 0x3f000000, 0x3f000001, 0x3f7fffff, 0x3f800000,
        0x3f800001, 0x3fc00000, 0x40000000, 0x40490fdb, 0x437f0000, 0x4affffff,  // ordinary
        0x4b000000, 0x4b000001, 0x4b7fffff, 0x4b800000,                          // from 2^23 on all are whole
        0x4effffff, 0x4f000000, 0x4f000001, 0x4f7fffff, 0x4f800000, 0x5f000000,  // the ends of int and
                                                                                 // unsigned
        0x7e800000, 0x7f000000, 0x7f7fffff, 0x7f800000,                          // huge, infinity
        0x7f800001, 0x7fa00000, 0x7fc00000, 0x7fc01234, 0x7fffffff,              // NaN, signaling and quiet
        31, 32, 36, 37, 255, 256, 0x0000ffff, 0x00010000};  // as ints: shift amounts, sizes
    std::vector<uint32_t> both = magnitudes;
    for (uint32_t magnitude : magnitudes) both.push_back(magnitude | 0x80000000u);
    return both;
  }();
  return bits;
}

inline constexpr int rows = 1 << 20;

struct Rows {
  std::vector<int> columns[3];
};

/// All pairs of special values, then random rows of several kinds.
inline const Rows& operand_rows() {
  static const Rows operands = [] {
    Rows result;
    std::mt19937 random(20260101);
    const std::vector<uint32_t>& special = special_bits();
    const auto put = [&](uint32_t a, uint32_t b, uint32_t c) {
      const uint32_t row[3] = {a, b, c};
      for (int i = 0; i < 3; ++i) result.columns[i].push_back(static_cast<int>(row[i]));
    };
    const auto with_exponent = [&](uint32_t exponent) {
      return (static_cast<uint32_t>(random()) & 0x807fffffu) | ((exponent & 0xff) << 23);
    };
    for (uint32_t a : special)
      for (uint32_t b : special) put(a, b, special[random() % special.size()] ^ (random() & 3));
    while (result.columns[0].size() < rows) {
      const uint32_t a = static_cast<uint32_t>(random());
      const uint32_t exponent = (a >> 23) & 0xff;
      switch (random() % 6) {
        case 0: put(a, random(), random()); break;
        case 1: put(a, a + random() % 9 - 4, random()); break;  // neighbours: cancellation
        case 2:
          put(a, with_exponent(127 - exponent + random() % 4), random());
          break;  // products near the least
        case 3: put(a, with_exponent(exponent + random() % 5 - 2), with_exponent(exponent)); break;
        case 4: put(with_exponent(120 + random() % 40), with_exponent(120 + random() % 40), random()); break;
        case 5: put(random() % 1000, random() % 64, random()); break;  // small ints
      }
    }
    return result;
  }();
  return operands;
}

inline const std::vector<float>& float_table() {
  static const std::vector<float> table = [] {
    std::vector<float> values(37);
    for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i) * 0.37f - 3.0f;
    return values;
  }();
  return table;
}

inline const std::vector<int> int_table = {5,  -7, 1 << 30, 0,  -1, 99, 12345, 1,  2,  3,  4,  -5, 6,
                                           7,  8,  9,       10, 11, 12, 13,    14, 15, 16, 17, 18, 19,
                                           20, 21, 22,      23, 24, 25, 26,    27, 28, 29, 31};

inline constexpr int block = 4096;

/// Rows [begin, begin + block). Uniform operands differ from block to block.
inline Inputs inputs_of_block(int begin) {
  const Rows& operands = operand_rows();
  const std::vector<uint32_t>& special = special_bits();
  Inputs inputs;
  for (int i = 0; i < 3; ++i) inputs.columns[i] = operands.columns[i].data() + begin;
  inputs.count = block;
  const size_t which = static_cast<size_t>(begin) / block;
  inputs.uniform[0] = static_cast<int>(special[which % special.size()]);
  inputs.uniform[1] =
      which % 2 == 0 ? operands.columns[1][begin + 1] : static_cast<int>(special[which % special.size()]);
  inputs.floats = float_table().data();
  inputs.ints = int_table.data();
  inputs.table_size = static_cast<int>(int_table.size());
  return inputs;
}

}  // namespace isoshade::lanes::test
