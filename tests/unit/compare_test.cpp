// SPDX-License-Identifier: Apache-2.0
#include "runtime/compare/compare.h"

#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace isoshade {
namespace {

using backends::Image;
using compare::ulp_distance;

Image grey_image(int width, int height, float grey) {
  Image image;
  image.width = width;
  image.height = height;
  const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  image.rgba.assign(4 * pixels, grey);
  image.depth.assign(pixels, 0.5f);
  return image;
}

TEST(Compare, EqualBitsAreIdentical) {
  Image a = grey_image(3, 2, std::numeric_limits<float>::quiet_NaN());
  const auto comparison = compare::compare(a, a);
  EXPECT_TRUE(comparison.identical());
  EXPECT_FALSE(comparison.first);
  EXPECT_EQ(compare::describe(comparison, "cpu", "vulkan"), "identical: 0 of 6 pixels differ");
}

TEST(Compare, DetectsEveryBitOfEveryChannelAndDepth) {
  const Image a = grey_image(3, 2, 1.0f);
  for (int word = 0; word < 5; ++word) {
    for (int bit = 0; bit < 32; ++bit) {
      Image b = a;
      float& value = word < 4 ? b.rgba[4 * 4 + static_cast<size_t>(word)] : b.depth[4];
      value = std::bit_cast<float>(std::bit_cast<uint32_t>(value) ^ (1u << bit));
      const auto comparison = compare::compare(a, b);
      EXPECT_EQ(comparison.differing, 1);
      ASSERT_TRUE(comparison.first);
      EXPECT_EQ(comparison.first->x, 1);
      EXPECT_EQ(comparison.first->y, 1);
      EXPECT_GT(comparison.largest_ulp, 0u);
      EXPECT_NE(compare::image_hash(a), compare::image_hash(b));
    }
  }
}

TEST(Compare, DistinguishesNegativeZero) {
  Image a = grey_image(1, 1, 0.0f);
  Image b = grey_image(1, 1, -0.0f);
  const auto comparison = compare::compare(a, b);
  EXPECT_EQ(comparison.differing, 1);
  EXPECT_EQ(comparison.largest_ulp, 1u);
}

TEST(Compare, UlpDistanceCountsFloatsBetween) {
  const float inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(ulp_distance(1.0f, std::nextafter(1.0f, 2.0f)), 1u);
  EXPECT_EQ(ulp_distance(1.0f, 2.0f), 0x800000u);
  EXPECT_EQ(ulp_distance(-1.0f, std::nextafter(-1.0f, 0.0f)), 1u);
  EXPECT_EQ(ulp_distance(std::numeric_limits<float>::max(), inf), 1u);
  EXPECT_EQ(ulp_distance(-inf, inf), 0xff000001u);
  EXPECT_EQ(ulp_distance(0x1p-126f, -0x1p-126f), 0x1000001u);
}

TEST(Compare, FindsTheFirstDifferenceInRowOrderAndTheLargest) {
  const Image a = grey_image(4, 4, 1.0f);
  Image b = a;
  b.rgba[4 * 9 + 2] = 1.0f + 0x1p-20f;
  b.depth[7] = 0.25f;
  const auto comparison = compare::compare(a, b);
  EXPECT_EQ(comparison.differing, 2);
  EXPECT_EQ(comparison.first->x, 3);
  EXPECT_EQ(comparison.first->y, 1);
  EXPECT_EQ(comparison.largest_ulp, 0x800000u);
  const std::string text = compare::describe(comparison, "cpu", "vulkan");
  EXPECT_EQ(text,
            "different: 2 of 16 pixels differ, by at most 8388608 ULP; the first at x = 3, y = 1\n"
            "  cpu     r 1.0 (0x1p+0)  g 1.0 (0x1p+0)  b 1.0 (0x1p+0)  a 1.0 (0x1p+0)  depth 0.5 (0x1p-1)\n"
            "  vulkan  r 1.0 (0x1p+0)  g 1.0 (0x1p+0)  b 1.0 (0x1p+0)  a 1.0 (0x1p+0)  depth 0.25 (0x1p-2)");
}

TEST(Compare, ImagesOfDifferentSizeDiffer) {
  const auto comparison = compare::compare(grey_image(2, 3, 0), grey_image(3, 2, 0));
  EXPECT_FALSE(comparison.identical());
  EXPECT_NE(compare::image_hash(grey_image(2, 3, 0)), compare::image_hash(grey_image(3, 2, 0)));
}

TEST(Compare, HashesCoverTheWordsOfTheContract) {
  // By Python's hashlib.
  Image image = grey_image(1, 1, 0);
  image.rgba = {1.0f, 0.5f, 0.25f, 1.0f};
  image.depth = {0.125f};
  EXPECT_EQ(compare::image_hash(image), "c5bb9e63247b11b8bdf7aecc05692b0988d4e648b21fb1dac135f46dfe6c8df9");
  const uint8_t bytes[] = {1, 2, 3, 255};
  EXPECT_EQ(compare::encoded_hash(1, 1, bytes),
            "4a28b4c8cc2e6f09c4f1c07df4a0357317848d0f7a6f7f4dbe470636c199341c");
}

}  // namespace
}  // namespace isoshade
