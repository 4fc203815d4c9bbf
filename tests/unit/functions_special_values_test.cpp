// SPDX-License-Identifier: Apache-2.0
// What functions give outside and at the ends of their domains, as their docstrings say.
#include <cmath>
#include <gtest/gtest.h>
#include <string>

#include "compiler/functions/all.h"
#include "tests/unit/functions_values.h"

namespace isoshade::functions {
namespace {

struct Row {
  std::string call;
  float result;
  float expected;
};

void expect_rows(const std::vector<Row>& rows) {
  for (const Row& row : rows)
    EXPECT_EQ(bits_of(row.result), bits_of(row.expected)) << row.call << " gave " << row.result;
}

// Calls a function on hidden arguments; the text of the call names the row.
template <class... T>
float call(float (*function)(T...), std::type_identity_t<T>... arguments) {
  const lanes::FpGuard guard;
  return hidden(function(hidden(arguments)...));
}
#define CALL(name, ...) #name "(" #__VA_ARGS__ ")", call(name <float>, __VA_ARGS__)

TEST(SpecialValues, AreCorrectForMinMaxClampAndStep) {
  expect_rows({
      {CALL(min, 1, nan), 1},          {CALL(min, nan, 1), nan},       {CALL(min, 0.0f, -0.0f), 0.0f},
      {CALL(min, -0.0f, 0.0f), -0.0f}, {CALL(min, -inf, 1), -inf},     {CALL(max, 1, nan), 1},
      {CALL(max, nan, 1), nan},        {CALL(max, 0.0f, -0.0f), 0.0f}, {CALL(max, -0.0f, 0.0f), -0.0f},
      {CALL(max, inf, 1), inf},        {CALL(clamp, nan, 0, 1), nan},  {CALL(clamp, inf, 0, 1), 1},
      {CALL(clamp, 5, 3, 2), 2},       {CALL(clamp, 0, 3, 2), 2},      {CALL(saturate, nan), 0.0f},
      {CALL(saturate, -0.0f), 0.0f},   {CALL(saturate, inf), 1},       {CALL(saturate, -inf), 0.0f},
      {CALL(saturate, tiny), tiny},    {CALL(sign, 0.0f), 0.0f},       {CALL(sign, -0.0f), -0.0f},
      {CALL(sign, nan), nan},          {CALL(sign, -inf), -1},         {CALL(sign, tiny), 1},
      {CALL(step, 1, 1), 1},           {CALL(step, 1, 0.9999999f), 0}, {CALL(step, nan, 0), 1},
      {CALL(step, 0, nan), 1},         {CALL(step, -0.0f, 0.0f), 1},
  });
}

TEST(SpecialValues, AreCorrectForRounding) {
  expect_rows({
      {CALL(ceil, 0.25f), 1},
      {CALL(ceil, -0.75f), -0.0f},
      {CALL(ceil, -0.0f), -0.0f},
      {CALL(ceil, tiny), 1},
      {CALL(ceil, -inf), -inf},
      {CALL(ceil, nan), nan},
      {CALL(round, 0.5f), 0.0f},
      {CALL(round, 1.5f), 2},
      {CALL(round, 2.5f), 2},
      {CALL(round, -0.5f), -0.0f},
      {CALL(round, -1.5f), -2},
      {CALL(round, 0.49999997f), 0.0f},
      {CALL(round, 8388607.5f), 8388608},
      {CALL(round, 8388606.5f), 8388606},
      {CALL(round, -8388609), -8388609},
      {CALL(round, -0.0f), -0.0f},
      {CALL(round, huge), huge},
      {CALL(round, -inf), -inf},
      {CALL(round, nan), nan},
  });
}

TEST(SpecialValues, AreCorrectForRemainders) {
  expect_rows({
      {CALL(fract, 2.75f), 0.75f},
      {CALL(fract, -0.25f), 0.75f},
      {CALL(fract, -1e-10f), 0x1.fffffep-1f},
      {CALL(fract, 1e10f), 0},
      {CALL(fract, inf), nan},
      {CALL(fract, nan), nan},
      {CALL(mod, 5.5f, 2), 1.5f},
      {CALL(mod, -5.5f, 2), 0.5f},
      {CALL(mod, 5.5f, -2), -0.5f},
      {CALL(mod, -5.5f, -2), -1.5f},
      {CALL(mod, 6, 3), 0},
      {CALL(mod, 6, -3), 0},
      {CALL(mod, 3e38f, 1e-3f), 0x1.5b16d4p-11f},
      {CALL(mod, -3e38f, 1e-3f), 0x1.6265dp-12f},
      {CALL(mod, 3e38f, -1e-3f), -0x1.6265dp-12f},
      {CALL(mod, huge, 3), 0},
      {CALL(mod, huge, tiny), 0},
      {CALL(mod, -tiny, huge), huge},
      {CALL(mod, 1, 0), nan},
      {CALL(mod, inf, 0), nan},
      {CALL(mod, inf, 1), nan},
      {CALL(mod, 1, inf), nan},
      {CALL(mod, nan, 1), nan},
      {CALL(mod, 1, nan), nan},
  });
}

TEST(SpecialValues, ModIsExactForLargeQuotientsAndBoundedByItsDivisor) {
  std::mt19937 random(3);
  int large = 0;
  for (int i = 0; i < 200000; ++i) {
    const float x = any_float(random), y = any_float(random);
    const float given = call(mod<float>, x, y);
    if (!(std::abs(x) < inf) || !(std::abs(y) < inf) || y == 0) {
      EXPECT_NE(given, given) << x << " " << y;
      continue;
    }
    EXPECT_LE(std::abs(given), std::abs(y)) << x << " " << y;
    EXPECT_TRUE(given == 0 || (given < 0) == (y < 0)) << x << " " << y;
    if (!(std::abs(x) / std::abs(y) >= 0x1p20f)) continue;
    long double exact = std::fmod(static_cast<long double>(x), static_cast<long double>(y));
    if (exact != 0 && (exact < 0) != (y < 0)) exact += y;
    EXPECT_EQ(given, std::abs(exact) < 0x1p-126L ? 0 : static_cast<float>(exact)) << x << " " << y;
    ++large;
  }
  EXPECT_GT(large, 10000);
}

TEST(SpecialValues, Rotate2dIgnoresWholeTurns) {
  std::mt19937 random(4);
  for (int i = 0; i < 20000; ++i) {
    const float degrees = std::ldexp(1 + static_cast<float>(random() >> 9) * 0x1p-23f, 22 + i % 106);
    const float rest = std::fmod(degrees, 360.0f);
    const lanes::FpGuard guard;
    const vec<float, 2> v{hidden(3), hidden(5)};
    for (const float sign : {1.0f, -1.0f}) {
      const vec<float, 2> far = rotate2d(v, hidden(sign * degrees)), near = rotate2d(v, hidden(sign * rest));
      EXPECT_EQ(bits_of(far[0]), bits_of(near[0])) << degrees;
      EXPECT_EQ(bits_of(far[1]), bits_of(near[1])) << degrees;
    }
  }
  const lanes::FpGuard guard;
  for (const float degrees : {inf, -inf, nan}) {
    const vec<float, 2> v = rotate2d(vec<float, 2>{hidden(3), hidden(5)}, hidden(degrees));
    EXPECT_TRUE(v[0] != v[0] && v[1] != v[1]) << degrees;
  }
}

TEST(SpecialValues, AreCorrectForVectorsAndColours) {
  const lanes::FpGuard guard;
  const auto three = [](float x, float y, float z) { return vec<float, 3>{hidden(x), hidden(y), hidden(z)}; };
  const auto is_nan = [](float x) { return x != x; };
  EXPECT_TRUE(is_nan(normalize(three(inf, 1, 0))[0]));
  EXPECT_TRUE(is_nan(normalize(three(1, nan, 0))[1]));
  EXPECT_EQ(normalize(three(0, 0, 0))[0], 0);
  EXPECT_EQ(normalize(three(huge, 0, 0))[0], 1);
  EXPECT_EQ(normalize(three(tiny, 0, 0))[0], 1);
  EXPECT_EQ(length(three(inf, 1, 0)), inf);
  EXPECT_TRUE(is_nan(length(three(nan, 1, 0))));
  EXPECT_EQ(distance(three(huge, 0, 0), three(-huge, 0, 0)), inf);
  EXPECT_EQ(dot(three(huge, 0, 0), three(huge, 0, 0)), inf);
  EXPECT_TRUE(is_nan(cross(three(huge, huge, 0), three(huge, huge, 0))[2]));
  EXPECT_EQ(refract(three(nan, 0, 1), three(0, 0, 1), 0.5f)[0], 0);
  EXPECT_TRUE(is_nan(luminance(three(inf, -inf, 0))));
  for (const vec<float, 3>& colour : {three(0, 0, 0), three(-1, -2, 0), three(-3, -1, -2)}) {
    EXPECT_EQ(rgb_to_hsv(colour)[0], 0);
    EXPECT_EQ(rgb_to_hsv(colour)[1], 0);
  }
  EXPECT_EQ(hsv_to_rgb(three(inf, 0.25f, 2))[0], 1.5f);
  EXPECT_EQ(hsv_to_rgb(three(-0.75f, 1, 1))[1], hsv_to_rgb(three(0.25f, 1, 1))[1]);
  EXPECT_EQ(mip_level(three(huge, 0, 0), three(0, 0, 0)), inf);
  EXPECT_EQ(mip_level(three(0, 0, 0), three(0, 0, 0)), -inf);
  EXPECT_EQ(wrap(inf), 0);
  EXPECT_EQ(mirror(nan), 0);
}

TEST(SpecialValues, AreCorrectForOctaves) {
  const lanes::FpGuard guard;
  const vec<float, 3> p{hidden(0.25f), hidden(0.5f), hidden(0.75f)};
  const auto sum = [&](float octaves) { return fractal3d(p, hidden(octaves), 1.9f, 0.9f); };
  for (const float none : {0.0f, -0.0f, -1.0f, -inf, nan}) {
    EXPECT_EQ(bits_of(sum(none)), 0u) << none;
    EXPECT_EQ(bits_of(fractal3d_vector3(p, hidden(none), 2.0f, 0.5f)[1]), 0u) << none;
  }
  EXPECT_EQ(sum(1), noise3d(p));
  EXPECT_EQ(sum(0.25f), noise3d(p));
  EXPECT_EQ(sum(inf), sum(16));
  EXPECT_EQ(sum(17), sum(16));
  EXPECT_NE(sum(15), sum(16));
}

TEST(SpecialValues, AreCorrectForBlends) {
  expect_rows({
      {CALL(mix, 0.1f, 0.7f, 0), 0.1f},
      {CALL(mix, 0.1f, 0.7f, 1), 0.7f},
      {CALL(mix, 1e30f, -1e-30f, 1), -1e-30f},
      {CALL(mix, inf, 1, 1), nan},
      {CALL(smoothstep, 0, 1, 0.5f), 0.5f},
      {CALL(smoothstep, 0, 1, -inf), 0},
      {CALL(smoothstep, 0, 1, inf), 1},
      {CALL(smoothstep, 0, 1, nan), 0},
      {CALL(smoothstep, 2, 2, 1), 0},
      {CALL(smoothstep, 2, 2, 2), 0},
      {CALL(smoothstep, 2, 2, 2.0000002f), 1},
      {CALL(smoothstep, 1, 0, 2), 0},
      {CALL(smoothstep, 1, 0, -1), 1},
      {CALL(smoothstep, -huge, huge, 0), 0},
      {CALL(remap, 0.3f, 0.3f, 0.9f, 7.7f, -0.1f), 7.7f},
      {CALL(remap, 0.9f, 0.3f, 0.9f, 7.7f, -0.1f), -0.1f},
      {CALL(remap, 1, 0, 0.5f, 0, 1), 2},
      {CALL(remap, 1, 1, 1, 3, 4), 3},
      {CALL(remap, 7, 1, 1, 3, 4), 3},
      {CALL(remap, nan, 1, 1, 3, 4), 3},
      {CALL(remap, 0.5f, -huge, huge, 3, 4), 3},
      {CALL(smoothstep, 1, 1, inf), 1},
      {CALL(smoothstep, inf, inf, 1), 0},
      {CALL(contrast, huge, 2, 0), inf},
      {CALL(contrast, 0.25f, 2, 0.5f), 0},
      {CALL(contrast, 0.5f, inf, 0.5f), nan},
  });
}

TEST(SpecialValues, AreCorrectForPowersAndLogarithms) {
  expect_rows({
      {CALL(rsqrt, 0.0f), inf},      {CALL(rsqrt, -0.0f), inf},
      {CALL(rsqrt, inf), 0.0f},      {CALL(rsqrt, -1), nan},
      {CALL(rsqrt, -inf), nan},      {CALL(rsqrt, nan), nan},
      {CALL(rsqrt, tiny), 0x1p63f},  {CALL(rsqrt, 4), 0.5f},
      {CALL(exp2, nan), nan},        {CALL(exp2, inf), inf},
      {CALL(exp2, -inf), 0.0f},      {CALL(exp2, 128), inf},
      {CALL(exp2, -126), tiny},      {CALL(exp2, -126.00001f), 0.0f},
      {CALL(exp2, huge), inf},       {CALL(exp, 0.0f), 1},
      {CALL(exp, -0.0f), 1},         {CALL(exp, nan), nan},
      {CALL(exp, inf), inf},         {CALL(exp, -inf), 0.0f},
      {CALL(exp, -87.33655f), 0.0f}, {CALL(log2, 0.0f), -inf},
      {CALL(log2, -0.0f), -inf},     {CALL(log2, -1), nan},
      {CALL(log2, -inf), nan},       {CALL(log2, inf), inf},
      {CALL(log2, nan), nan},        {CALL(log2, 1), 0.0f},
      {CALL(log, 1), 0.0f},          {CALL(log, 0.0f), -inf},
      {CALL(log, -0.0f), -inf},      {CALL(log, -tiny), nan},
      {CALL(log, inf), inf},         {CALL(log, nan), nan},
  });
  for (int n = -126; n <= 127; ++n) {
    const float power = std::bit_cast<float>((n + 127) << 23);
    EXPECT_EQ(call(exp2<float>, static_cast<float>(n)), power);
    EXPECT_EQ(call(log2<float>, power), static_cast<float>(n));
  }
}

TEST(SpecialValues, AreCorrectForPow) {
  expect_rows({
      {CALL(pow, 2, 10), 1024},
      {CALL(pow, 0.0f, 0.0f), 1},
      {CALL(pow, nan, 0.0f), 1},
      {CALL(pow, -3, -0.0f), 1},
      {CALL(pow, inf, 0.0f), 1},
      {CALL(pow, 1, inf), 1},
      {CALL(pow, 1, -inf), 1},
      {CALL(pow, 1, nan), nan},
      {CALL(pow, nan, 1), nan},
      {CALL(pow, 0.0f, 2), 0.0f},
      {CALL(pow, -0.0f, 3), 0.0f},
      {CALL(pow, 0.0f, -2), inf},
      {CALL(pow, -0.0f, -3), inf},
      {CALL(pow, inf, 0.5f), inf},
      {CALL(pow, inf, -0.5f), 0.0f},
      {CALL(pow, 2, inf), inf},
      {CALL(pow, 2, -inf), 0.0f},
      {CALL(pow, 0.5f, inf), 0.0f},
      {CALL(pow, 0.5f, -inf), inf},
      {CALL(pow, 0.0f, inf), 0.0f},
      {CALL(pow, 0.0f, -inf), inf},
      {CALL(pow, -2, 2), nan},
      {CALL(pow, -inf, 2), nan},
      {CALL(pow, 2, 128), inf},
      {CALL(pow, 2, -126), tiny},
      {CALL(pow, 2, -127), 0.0f},
      {CALL(pow, huge, huge), inf},
      {CALL(pow, huge, -huge), 0.0f},
      {CALL(pow, huge, 1), huge},
      {CALL(pow, tiny, 1), tiny},
      {CALL(pow, 1.0000001f, huge), inf},
      {CALL(pow, 0.99999994f, huge), 0.0f},
  });
}

TEST(SpecialValues, AreCorrectForSafepower) {
  expect_rows({
      {CALL(safepower, 2, 3), 8},
      {CALL(safepower, -2, 3), -8},
      {CALL(safepower, -2, 2), -4},
      {CALL(safepower, -4, 0.5f), -2},
      {CALL(safepower, -3, 0.0f), -1},
      {CALL(safepower, 0.0f, 0.0f), 1},
      {CALL(safepower, -0.0f, 2), 0.0f},
      {CALL(safepower, -0.0f, -1), inf},
      {CALL(safepower, -inf, 1), -inf},
      {CALL(safepower, nan, 1), nan},
      {CALL(safepower, -1, nan), nan},
  });
}

TEST(SpecialValues, AreCorrectForTrigonometry) {
  expect_rows({
      {CALL(sin, 0.0f), 0.0f},
      {CALL(sin, inf), nan},
      {CALL(sin, -inf), nan},
      {CALL(sin, nan), nan},
      {CALL(sin, 131073), -0x1.024168p-1f},
      {CALL(sin, 1e6f), -0x1.6664b2p-2f},
      {CALL(sin, huge), -0x1.0b3366p-1f},
      {CALL(sin, -huge), 0x1.0b3366p-1f},
      {CALL(sin, tiny), tiny},
      {CALL(cos, 0.0f), 1},
      {CALL(cos, -0.0f), 1},
      {CALL(cos, inf), nan},
      {CALL(cos, nan), nan},
      {CALL(cos, -huge), 0x1.b4bf2cp-1f},
      {CALL(cos, 1e6f), 0x1.df9df8p-1f},
      {CALL(tan, 0.0f), 0.0f},
      {CALL(tan, inf), nan},
      {CALL(tan, nan), nan},
      {CALL(tan, 1e6f), -0x1.7e976ap-2f},
      {CALL(asin, 1), pi / 2},
      {CALL(asin, -1), -pi / 2},
      {CALL(asin, 1.0000001f), nan},
      {CALL(asin, nan), nan},
      {CALL(acos, 1), 0.0f},
      {CALL(acos, -1), pi},
      {CALL(acos, -1.0000001f), nan},
      {CALL(acos, 0.0f), pi / 2},
      {CALL(atan, inf), pi / 2},
      {CALL(atan, -inf), -pi / 2},
      {CALL(atan, nan), nan},
      {CALL(atan2, 0.0f, 0.0f), 0.0f},
      {CALL(atan2, 0.0f, 1), 0.0f},
      {CALL(atan2, 0.0f, -1), pi},
      {CALL(atan2, -0.0f, -1), pi},
      {CALL(atan2, 1, 0.0f), pi / 2},
      {CALL(atan2, -1, 0.0f), -pi / 2},
      {CALL(atan2, inf, inf), call(atan2<float>, 1, 1)},
      {CALL(atan2, 1, inf), 0.0f},
      {CALL(atan2, 1, -inf), pi},
      {CALL(atan2, -inf, 1), -pi / 2},
      {CALL(atan2, nan, 1), nan},
      {CALL(atan2, 1, nan), nan},
      {CALL(atan2, tiny, huge), 0.0f},
      {CALL(atan2, huge, huge), call(atan2<float>, 1, 1)},
  });
}

TEST(SpecialValues, AreCorrectForSrgbTransfer) {
  expect_rows({
      {CALL(srgb_encode, 0x1.9a5c38p-9f), 0x1.4b5da4p-5f},  // the threshold is of the linear piece
      {CALL(srgb_encode, 0.0f), 0.0f},
      {CALL(srgb_encode, 1), 1},
      {CALL(srgb_encode, 0.99999994f), 1},
      {CALL(srgb_encode, inf), 1},
      {CALL(srgb_encode, -1), 0.0f},
      {CALL(srgb_encode, -0.0f), 0.0f},
      {CALL(srgb_encode, nan), 0.0f},
      {CALL(srgb_encode, 1e-30f), 1.292e-29f},
      {CALL(srgb_decode, 0.0f), 0.0f},
      {CALL(srgb_decode, 1), 1},
      {CALL(srgb_decode, 1.0000001f), 1},
      {CALL(srgb_decode, -inf), 0.0f},
      {CALL(srgb_decode, nan), 0.0f},
  });
}

TEST(ExactForms, MatchHardwareDivisionAndSquareRoot) {
  std::mt19937 random(1);
  std::vector<std::pair<float, float>> pairs;
  for (float a : special_floats())
    for (float b : special_floats()) pairs.emplace_back(a, b);
  for (int i = 0; i < 300000; ++i) pairs.emplace_back(any_float(random), any_float(random));
  for (int i = 0; i < 300000; ++i) {  // quotients of significands alone, and near ties
    const float b = 1.0f + static_cast<float>(random() >> 9) * 0x1p-23f;
    const float q = 1.0f + static_cast<float>(random() >> 9) * 0x1p-23f;
    pairs.emplace_back(b * q, b);
  }
  for (const auto& [a, b] : pairs) {
    const lanes::FpGuard guard;
    const float x = hidden(a), y = hidden(b);
    ASSERT_EQ(bits_of(hidden(div_exact(x, y))), bits_of(hidden(x / y))) << a << " / " << b;
    ASSERT_EQ(bits_of(hidden(sqrt_exact(x))), bits_of(hidden(lanes::sqrt(x)))) << a;
    ASSERT_EQ(bits_of(hidden(sqrt_exact(x * x))), bits_of(hidden(lanes::sqrt(x * x)))) << a;
  }
}

}  // namespace
}  // namespace isoshade::functions
