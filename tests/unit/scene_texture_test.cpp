// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "runtime/scene/texture.h"

namespace isoshade {
namespace {

using scene::TextureLevel;

TextureLevel noise(int width, int height) {
  std::mt19937 random(static_cast<unsigned>(width * 1000 + height));
  TextureLevel level{width, height, std::vector<float>(size_t{4} * width * height)};
  for (float& value : level.texels) value = std::ldexp(static_cast<float>(random() >> 8), -24);
  return level;
}

/// The mean of a rectangle of a picture, of which parts of texels count in part.
double mean(const TextureLevel& level, double x0, double x1, double y0, double y1, int channel) {
  double sum = 0;
  for (int y = 0; y < level.height; ++y) {
    for (int x = 0; x < level.width; ++x) {
      const double across = std::min(x1, x + 1.0) - std::max(x0, double(x));
      const double down = std::min(y1, y + 1.0) - std::max(y0, double(y));
      if (across <= 0 || down <= 0) continue;
      sum += across * down * double{level.texels[static_cast<size_t>(4 * (y * level.width + x) + channel)]};
    }
  }
  return sum / ((x1 - x0) * (y1 - y0));
}

TEST(Mips, EveryTexelIsTheMeanOfItsArea) {
  for (const auto& [width, height] : {std::pair{8, 4}, {7, 5}, {1, 9}, {13, 1}, {2, 3}, {33, 17}, {3, 3}}) {
    const TextureLevel level = noise(width, height);
    const TextureLevel half = scene::half_size(level);
    ASSERT_EQ(half.width, std::max(1, width / 2));
    ASSERT_EQ(half.height, std::max(1, height / 2));
    const double across = double(width) / half.width, down = double(height) / half.height;
    for (int y = 0; y < half.height; ++y)
      for (int x = 0; x < half.width; ++x)
        for (int c = 0; c < 4; ++c)
          ASSERT_NEAR(half.texels[static_cast<size_t>(4 * (y * half.width + x) + c)],
                      mean(level, x * across, (x + 1) * across, y * down, (y + 1) * down, c), 1e-6)
              << width << "x" << height << " at " << x << ", " << y;
  }
}

TEST(Mips, OneTexelIsUnchanged) {
  const TextureLevel level = noise(1, 1);
  EXPECT_EQ(scene::half_size(level).texels, level.texels);
}

/// All bytes, alphas too.
scene::ByteLevel all_bytes() {
  scene::ByteLevel level{256, 1, {}};
  for (uint32_t i = 0; i < 256; ++i) level.texels.push_back(i * 0x01010101u);
  return level;
}

TEST(Texture, DecodesSrgbBytesExceptAlpha) {
  const TextureLevel decoded = scene::linear_level(all_bytes(), true);
  const TextureLevel plain = scene::linear_level(all_bytes(), false);
  for (size_t i = 0; i < 256; ++i) {
    for (size_t c = 0; c < 4; ++c) EXPECT_EQ(plain.texels[4 * i + c], static_cast<float>(i) / 255.0f);
    const double encoded = double(i) / 255;
    const double linear = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
    EXPECT_NEAR(decoded.texels[4 * i], linear, 3e-7 * linear);
    EXPECT_EQ(decoded.texels[4 * i + 3], plain.texels[4 * i + 3]);
  }
}

TEST(Texture, ByteAndFloatImagesDecodeEqually) {
  const scene::ByteLevel level = all_bytes();
  const scene::FileImage bytes{256, 1, level.texels, {}, {}};
  const scene::FileImage floats{256, 1, {}, scene::numbers_of(bytes), {}};
  for (const bool srgb : {false, true})
    EXPECT_EQ(scene::linear_level(bytes, srgb).texels, scene::linear_level(floats, srgb).texels);
}

TEST(Texture, EncodesToTheNearestByteAndTiesDown) {
  for (const bool srgb : {false, true}) {
    EXPECT_EQ(scene::byte_level(scene::linear_level(all_bytes(), srgb), srgb).texels, all_bytes().texels);
    for (const bool alpha : {false, true}) {
      const scene::ByteTable& table = scene::byte_table(srgb && !alpha);
      const auto byte = [&](float value) {
        const TextureLevel level{1, 1, std::vector<float>(4, value)};
        const uint32_t word = scene::byte_level(level, srgb).texels[0];
        return alpha ? word >> 24 : word & 255;
      };
      for (uint32_t i = 0; i + 1 < 256; ++i) {
        ASSERT_LT(table[i], table[i + 1]);
        const double middle = (double{table[i]} + double{table[i + 1]}) / 2;
        const auto near = static_cast<float>(middle);
        EXPECT_EQ(byte(near), near <= middle ? i : i + 1) << i;
        EXPECT_EQ(byte(std::nextafter(near, 0.0f)), std::nextafter(near, 0.0f) <= middle ? i : i + 1) << i;
        EXPECT_EQ(byte(std::nextafter(near, 1.0f)), std::nextafter(near, 1.0f) <= middle ? i : i + 1) << i;
      }
      EXPECT_EQ(byte(0.0f), 0u);
      EXPECT_EQ(byte(std::nextafter(1.0f, 2.0f)), 255u);
    }
  }
}

TEST(Mips, ByteMipsMatchFloatMips) {
  for (const auto& [width, height] : {std::pair{8, 4}, {7, 5}, {1, 9}, {13, 1}, {1, 1}}) {
    scene::ByteLevel level{width, height, {}};
    std::mt19937 random(5);
    for (int i = 0; i < width * height; ++i) level.texels.push_back(static_cast<uint32_t>(random()));
    for (const bool srgb : {false, true})
      EXPECT_EQ(scene::half_size(level, srgb).texels,
                scene::half_size(scene::linear_level(level, srgb)).texels);
  }
}

TEST(Texture, ClampsNonFiniteTexels) {
  const float inf = std::numeric_limits<float>::infinity(), most = std::numeric_limits<float>::max();
  const scene::FileImage image{2, 1, {}, {std::nanf(""), inf, -inf, 1e-40f, 1, 2, most, most}, {}};
  const TextureLevel level = scene::linear_level(image, false);
  EXPECT_EQ(level.texels, (std::vector<float>{0, most, -most, 0, 1, 2, most, most}));
  for (const float value : scene::half_size(level).texels) EXPECT_TRUE(std::isfinite(value));
}

}  // namespace
}  // namespace isoshade
