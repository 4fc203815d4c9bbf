// SPDX-License-Identifier: Apache-2.0
// PPM, PGM and PFM.
#include <bit>
#include <cmath>
#include <limits>

#include "tests/unit/decoded_image.h"

namespace isoshade {
namespace {

using namespace testing;

std::string floats(const std::vector<float>& values, bool is_little_endian) {
  std::string bytes;
  for (const float value : values)
    for (int i = 0; i < 4; ++i)
      bytes += static_cast<char>(std::bit_cast<uint32_t>(value) >> 8 * (is_little_endian ? i : 3 - i) & 255);
  return bytes;
}

TEST(Netpbm, PpmHoldsRedGreenAndBlueFromTheTop) {
  EXPECT_EQ(rgba_of("P6 1 2 255\n\x33\x66\xff\xff\x99\x33", true),
            (Floats{0.2f, 0.4f, 1, 1, 1, 0.6f, 0.2f, 1}));
  EXPECT_EQ(rgba_of("P5\n# grey\n2 1 # size\n255\n\x33\x66", true), (Floats{0.2f, 0.2f, 0.2f, 1, 0.4f, 0.4f, 0.4f, 1}));
}

TEST(Netpbm, OtherLargestNumbersAreDivided) {
  EXPECT_EQ(rgba_of("P5 2 1 100 \x19\x64", false), (Floats{0.25f, 0.25f, 0.25f, 1, 1, 1, 1, 1}));
  EXPECT_EQ(rgba_of("P5 1 1 65535 \x12\x34", false)[0], 0x1234 / 65535.0f);
  EXPECT_EQ(reason_of("P5 1 1 100 \x65"), "a pixel has the number 101 of at most 100");
}

TEST(Netpbm, PfmHoldsFloatsFromTheBottomInBothByteOrders) {
  for (const bool little : {true, false}) {
    const std::string scale = little ? "-1.0" : "2.5";
    EXPECT_EQ(rgba_of("PF\n1 2\n" + scale + "\n" + floats({1, 2, 3, -4, 0.1f, 1e30f}, little), false),
              (Floats{-4, 0.1f, 1e30f, 1, 1, 2, 3, 1}));
    EXPECT_EQ(rgba_of("Pf 2 1 " + scale + " " + floats({1, 2}, little), false), (Floats{1, 1, 1, 1, 2, 2, 2, 1}));
  }
  const auto image = scene::decode_image("Pf 2 1 -1 " + floats({std::nanf(""), std::numeric_limits<float>::infinity()}, true));
  ASSERT_TRUE(image.found);
  EXPECT_EQ(image.found->not_finite, 2u);
  EXPECT_EQ(image.found->rgba[4], scene::greatest_texel);
}

TEST(Netpbm, WhatIsWrittenIsReadBack) {
  const scene::FileImage image{2, 2, {}, {0.1f, -2, 1e20f, 0.5f, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, {0, 0, 0, 0}};
  const std::string file = scene::pfm(image.view());
  EXPECT_EQ(file.substr(0, 12), "PF\n2 2\n-1.0\n");
  EXPECT_EQ(file.substr(12), floats({5, 6, 7, 9, 10, 11, 0.1f, -2, 1e20f, 1, 2, 3}, true));
  EXPECT_EQ(rgba_of(file, false), (Floats{0.1f, -2, 1e20f, 1, 1, 2, 3, 1, 5, 6, 7, 1, 9, 10, 11, 1}));
  const std::vector<uint8_t> bytes{51, 102, 255, 255, 0, 1, 2, 255};
  EXPECT_EQ(scene::ppm({2, 1, bytes}), std::string("P6\n2 1\n255\n\x33\x66\xff\0\1\2", 17));
}

TEST(Netpbm, RejectsDamagedHeadersAndMissingPixels) {
  const std::string early = "the file ends early";
  EXPECT_EQ(reason_of("P6 1 1 255 ab"), early);
  EXPECT_EQ(reason_of("P6 1 1 255"), early);
  EXPECT_EQ(reason_of("P6 8192 8192 255 abc"), early) << "before memory is allocated";
  EXPECT_EQ(reason_of("PF 1 1 -1 abcdefghijk"), early);
  EXPECT_EQ(reason_of("P6 1"), "its header does not state its size");
  EXPECT_EQ(reason_of("P6 one 1 255 abc"), "its header does not state its size");
  EXPECT_EQ(reason_of("P6 0 1 255 abc"), "a side is not from 1 to 8192 pixels");
  EXPECT_EQ(reason_of("P6 99999 1 255 abc"), "a side is not from 1 to 8192 pixels");
  EXPECT_EQ(reason_of("P6 -1 1 255 abc"), "a side is not from 1 to 8192 pixels");
  for (const char* most : {"0", "65536", "-1", "x", "255x"})
    EXPECT_EQ(reason_of(std::string("P6 1 1 ") + most + " abcdef"), "its largest number is not from 1 to 65535") << most;
  for (const char* scale : {"0", "x", "nan", "inf"})
    EXPECT_EQ(reason_of(std::string("PF 1 1 ") + scale + " abcdefghijkl"), "its scale is not a number other than 0") << scale;
}

}  // namespace
}  // namespace isoshade
