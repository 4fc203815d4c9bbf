// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cstdint>
#include <gtest/gtest.h>
#ifdef __x86_64__
#include <immintrin.h>
#endif
#include <random>

#include "compiler/support/parse_number.h"

namespace isoshade::support {
namespace {

/// The bits of the parsed float, or 0xdead where the text is refused.
uint32_t bits(std::string_view text) {
  const std::optional<float> value = parse_float(text);
  return value ? std::bit_cast<uint32_t>(*value) : 0xdeadu;
}

TEST(ParseFloat, ReadsDecimals) {
  EXPECT_EQ(bits("1"), 0x3f800000u);
  EXPECT_EQ(bits("+1.5"), 0x3fc00000u);
  EXPECT_EQ(bits("-1.5e1"), 0xc1700000u);
  EXPECT_EQ(bits(".5"), 0x3f000000u);
  EXPECT_EQ(bits("5."), 0x40a00000u);
  EXPECT_EQ(bits("1E+2"), 0x42c80000u);
  EXPECT_EQ(bits("0.1"), 0x3dcccccdu);
  EXPECT_EQ(bits("3.4028235e38"), 0x7f7fffffu);
  EXPECT_EQ(bits("-0"), 0x80000000u);
  EXPECT_EQ(bits("0e99999999999999999999"), 0u);
}

TEST(ParseFloat, ReadsHexFloats) {
  EXPECT_EQ(bits("0x1.8p+1"), 0x40400000u);
  EXPECT_EQ(bits("-0X1P-1"), 0xbf000000u);
  EXPECT_EQ(bits("0x.8p0"), 0x3f000000u);
  EXPECT_EQ(bits("0x10"), 0x41800000u);
  EXPECT_EQ(bits("0x1.fffffep127"), 0x7f7fffffu);
}

TEST(ParseFloat, RoundsOnceToNearestEven) {
  // Halfway between 1 and its neighbour: to even; a digit far behind decides.
  EXPECT_EQ(bits("1.000000059604644775390625"), 0x3f800000u);
  EXPECT_EQ(bits("1.000000059604644775390625000000000000000000000000000000000001"), 0x3f800001u);
  EXPECT_EQ(bits("1.000000178813934326171875"), 0x3f800002u);
  // Through a double both round to the tie first, and then the wrong way.
  EXPECT_EQ(bits("1.00000005960464477540"), 0x3f800001u);
  EXPECT_EQ(bits("0x1.00000100000000000001p0"), 0x3f800001u);
  EXPECT_EQ(bits("0x1.000001p0"), 0x3f800000u);
  EXPECT_EQ(bits("0x1.000003p0"), 0x3f800002u);
  EXPECT_EQ(bits("0x1.ffffffp127"), 0x7f800000u);  // halfway to 2^128
}

TEST(ParseFloat, FlushesDenormalsToSignedZero) {
  EXPECT_EQ(bits("1.17549435e-38"), 0x00800000u);
  EXPECT_EQ(bits("1.17549421e-38"), 0u);
  EXPECT_EQ(bits("-1e-40"), 0x80000000u);
  EXPECT_EQ(bits("0x1p-126"), 0x00800000u);
  EXPECT_EQ(bits("0x1p-127"), 0u);
  EXPECT_EQ(bits("-0x1p-9999999999999999999999"), 0x80000000u);
  EXPECT_EQ(bits("1e-400"), 0u);
  EXPECT_EQ(bits("1e-99999999999999999999"), 0u);
  EXPECT_EQ(bits("0." + std::string(500, '0') + "1"), 0u);
}

TEST(ParseFloat, OverflowsToInfinity) {
  EXPECT_EQ(bits("1e39"), 0x7f800000u);
  EXPECT_EQ(bits("-1e400"), 0xff800000u);
  EXPECT_EQ(bits("1e99999999999999999999"), 0x7f800000u);
  EXPECT_EQ(bits("0x1p128"), 0x7f800000u);
  EXPECT_EQ(bits("0x1p+99999999999999999999"), 0x7f800000u);
  EXPECT_EQ(bits(std::string(500, '9')), 0x7f800000u);
  // Exponent and digits weigh against each other.
  EXPECT_EQ(bits("1" + std::string(500, '0') + "e-500"), 0x3f800000u);
  EXPECT_EQ(bits("0." + std::string(499, '0') + "1e500"), 0x3f800000u);
}

TEST(ParseFloat, ReadsNanAndInfinities) {
  EXPECT_EQ(bits("nan"), 0x7fc00000u);
  EXPECT_EQ(bits("-nan"), 0x7fc00000u);
  EXPECT_EQ(bits("inf"), 0x7f800000u);
  EXPECT_EQ(bits("-inf"), 0xff800000u);
}

TEST(ParseFloat, RejectsEverythingElse) {
  for (const std::string_view text :
       {"",    " ",   " 1",     "1 ",  "-",    "+",     "--1", "-+1",  ".",   "e1",
        "1e",  "1e+", "0x",     "0x.", "0xp1", "0x1p",  "x1",  "1x",   "1,5", "infinity",
        "INF", "NaN", "nan(1)", "1f",  "0x1g", "1.2.3", "0b1", "--0x1"}) {
    EXPECT_EQ(bits(text), 0xdeadu) << '"' << text << '"';
  }
  EXPECT_EQ(bits(std::string_view("1\0", 2)), 0xdeadu);
}

TEST(FormatFloat, IsShortAndReadsAsAFloat) {
  EXPECT_EQ(format_float(1.0f), "1.0");
  EXPECT_EQ(format_float(-0.0f), "-0.0");
  EXPECT_EQ(format_float(0.1f), "0.1");
  EXPECT_EQ(format_float(16777216.0f), "16777216.0");
  EXPECT_EQ(format_float(1e-7f), "1e-07");
  EXPECT_EQ(format_float(1e30f), "1e+30");
  EXPECT_EQ(format_float(std::bit_cast<float>(0xffc00001u)), "nan");
  EXPECT_EQ(format_float(-std::numeric_limits<float>::infinity()), "-inf");
}

TEST(FormatHexFloat, MatchesPrintf) {
  EXPECT_EQ(format_hex_float(3.0f), "0x1.8p+1");
  EXPECT_EQ(format_hex_float(-1.0f), "-0x1p+0");
  EXPECT_EQ(format_hex_float(0.0f), "0x0p+0");
  EXPECT_EQ(format_hex_float(-0.0f), "-0x0p+0");
  EXPECT_EQ(format_hex_float(std::numeric_limits<float>::max()), "0x1.fffffep+127");
  EXPECT_EQ(format_hex_float(std::bit_cast<float>(0x00000001u)), "0x1p-149");
  EXPECT_EQ(format_hex_float(std::bit_cast<float>(0x00600000u)), "0x1.8p-127");
  EXPECT_EQ(format_hex_float(std::numeric_limits<float>::quiet_NaN()), "nan");
}

TEST(FormatFloat, DecimalAndHexReadBackAsTheSameBits) {
  std::mt19937 random(1);
  for (int i = 0; i < 200'000; ++i) {
    const uint32_t wanted = random();
    const uint32_t exponent = wanted >> 23 & 255;
    if (exponent == 0 || exponent == 255) continue;
    const float value = std::bit_cast<float>(wanted);
    const std::string text = format_float(value);
    ASSERT_EQ(bits(text), wanted) << text;
    ASSERT_EQ(bits(format_hex_float(value)), wanted) << text;
    ASSERT_NE(text.find_first_of(".e"), std::string::npos) << text;
    const std::string mantissa = text.substr(0, text.find('e'));
    const size_t first = mantissa.find_first_not_of("-0.");
    size_t digits = 0;
    for (const char c : mantissa.substr(first)) digits += c >= '0' && c <= '9';
    // Large integers are written out: their last digits are exact, not needed.
    if (text.find('e') != std::string::npos || exponent < 127 + 23) {
      ASSERT_LE(digits, 9u + (mantissa.substr(mantissa.size() - 2) == ".0")) << text;
    }
  }
}

#ifdef __x86_64__
TEST(ParseFloat, IsIndependentOfDenormalFlushing) {
  std::mt19937 random(2);
  const unsigned mode = _mm_getcsr();
  for (int i = 0; i < 100'000; ++i) {
    const uint32_t wanted = random();
    // Half of them the smallest normals: their digits lie among those of denormals, which themselves never occur.
    const float value = std::bit_cast<float>(i % 2 == 0 ? wanted : 0x00800000u | (wanted & 0x807fffffu));
    if ((wanted >> 23 & 255) == 0 && i % 2 == 0) continue;
    const std::string text = format_float(value), hex = format_hex_float(value);
    const uint32_t plain = bits(text);
    _mm_setcsr(mode | 0x8040);
    const bool same = format_float(value) == text && format_hex_float(value) == hex && bits(text) == plain &&
                      bits(hex) == plain;
    _mm_setcsr(mode);
    ASSERT_TRUE(same) << text;
  }
}
#endif

}  // namespace
}  // namespace isoshade::support
