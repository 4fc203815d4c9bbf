// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gtest/gtest.h>

#include "compiler/functions/all.h"
#include "tests/unit/functions_values.h"

namespace isoshade::functions {
namespace {

using Vec3 = vec<float, 3>;

template <int N>
std::vector<uint32_t> words(const vec<float, N>& v) {
  std::vector<uint32_t> list;
  for (int i = 0; i < N; ++i) list.push_back(bits_of(v[i]));
  return list;
}

Vec3 hidden(const Vec3& v) {
  return {functions::hidden(v[0]), functions::hidden(v[1]), functions::hidden(v[2])};
}

Vec3 unit(const Vec3& v) {
  const lanes::FpGuard guard;
  return hidden(normalize(hidden(v)));
}

float measure(const Vec3& v) {
  const lanes::FpGuard guard;
  return functions::hidden(length(hidden(v)));
}

TEST(Normalize, GivesZeroForZero) {
  EXPECT_EQ(words(unit({0, 0, 0})), words(Vec3{0, 0, 0}));
  EXPECT_EQ(words(unit({-0.0f, 0, -0.0f})), words(Vec3{-0.0f, 0, -0.0f}));
}

TEST(Normalize, GivesNanForWhatHasNoDirection) {
  EXPECT_TRUE(std::isnan(unit({inf, 1, 0})[0]));
  EXPECT_TRUE(std::isnan(unit({1, nan, 0})[1]));
  EXPECT_TRUE(std::isnan(unit({nan, nan, nan})[2]));
}

TEST(Normalize, GivesTheSameAtEveryScale) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const auto part = [&] { return 1.0f + static_cast<float>(random() >> 9) * 0x1p-23f; };
    const Vec3 v{part(), -part(), part()};
    const Vec3 expected = unit(v);
    for (int e = -126; e <= 126; e += 7) {
      const float scale = std::ldexp(1.0f, e);
      ASSERT_EQ(words(unit({v[0] * scale, v[1] * scale, v[2] * scale})), words(expected)) << e;
    }
    const double norm = std::hypot(expected[0], expected[1], expected[2]);
    ASSERT_NEAR(norm, 1, 0x1p-22);
  }
}

TEST(Length, NeitherOverflowsNorUnderflowsOnTheWay) {
  EXPECT_EQ(measure({3e30f, 4e30f, 0}), 5e30f);
  EXPECT_EQ(measure({3e-30f, 0, 4e-30f}), 5e-30f);
  EXPECT_EQ(measure({tiny, 0, 0}), tiny);
  EXPECT_EQ(measure({huge, 0, 0}), huge);
  EXPECT_EQ(measure({huge, huge, 0}), inf);
  EXPECT_EQ(bits_of(measure({0, -0.0f, 0})), bits_of(0));
  EXPECT_EQ(measure({-inf, 0, 1}), inf);
  EXPECT_TRUE(std::isnan(measure({nan, 0, 1})));
  EXPECT_TRUE(std::isnan(measure({1, 0, nan})));
}

TEST(Refract, GivesZeroUnderTotalReflection) {
  const lanes::FpGuard guard;
  const Vec3 grazing = hidden(Vec3{0.99f, -0.14106736f, 0});
  EXPECT_EQ(words(refract(grazing, hidden(Vec3{0, 1, 0}), functions::hidden(1.5f))), words(Vec3{0, 0, 0}));
  EXPECT_EQ(words(refract(hidden(Vec3{0, nan, 0}), hidden(Vec3{0, 1, 0}), functions::hidden(1.5f))),
            words(Vec3{0, 0, 0}));
}

TEST(Refract, GoesStraightOnBetweenEqualMedia) {
  const lanes::FpGuard guard;
  const Vec3 in = hidden(Vec3{0.6f, -0.8f, 0});
  const Vec3 out = refract(in, hidden(Vec3{0, 1, 0}), functions::hidden(1.0f));
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(out[i], in[i], 1e-6);
}

TEST(Reflect, TurnsTheNormalPart) {
  const lanes::FpGuard guard;
  EXPECT_EQ(words(reflect(hidden(Vec3{1, -2, 3}), hidden(Vec3{0, 1, 0}))), words(Vec3{1, 2, 3}));
}

TEST(Cross, IsRightHanded) {
  const lanes::FpGuard guard;
  EXPECT_EQ(words(cross(hidden(Vec3{1, 0, 0}), hidden(Vec3{0, 1, 0}))), words(Vec3{0, 0, 1}));
}

TEST(NormalMatrix, KeepsNormalsOutsideUnderMirroring) {
  const lanes::FpGuard guard;
  const mat<float, 3> mirror{{hidden(Vec3{-2, 0, 0}), hidden(Vec3{0, 1, 0}), hidden(Vec3{0, 0, 1})}};
  const mat<float, 3> normals = normal_matrix(mirror);
  EXPECT_LT(normals[0][0], 0);  // the face at +x comes to lie at -x
  EXPECT_GT(normals[1][1], 0);
  EXPECT_GT(normals[2][2], 0);
}

TEST(Luminance, OfWhiteIsOne) {
  const lanes::FpGuard guard;
  EXPECT_EQ(luminance(hidden(Vec3{1, 1, 1})), 1.0f);
  EXPECT_EQ(luminance(hidden(Vec3{0, 0, 0})), 0.0f);
}

TEST(Matmul, ActsAsItsFactorsInTurn) {
  const lanes::FpGuard guard;
  const mat<float, 3> turn{{hidden(Vec3{0, 1, 0}), hidden(Vec3{-1, 0, 0}), hidden(Vec3{0, 0, 1})}};
  const mat<float, 3> scale{{hidden(Vec3{2, 0, 0}), hidden(Vec3{0, 3, 0}), hidden(Vec3{0, 0, 5})}};
  const Vec3 v = hidden(Vec3{1, 10, 100});
  EXPECT_EQ(words(transform(matmul(turn, scale), v)), words(Vec3{-30, 2, 500}));
  EXPECT_EQ(words(transform(transpose(turn), transform(turn, v))), words(v));
}

}  // namespace
}  // namespace isoshade::functions
