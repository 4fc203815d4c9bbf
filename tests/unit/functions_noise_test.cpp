// SPDX-License-Identifier: Apache-2.0
// What authors rely on in noises, beside their values (those are measured in tests/accuracy).
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "compiler/functions/all.h"
#include "tests/unit/functions_values.h"

namespace isoshade::functions {
namespace {

using Vec2 = vec<float, 2>;
using Vec3 = vec<float, 3>;

Vec2 point(float x, float y) { return {hidden(x), hidden(y)}; }
Vec3 point(float x, float y, float z) { return {hidden(x), hidden(y), hidden(z)}; }

/// Places in [-50, 50).
class Places {
 public:
  float next() { return static_cast<float>(random_() >> 8) * (100 * 0x1p-24f) - 50; }
  Vec2 plane() { return point(next(), next()); }
  Vec3 space() { return point(next(), next(), next()); }

 private:
  std::mt19937 random_{1};
};

TEST(Noise, IsZeroAtIntegerCoordinates) {
  const lanes::FpGuard guard;
  for (float x : {-3.0f, 0.0f, 1.0f, 1e6f, -0x1p30f})
    for (float y : {-2.0f, 5.0f, 0x1p23f}) {
      EXPECT_EQ(noise2d(point(x, y)), 0.0f) << x << " " << y;
      EXPECT_EQ(noise3d(point(x, y, -7)), 0.0f) << x << " " << y;
    }
}

TEST(Noise, StaysInRangeWithMeanZero) {
  const lanes::FpGuard guard;
  Places places;
  double sum_2d = 0, sum_3d = 0;
  float largest_2d = 0, largest_3d = 0;
  constexpr int count = 100000;
  for (int i = 0; i < count; ++i) {
    const float a = noise2d(places.plane());
    const float b = noise3d(places.space());
    sum_2d += a, sum_3d += b;
    largest_2d = std::max(largest_2d, std::abs(a));
    largest_3d = std::max(largest_3d, std::abs(b));
  }
  EXPECT_NEAR(sum_2d / count, 0, 0.01);
  EXPECT_NEAR(sum_3d / count, 0, 0.01);
  EXPECT_GT(largest_2d, 0.8f);
  EXPECT_LT(largest_2d, 1.0f);
  EXPECT_GT(largest_3d, 0.8f);
  EXPECT_LT(largest_3d, 1.05f);
}

TEST(Noise, IsContinuousAcrossCells) {
  const lanes::FpGuard guard;
  Places places;
  for (int i = 0; i < 1000; ++i) {
    const float edge = std::floor(places.next());
    const float y = places.next(), z = places.next();
    const float below = std::nextafter(edge, -INFINITY), above = std::nextafter(edge, INFINITY);
    ASSERT_NEAR(noise2d(point(below, y)), noise2d(point(above, y)), 1e-4);
    ASSERT_NEAR(noise3d(point(y, below, z)), noise3d(point(y, above, z)), 1e-4);
  }
}

TEST(Noise, TreatsNonFiniteAndHugeCoordinatesAsZero) {
  const lanes::FpGuard guard;
  const float y = 0.3f, z = 0.7f;
  for (float x : {nan, inf, -inf, huge, 0x1p31f, -0x1p31f}) {
    EXPECT_EQ(noise2d(point(x, y)), noise2d(point(0, y))) << x;
    EXPECT_EQ(noise3d(point(y, z, x)), noise3d(point(y, z, 0))) << x;
    EXPECT_EQ(cellnoise2d(point(x, y)), cellnoise2d(point(0, y))) << x;
    EXPECT_EQ(cellnoise3d(point(y, x, z)), cellnoise3d(point(y, 0, z))) << x;
    EXPECT_EQ(worleynoise2d(point(x, y), 1.0f), worleynoise2d(point(0, y), 1.0f)) << x;
  }
  const float last = std::nextafter(0x1p31f, 0.0f);
  EXPECT_EQ(noise2d(point(last, -last)), 0.0f);
}

TEST(Noise, FirstChannelEqualsTheScalarNoise) {
  const lanes::FpGuard guard;
  Places places;
  int different = 0;  // by chance channels can be the same somewhere
  for (int i = 0; i < 100; ++i) {
    const Vec2 p = places.plane();
    const Vec3 q = places.space();
    const Vec3 plane = noise2d_vector3(p), space = noise3d_vector3(q);
    ASSERT_EQ(plane[0], noise2d(p));
    ASSERT_EQ(space[0], noise3d(q));
    different += (plane[1] != plane[2]) + (space[1] != space[2]);
  }
  EXPECT_GT(different, 150);
}

TEST(Fractal, EqualsNoiseForOneOctave) {
  const lanes::FpGuard guard;
  const Vec3 p = point(0.3f, -1.7f, 20.1f);
  EXPECT_EQ(fractal3d(p, hidden(1), hidden(2), hidden(0.5f)), noise3d(p));
  EXPECT_EQ(fractal3d_vector3(p, hidden(1), hidden(2), hidden(0.5f))[1], noise3d_vector3(p)[1]);
}

TEST(Fractal, IsZeroWithoutOctaves) {
  const lanes::FpGuard guard;
  const Vec3 p = point(0.3f, -1.7f, 20.1f);
  for (float octaves : {0.0f, -5.0f, nan}) {
    EXPECT_EQ(fractal3d(p, hidden(octaves), hidden(2), hidden(0.5f)), 0) << octaves;
    EXPECT_EQ(fractal3d_vector3(p, hidden(octaves), hidden(2), hidden(0.5f))[1], 0) << octaves;
  }
}

TEST(Fractal, SumsAtMostSixteenOctaves) {
  const lanes::FpGuard guard;
  const Vec3 p = point(0.3f, -1.7f, 20.1f);
  const auto fractal = [&](float octaves) { return fractal3d(p, hidden(octaves), hidden(2), hidden(0.5f)); };
  const Vec3 twice = point(0.6f, -3.4f, 40.2f);
  EXPECT_EQ(fractal(2), noise3d(p) + noise3d(twice) * 0.5f);
  EXPECT_EQ(fractal(1.5f), fractal(2));
  EXPECT_NE(fractal(15), fractal(16));
  EXPECT_EQ(fractal(17), fractal(16));
  EXPECT_EQ(fractal(inf), fractal(16));
}

TEST(CellNoise, IsConstantWithinACell) {
  const lanes::FpGuard guard;
  const float cell = cellnoise2d(point(-1, 3));
  EXPECT_EQ(cellnoise2d(point(-tiny, 3.99f)), cell);
  EXPECT_EQ(cellnoise2d(point(-0.5f, 3.5f)), cell);
  EXPECT_NE(cellnoise2d(point(0, 3.5f)), cell);
  EXPECT_NE(cellnoise2d(point(-0.5f, 4)), cell);
  EXPECT_NE(cellnoise3d(point(-1, 3, 0)), cellnoise3d(point(-1, 3, 1)));
}

TEST(CellNoise, IsUniformOverTheUnitInterval) {
  const lanes::FpGuard guard;
  std::vector<int> tenths(10);
  for (int x = -100; x < 100; ++x)
    for (int y = -50; y < 50; ++y) {
      const float r = cellnoise2d(point(static_cast<float>(x), static_cast<float>(y)));
      ASSERT_GE(r, 0.0f);
      ASSERT_LT(r, 1.0f);
      ++tenths[static_cast<size_t>(r * 10)];
    }
  for (int count : tenths) EXPECT_NEAR(count, 2000, 200);
}

TEST(WorleyNoise, IsTheDistanceToTheCellCentreWithoutJitter) {
  const lanes::FpGuard guard;
  EXPECT_EQ(worleynoise2d(point(3.5f, -0.5f), hidden(0)), 0.0f);
  EXPECT_EQ(worleynoise2d(point(3, 7), hidden(0)), std::sqrt(0.5f));
  const Vec3 three = worleynoise2d_vector3(point(3.5f, 7.5f), hidden(0));
  EXPECT_EQ(three[0], 0.0f);
  EXPECT_EQ(three[1], 1.0f);
  EXPECT_EQ(three[2], 1.0f);
}

TEST(WorleyNoise, ReturnsDistancesInAscendingOrder) {
  const lanes::FpGuard guard;
  Places places;
  for (int i = 0; i < 1000; ++i) {
    const Vec2 p = places.plane();
    const Vec3 three = worleynoise2d_vector3(p, hidden(1));
    ASSERT_EQ(three[0], worleynoise2d(p, hidden(1)));
    ASSERT_LT(three[0], three[1]);
    ASSERT_LT(three[1], three[2]);
    ASSERT_LT(three[0], std::sqrt(2.0f));
  }
}

TEST(WorleyNoise, IsInfiniteForNanJitter) {
  const lanes::FpGuard guard;
  EXPECT_EQ(worleynoise2d(point(0.5f, 0.5f), hidden(nan)), inf);
}

}  // namespace
}  // namespace isoshade::functions
