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

TEST(Normalize, ReturnsZeroForZero) {
  EXPECT_EQ(words(unit({0, 0, 0})), words(Vec3{0, 0, 0}));
  EXPECT_EQ(words(unit({-0.0f, 0, -0.0f})), words(Vec3{-0.0f, 0, -0.0f}));
}

TEST(Normalize, ReturnsNanForNonFiniteVectors) {
  EXPECT_TRUE(std::isnan(unit({inf, 1, 0})[0]));
  EXPECT_TRUE(std::isnan(unit({1, nan, 0})[1]));
  EXPECT_TRUE(std::isnan(unit({nan, nan, nan})[2]));
}

TEST(Normalize, IsIndependentOfScale) {
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

TEST(Length, AvoidsIntermediateOverflowAndUnderflow) {
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

TEST(Refract, ReturnsZeroUnderTotalInternalReflection) {
  const lanes::FpGuard guard;
  const Vec3 grazing = hidden(Vec3{0.99f, -0.14106736f, 0});
  EXPECT_EQ(words(refract(grazing, hidden(Vec3{0, 1, 0}), functions::hidden(1.5f))), words(Vec3{0, 0, 0}));
  EXPECT_EQ(words(refract(hidden(Vec3{0, nan, 0}), hidden(Vec3{0, 1, 0}), functions::hidden(1.5f))),
            words(Vec3{0, 0, 0}));
}

TEST(Refract, KeepsTheDirectionBetweenEqualMedia) {
  const lanes::FpGuard guard;
  const Vec3 in = hidden(Vec3{0.6f, -0.8f, 0});
  const Vec3 out = refract(in, hidden(Vec3{0, 1, 0}), functions::hidden(1.0f));
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(out[i], in[i], 1e-6);
}

TEST(Reflect, NegatesTheNormalComponent) {
  const lanes::FpGuard guard;
  EXPECT_EQ(words(reflect(hidden(Vec3{1, -2, 3}), hidden(Vec3{0, 1, 0}))), words(Vec3{1, 2, 3}));
}

TEST(Cross, IsRightHanded) {
  const lanes::FpGuard guard;
  EXPECT_EQ(words(cross(hidden(Vec3{1, 0, 0}), hidden(Vec3{0, 1, 0}))), words(Vec3{0, 0, 1}));
}

TEST(NormalMatrix, KeepsNormalsOutwardUnderMirroring) {
  const lanes::FpGuard guard;
  const mat<float, 3> mirror{{hidden(Vec3{-2, 0, 0}), hidden(Vec3{0, 1, 0}), hidden(Vec3{0, 0, 1})}};
  const mat<float, 3> normals = normal_matrix(mirror);
  EXPECT_LT(normals[0][0], 0);  // the face at +x comes to lie at -x
  EXPECT_GT(normals[1][1], 0);
  EXPECT_GT(normals[2][2], 0);
}

TEST(Luminance, IsOneForWhiteAndZeroForBlack) {
  const lanes::FpGuard guard;
  EXPECT_EQ(luminance(hidden(Vec3{1, 1, 1})), 1.0f);
  EXPECT_EQ(luminance(hidden(Vec3{0, 0, 0})), 0.0f);
}

std::vector<uint32_t> rgb(const Vec3& hsv) {
  const lanes::FpGuard guard;
  return words(hsv_to_rgb(hidden(hsv)));
}

std::vector<uint32_t> hsv(const Vec3& rgb) {
  const lanes::FpGuard guard;
  return words(rgb_to_hsv(hidden(rgb)));
}

TEST(HsvToRgb, IsExactForPureColours) {
  const float third = 0.333333343f;
  for (float turns : {0.0f, 1.0f, -2.0f}) {
    EXPECT_EQ(rgb({turns, 1, 1}), words(Vec3{1, 0, 0})) << turns;
    EXPECT_EQ(rgb({turns + 0.5f, 1, 0.75f}), words(Vec3{0, 0.75f, 0.75f})) << turns;
  }
  EXPECT_EQ(rgb({third, 1, 1}), words(Vec3{0, 1, 0}));
  EXPECT_EQ(rgb({2 * third, 1, 1}), words(Vec3{0, 0, 1}));
  EXPECT_EQ(rgb({0.3f, 0, 0.7f}), words(Vec3{0.7f, 0.7f, 0.7f}));
  EXPECT_EQ(rgb({nan, 0.5f, 0.5f}), words(Vec3{0.25f, 0.25f, 0.25f}));
}

TEST(RgbToHsv, HueIsZeroForGreysAndNegatives) {
  EXPECT_EQ(hsv({0.3f, 0.3f, 0.3f}), words(Vec3{0, 0, 0.3f}));
  EXPECT_EQ(hsv({0, 0, 0}), words(Vec3{0, 0, 0}));
  EXPECT_EQ(hsv({-1, -2, -3}), words(Vec3{0, 0, -1}));
}

TEST(RgbToHsv, IsInvertedByHsvToRgb) {
  const lanes::FpGuard guard;
  std::mt19937 random(1);
  const auto part = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
  for (int i = 0; i < 1000; ++i) {
    const Vec3 color = hidden(Vec3{part(), part(), part()});
    const Vec3 back = hsv_to_rgb(rgb_to_hsv(color));
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(back[k], color[k], 1e-6);
  }
}

TEST(Rotate2d, IsExactForQuarterTurns) {
  const lanes::FpGuard guard;
  const auto turned = [](float degrees) {
    const float x = functions::hidden(0.1f), y = functions::hidden(0.7f);
    return words(rotate2d(vec<float, 2>{x, y}, functions::hidden(degrees)));
  };
  using Vec2 = vec<float, 2>;
  for (float turns : {0.0f, 360.0f, -720.0f, 360000.0f}) EXPECT_EQ(turned(turns), words(Vec2{0.1f, 0.7f}));
  for (float turns : {inf, -inf, nan}) EXPECT_EQ(turned(turns), words(Vec2{nan, nan}));
  EXPECT_EQ(turned(90), words(Vec2{0.7f, -0.1f}));
  EXPECT_EQ(turned(-90), words(Vec2{-0.7f, 0.1f}));
  EXPECT_EQ(turned(180), words(Vec2{-0.1f, -0.7f}));
}

TEST(Place2d, MovesThePivotOnlyByTheOffset) {
  const lanes::FpGuard guard;
  using Vec2 = vec<float, 2>;
  const Vec2 pivot{functions::hidden(0.5f), functions::hidden(0.25f)};
  const Vec2 scale{functions::hidden(3), functions::hidden(0.1f)};
  const Vec2 offset{functions::hidden(0.125f), functions::hidden(-1)};
  EXPECT_EQ(words(place2d(pivot, pivot, scale, functions::hidden(33), offset)), words(Vec2{0.375f, 1.25f}));
}

TEST(Inverse, TimesTheMatrixIsTheIdentity) {
  const lanes::FpGuard guard;
  std::mt19937 random(1);
  const auto part = [&] { return functions::hidden(static_cast<float>(random() >> 8) * 0x1p-23f - 1); };
  for (int i = 0; i < 1000; ++i) {
    const auto column = [&](float x, float y, float z, float w) {
      return vec<float, 4>{x + part(), y + part(), z + part(), w + part()};
    };
    const mat<float, 4> m{{column(5, 0, 0, 0), column(0, -5, 0, 0), column(0, 0, 5, 0), column(0, 0, 0, 5)}};
    const mat<float, 4> one = matmul(inverse(m), m);
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 4; ++r) ASSERT_NEAR(one[c][r], c == r ? 1 : 0, 1e-6);
  }
}

TEST(Determinant, IsTheDiagonalProductOfTriangularMatrices) {
  const lanes::FpGuard guard;
  const mat<float, 3> m{{hidden(Vec3{2, 7, 11}), hidden(Vec3{0, -3, 13}), hidden(Vec3{0, 0, 5})}};
  EXPECT_EQ(determinant(m), -30.0f);
  EXPECT_EQ(determinant(transpose(m)), -30.0f);
}

TEST(Inverse, IsNotFiniteForSingularMatrices) {
  const lanes::FpGuard guard;
  const Vec3 x = hidden(Vec3{1, 2, 3});
  const mat<float, 3> flat = inverse(mat<float, 3>{{x, x, hidden(Vec3{0, 0, 1})}});
  EXPECT_FALSE(std::isfinite(flat[0][0]));
}

TEST(TransformPoint, AddsTheTranslationUnlikeTransformVector) {
  const lanes::FpGuard guard;
  const auto column = [](float x, float y, float z, float w) {
    const Vec3 upper = hidden(Vec3{x, y, z});
    return vec<float, 4>{upper[0], upper[1], upper[2], functions::hidden(w)};
  };
  const mat<float, 4> m{{column(0, 2, 0, 9), column(-2, 0, 0, 9), column(0, 0, 2, 9), column(10, 20, 30, 9)}};
  const Vec3 v = hidden(Vec3{1, 2, 3});
  EXPECT_EQ(words(transform_vector(m, v)), words(Vec3{-4, 2, 6}));
  EXPECT_EQ(words(transform_point(m, v)), words(Vec3{6, 22, 36}));
  EXPECT_EQ(words(transform_normal(m, v)), words(Vec3{-8, 4, 12}));
}

TEST(Matmul, AppliesItsFactorsInSequence) {
  const lanes::FpGuard guard;
  const mat<float, 3> turn{{hidden(Vec3{0, 1, 0}), hidden(Vec3{-1, 0, 0}), hidden(Vec3{0, 0, 1})}};
  const mat<float, 3> scale{{hidden(Vec3{2, 0, 0}), hidden(Vec3{0, 3, 0}), hidden(Vec3{0, 0, 5})}};
  const Vec3 v = hidden(Vec3{1, 10, 100});
  EXPECT_EQ(words(transform(matmul(turn, scale), v)), words(Vec3{-30, 2, 500}));
  EXPECT_EQ(words(transform(transpose(turn), transform(turn, v))), words(v));
}

}  // namespace
}  // namespace isoshade::functions
