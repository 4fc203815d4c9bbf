// SPDX-License-Identifier: Apache-2.0
#include <bit>

#include "backends/vulkan/probe_parts.h"

namespace isoshade::vulkan {

namespace {

constexpr uint32_t one = 0x3f800000;

/// Bits of floats, but for the last lines of ints.
constexpr uint32_t special[] = {
    0x00000000, 0x80000000, 0x00000001, 0x807fffff,              // zeros, denormals
    0x00800000, 0x80800000, 0x00800001, 0x00ffffff, 0x01000000,  // the smallest normals
    0x7f7fffff, 0xff7fffff, 0x7f800000, 0xff800000,              // the largest, infinities
    0x7fc00000, 0xffc00000, 0x7f800001, 0xffabcdef,              // NaNs
    0x3f800000, 0xbf800000, 0x3f7fffff, 0x3f800001, 0x3f000000, 0xbf000000,
    0x3fc00000, 0x40200000, 0x40400000, 0x4affffff, 0xcaffffff, 0x4b000001,
    0x4b7fffff, 0x4b800000, 0x4effffff, 0xcf000000,  // about 2^23, 2^24, 2^31
    0x3dcccccd, 0x40490fdb, 0x1e3ce508, 0x60ad78ec, 0x20000000, 0x5f800000,
    0x0000001f, 0x0000ffff, 0x7fffffff, 0xffffffff, 0x80000001,
};

uint32_t pack(uint32_t mantissa, int exponent) {
  return static_cast<uint32_t>(exponent + 127) << 23 | (mantissa & 0x7fffff);
}

class Rows {
 public:
  std::vector<Operands> make() {
    specials();
    smallest_normals();
    fused();
    hard_quotients();
    hard_roots();
    anything();
    return std::move(rows_);
  }

 private:
  struct Row {
    uint32_t a, b, c;
  };
  /// A row in braces, so that random operands are drawn from left to right.
  void add(Row row) {
    rows_.push_back({static_cast<int32_t>(row.a), static_cast<int32_t>(row.b), static_cast<int32_t>(row.c)});
  }
  uint32_t mantissa() { return random_.bits() & 0x7fffff; }
  /// A positive float with an exponent in the range.
  uint32_t number(int lowest, int highest) {
    const uint32_t bits = mantissa();
    return pack(bits, random_.between(lowest, highest));
  }

  void specials() {
    size_t third = 0;
    for (const uint32_t a : special)
      for (const uint32_t b : special) add({a, b, special[third++ % std::size(special)]});
  }

  /// Results about 2^-126: which flush depends on whether a device rounds before or after it looks.
  void smallest_normals() {
    for (int i = 0; i < 2000; ++i) {
      const uint32_t a = mantissa();
      const double reciprocal = 1.0 / (1.0 + a / 8388608.0);
      const auto near = std::bit_cast<uint32_t>(static_cast<float>(reciprocal));
      const int split = random_.between(-100, -20);
      const uint32_t scale = static_cast<uint32_t>(-126 - split) << 23;
      add({pack(a, split), near + scale + static_cast<uint32_t>(random_.between(-2, 2)), number(-126, -126)});
    }
    // Differences and quotients of the smallest.
    for (int i = 0; i < 500; ++i) add({number(-126, -124), number(-126, -126), number(-126, -124)});
    for (int i = 0; i < 500; ++i) add({number(-64, -62), number(63, 63), number(0, 0)});
  }

  /// a * b - round(a * b): zero, but for what a fused operation keeps.
  void fused() {
    for (int i = 0; i < 1000; ++i) {
      const uint32_t a = number(-20, 20), b = number(-20, 20);
      const float product = std::bit_cast<float>(a) * std::bit_cast<float>(b);
      add({a, b, std::bit_cast<uint32_t>(-product)});
    }
  }

  /// A * 2^24 = M * B + r with M odd, 25 bits long, and r tiny: the quotient A / B lies r / B from the middle
  /// between two floats.
  void hard_quotients() {
    int found = 0;
    while (found < 3000) {
      const uint32_t b = 0x800001 | mantissa();
      const int r = 2 * random_.between(-8, 7) + 1;
      uint32_t inverse = b;  // of b modulo 2^24, by Newton
      for (int i = 0; i < 5; ++i) inverse *= 2 - b * inverse;
      const uint64_t middle = (static_cast<uint32_t>(-r) * inverse & 0xffffff) | 0x1000000;
      const uint64_t a = (middle * b + static_cast<uint64_t>(static_cast<int64_t>(r))) >> 24;
      if (a < b || a > 0xffffff) continue;
      add({pack(static_cast<uint32_t>(a), random_.between(-40, 40)), pack(b, random_.between(-40, 40)), one});
      ++found;
    }
  }

  /// A * 2^shift = M * M - t with M odd, 25 bits long, and t tiny; t = 1 modulo 8, or there is no such M.
  void hard_roots() {
    for (int t = -4095; t < 4096; t += 8) {
      for (const int shift : {25, 26}) {
        const auto target = static_cast<uint64_t>(static_cast<int64_t>(t));
        uint64_t root = 1;  // of t modulo 2^shift, bit by bit
        for (int bit = 3; bit < shift; ++bit)
          if (((root * root - target) >> bit & 1) != 0) root += uint64_t{1} << (bit - 1);
        const uint64_t period = uint64_t{1} << (shift - 1);
        for (const uint64_t base : {root % period, (period - root % period) % period}) {
          for (uint64_t middle = base; middle < 0x2000000; middle += period) {
            const uint64_t a = (middle * middle - target) >> shift;
            if (middle < 0x1000000 || a < 0x800000 || a > 0xffffff) continue;
            const int exponent = 2 * random_.between(-30, 30) + (shift == 26 ? 1 : 0);
            add({pack(static_cast<uint32_t>(a), exponent), one, random_.bits()});
          }
        }
      }
    }
  }

  void anything() {
    for (int i = 0; i < 3000; ++i) add({random_.bits(), random_.bits(), random_.bits()});
    for (int i = 0; i < 2000; ++i) add({number(-2, 2), number(-2, 2), random_.bits()});
  }

  Random random_{20240607};
  std::vector<Operands> rows_;
};

}  // namespace

std::vector<Operands> probe_operands() { return Rows().make(); }

}  // namespace isoshade::vulkan
