// SPDX-License-Identifier: Apache-2.0
// Radiance HDR files, from bytes.
#include <cmath>
#include <gtest/gtest.h>

#include "runtime/scene/image_file.h"

namespace isoshade {
namespace {

using Floats = std::vector<float>;

std::string hdr(const std::string& variables, const std::string& size, const std::string& pixels) {
  return "#?RADIANCE\n" + variables + "FORMAT=32-bit_rle_rgbe\n\n" + size + "\n" + pixels;
}

/// 1 0.5 0.25, and n such pixels.
const std::string unit("\x80\x40\x20\x81", 4);
std::string units(size_t count) {
  std::string all;
  while (count-- > 0) all += unit;
  return all;
}

/// A pixel whose red is n/128.
std::string red(int n) { return std::string{static_cast<char>(n), '\2', '\1', '\x81'}; }

Floats colors(const std::string& bytes) {
  const auto image = scene::decode_image(bytes);
  EXPECT_TRUE(image.found) << image.reason;
  Floats all;
  for (size_t i = 0; image.found && i < image.found->rgba.size(); ++i)
    if (i % 4 != 3) all.push_back(image.found->rgba[i]);
  return all;
}

std::string reason(const std::string& bytes) {
  const auto image = scene::decode_image(bytes);
  EXPECT_FALSE(image.found);
  return image.reason;
}

Floats reds(const std::string& bytes) {
  const Floats all = colors(bytes);
  Floats found;
  for (size_t i = 0; i < all.size(); i += 3) found.push_back(all[i] * 128);
  return found;
}

TEST(Hdr, DividesColoursByEveryExposureAndCorrection) {
  const std::string one = "-Y 1 +X 1";
  EXPECT_EQ(colors(hdr("", one, unit)), (Floats{1, 0.5f, 0.25f}));
  EXPECT_EQ(colors(hdr("EXPOSURE=2\n", one, unit)), (Floats{0.5f, 0.25f, 0.125f}));
  EXPECT_EQ(colors(hdr("EXPOSURE=  2.0\nEXPOSURE=0.25 \n", one, unit)), (Floats{2, 1, 0.5f}));
  EXPECT_EQ(colors(hdr("COLORCORR= 1 2 4\r\n", one, unit)), (Floats{1, 0.25f, 0.0625f}));
  EXPECT_EQ(colors(hdr("COLORCORR=1 2 4\nEXPOSURE=2\nCOLORCORR=2 1 1\n", one, unit)),
            (Floats{0.25f, 0.125f, 0.03125f}));
  // A comment is none.
  EXPECT_EQ(colors(hdr("# EXPOSURE=2\n", one, unit)), (Floats{1, 0.5f, 0.25f}));
  for (const char* bad : {"EXPOSURE=0\n", "EXPOSURE=-1\n", "EXPOSURE=x\n", "EXPOSURE=nan\n", "EXPOSURE=1 2\n",
                          "EXPOSURE=1e30\nEXPOSURE=1e30\n", "COLORCORR=1 2\n", "COLORCORR=1 0 1\n"})
    EXPECT_NE(reason(hdr(bad, one, unit)).find("is not a positive number"), std::string::npos) << bad;
}

TEST(Hdr, OldRunLengthsAreRead) {
  // "1 1 1 n" repeats the pixel before n times; a second one n * 256 times.
  EXPECT_EQ(colors(hdr("", "-Y 2 +X 4", (unit + "\1\1\1\3") + unit + "\1\1\1\3")).size(), size_t{24});
  EXPECT_EQ(reds(hdr("", "-Y 2 +X 4", red(7) + "\1\1\1\3" + red(5) + red(3) + "\1\1\1\2")),
            (Floats{7, 7, 7, 7, 5, 3, 3, 3}));
  const Floats far = reds(hdr("", "-Y 1 +X 600", red(9) + "\1\1\1\x56\1\1\1\2" + red(4)));
  ASSERT_EQ(far.size(), size_t{600});
  EXPECT_EQ(far[598], 9);
  EXPECT_EQ(far[599], 4);
  EXPECT_FALSE(scene::decode_image(hdr("", "-Y 1 +X 4", unit + "\1\1\1\4")).found);  // beyond the row
  EXPECT_FALSE(scene::decode_image(hdr("", "-Y 1 +X 4", "\1\1\1\4" + unit)).found);  // of nothing
}

TEST(Hdr, NewRunLengthsAndPlainPixelsAreRead) {
  std::string row = "\2\2";
  row += std::string("\0\10", 2);
  row +=
      std::string("\x88\x80", 2) + std::string("\x84\x40\4\1\2\3\4", 7) + std::string("\x88\x20\x88\x81", 4);
  const Floats read = colors(hdr("", "-Y 1 +X 8", row));
  ASSERT_EQ(read.size(), size_t{24});
  EXPECT_EQ((Floats{read[0], read[1], read[2]}), (Floats{1, 0.5f, 0.25f}));
  EXPECT_EQ(read[22], 4.0f / 128);
  EXPECT_EQ(colors(hdr("", "-Y 2 +X 9", units(18))).size(), size_t{54});
  EXPECT_EQ(colors(hdr("", "-Y 1 +X 1", std::string("\xff\xff\xff\0", 4))), (Floats{0, 0, 0}));
}

TEST(Hdr, TurnsAllEightOrientationsUpright) {
  std::string pixels;
  for (int i = 1; i <= 6; ++i) pixels += red(i);
  // Three columns, two rows.
  EXPECT_EQ(reds(hdr("", "-Y 2 +X 3", pixels)), (Floats{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(reds(hdr("", "-Y 2 -X 3", pixels)), (Floats{3, 2, 1, 6, 5, 4}));
  EXPECT_EQ(reds(hdr("", "+Y 2 +X 3", pixels)), (Floats{4, 5, 6, 1, 2, 3}));
  EXPECT_EQ(reds(hdr("", "+Y 2 -X 3", pixels)), (Floats{6, 5, 4, 3, 2, 1}));
  EXPECT_EQ(reds(hdr("", "+X 3 -Y 2", pixels)), (Floats{1, 3, 5, 2, 4, 6}));
  EXPECT_EQ(reds(hdr("", "+X 3 +Y 2", pixels)), (Floats{2, 4, 6, 1, 3, 5}));
  EXPECT_EQ(reds(hdr("", "-X 3 -Y 2", pixels)), (Floats{5, 3, 1, 6, 4, 2}));
  EXPECT_EQ(reds(hdr("", "-X 3 +Y 2", pixels)), (Floats{6, 4, 2, 5, 3, 1}));
  for (const char* bad : {"", "-Y 2", "-Y 2 +Y 3", "-Y 2 +X 3 4", "Y 2 X 3", "-Y two +X 3", "-Y 2 +X 3x"})
    EXPECT_NE(reason(hdr("", bad, pixels)).find("its size is not stated"), std::string::npos) << bad;
}

TEST(Hdr, PrimariesAreConvertedToRec709) {
  const std::string one = "-Y 1 +X 1", red_only("\x80\0\0\x81", 4);
  const Floats wide =
      colors(hdr("PRIMARIES=0.708 0.292 0.170 0.797 0.131 0.046 0.3127 0.3290\n", one, red_only));
  EXPECT_NEAR(wide[0], 1.6605f, 1e-4f);
  EXPECT_NEAR(wide[1], -0.1246f, 1e-4f);
  const Floats same = colors(hdr("PRIMARIES=0.640 0.330 0.300 0.600 0.150 0.060 0.3127 0.3290\n", one, unit));
  EXPECT_EQ(same, (Floats{1, 0.5f, 0.25f}));
  EXPECT_EQ(colors(hdr("PRIMARIES=0 0 0 0 0 0 0 0\n", one, unit)), (Floats{1, 0.5f, 0.25f}));
  EXPECT_NE(reason(hdr("PRIMARIES=0.3 0.3 0.3 0.3 0.3 0.3 0.3 0.3\n", one, unit)).find("are degenerate"),
            std::string::npos);
  EXPECT_NE(reason(hdr("PRIMARIES=1 2 3\n", one, unit)).find("eight numbers"), std::string::npos);
}

TEST(Hdr, RejectsXyz) {
  EXPECT_NE(reason("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n" + unit).find("XYZ"),
            std::string::npos);
}

TEST(Hdr, OverflowIsClampedAndCounted) {
  const auto image =
      scene::decode_image(hdr("EXPOSURE=2e-38\n", "-Y 1 +X 2", std::string("\xff\1\0\x90\0\0\0\0", 8)));
  ASSERT_TRUE(image.found) << image.reason;
  EXPECT_EQ(image.found->not_finite, 1u);
  EXPECT_EQ(image.found->rgba[0], 65504);
}

TEST(Hdr, RejectsTruncatedFiles) {
  const std::string packed = std::string("\2\2\0\10", 4) + std::string("\x88\x80\x88\x40\x88\x20\x88\x81", 8);
  for (const std::string& whole : {hdr("", "-Y 3 +X 2", units(6)), hdr("", "-Y 1 +X 4", unit + "\1\1\1\3"),
                                   hdr("EXPOSURE=2\n", "-Y 1 +X 8", packed)}) {
    EXPECT_TRUE(scene::decode_image(whole).found);
    for (size_t length = 0; length < whole.size(); ++length)
      EXPECT_FALSE(scene::decode_image(whole.substr(0, length)).found) << length;
  }
  EXPECT_FALSE(scene::decode_image(hdr("", "-Y 8192 +X 8192", unit)).found);
}

}  // namespace
}  // namespace isoshade
