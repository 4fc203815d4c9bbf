// SPDX-License-Identifier: Apache-2.0
// A gradient that falls where it should rise shows as a line. With ISOSHADE_FULL=1 every float is visited.
#include <cstdlib>
#include <gtest/gtest.h>

#include "compiler/functions/all.h"
#include "tests/accuracy/samples.h"

namespace isoshade::accuracy {
namespace {

/// Over runs of successive floats in [low, high], spread evenly; with ISOSHADE_FULL over all of them.
template <class Function>
void expect_rising(Function function, float low, float high) {
  const int64_t first = order(low);
  const int64_t last = order(high);
  const int64_t run = 4096;
  const int64_t stride = std::getenv("ISOSHADE_FULL") != nullptr ? run : std::max(run, (last - first) / 512);
  std::vector<float> results;
  float highest = -INFINITY;
  for (int64_t begin = first; begin <= last; begin += stride) {
    const int64_t end = std::min(last, begin + run);
    results.resize(static_cast<size_t>(end - begin + 1));
    {
      const lanes::FpGuard guard;
      for (int64_t i = begin; i <= end; ++i)
        results[static_cast<size_t>(i - begin)] = function(from_order(i));
    }
    for (size_t i = 0; i < results.size(); ++i) {
      ASSERT_GE(results[i], highest) << "at " << from_order(begin + static_cast<int64_t>(i));
      highest = results[i];
    }
  }
}

TEST(SrgbEncode, IsMonotonicFromZeroToOne) { expect_rising(functions::srgb_encode<float>, 0, 1); }
TEST(SrgbDecode, IsMonotonicFromZeroToOne) { expect_rising(functions::srgb_decode<float>, 0, 1); }
TEST(SrgbEncode, IsMonotonicAcrossItsSegments) {
  expect_rising(functions::srgb_encode<float>, 0.0031306f, 0.0031310f);
  expect_rising(functions::srgb_encode<float>, 0.05115f, 0.05125f);  // eighths of 0.8^4
}
TEST(SrgbDecode, IsMonotonicAcrossItsSegments) {
  expect_rising(functions::srgb_decode<float>, 0.0404f, 0.0405f);
  expect_rising(functions::srgb_decode<float>, 0.2799f, 0.2801f);
}

TEST(FastSrgbEncode, IsMonotonicFromZeroToOne) { expect_rising(functions::fast::srgb_encode<float>, 0, 1); }
TEST(FastSrgbDecode, IsMonotonicFromZeroToOne) { expect_rising(functions::fast::srgb_decode<float>, 0, 1); }
TEST(PreciseSrgbEncode, IsMonotonicFromZeroToOne) {
  expect_rising(functions::precise::srgb_encode<float>, 0, 1);
}
TEST(PreciseSrgbDecode, IsMonotonicFromZeroToOne) {
  expect_rising(functions::precise::srgb_decode<float>, 0, 1);
}
TEST(SrgbOfEveryTier, IsMonotonicAcrossItsSegmentsAndNearOne) {
  for (const auto encode : {functions::fast::srgb_encode<float>, functions::precise::srgb_encode<float>}) {
    expect_rising(encode, 0.0031306f, 0.0031310f);
    expect_rising(encode, 0.9999f, 1.0001f);
  }
  for (const auto decode : {functions::fast::srgb_decode<float>, functions::precise::srgb_decode<float>}) {
    expect_rising(decode, 0.0404f, 0.0405f);
    expect_rising(decode, 0.9999f, 1.0001f);
  }
}
TEST(SrgbOfEveryTier, IsExactAtAndBeyondZeroAndOne) {
  const lanes::FpGuard guard;
  for (const auto curve : {functions::fast::srgb_encode<float>, functions::precise::srgb_encode<float>,
                           functions::srgb_encode<float>, functions::fast::srgb_decode<float>,
                           functions::precise::srgb_decode<float>, functions::srgb_decode<float>}) {
    for (const float x : {0.0f, -0.0f, -1.0f, -INFINITY, std::nanf("")}) EXPECT_EQ(curve(x), 0.0f) << x;
    for (const float x : {1.0f, std::nextafter(1.0f, 2.0f), 3e38f, INFINITY}) EXPECT_EQ(curve(x), 1.0f) << x;
  }
}
TEST(Smoothstep, NeverExceedsOne) {
  const lanes::FpGuard guard;
  for (int64_t i = order(1.0f) - 1000000; i <= order(1.0f); ++i)
    ASSERT_LE(functions::smoothstep(0.0f, 1.0f, from_order(i)), 1.0f) << from_order(i);
}

}  // namespace
}  // namespace isoshade::accuracy
