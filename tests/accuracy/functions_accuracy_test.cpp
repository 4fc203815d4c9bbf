// SPDX-License-Identifier: Apache-2.0
// Every row of functions.def keeps its error bound over its domain. With ISOSHADE_FULL=1 functions of one float
// are measured at every float of their domain; ISOSHADE_FUNCTION=name limits that to one.
#include "tests/accuracy/rows.h"

namespace isoshade::accuracy {
namespace {

#define FUNCTION(row, signature, ulp, domain, reference_, unit_)                \
  TEST(FunctionErrorIsWithinItsBound, row) {                                    \
    expect_variants_within<rows::row##_row>(#row, rows::row##_row::Variants{}); \
  }
#include "compiler/functions/functions.def"

TEST(FunctionTable, BoundsAndDomainsMeetTheirTargets) {
  EXPECT_EQ(rows::div_exact_row::bound, 0);
  EXPECT_EQ(rows::sqrt_exact_row::bound, 0);
  EXPECT_LE(rows::rsqrt_row::bound, 2);
  EXPECT_LE(rows::exp2_row::bound, 1.5);
  EXPECT_LE(rows::log2_row::bound, 1.5);
  EXPECT_LE(rows::pow_row::bound, 4);
  EXPECT_LE(rows::sin_row::bound, 2);
  EXPECT_LE(rows::cos_row::bound, 2);
  EXPECT_LE(rows::atan2_row::bound, 3);
  EXPECT_LE(rows::srgb_encode_row::bound, 4);
  EXPECT_LE(rows::srgb_decode_row::bound, 4);
  const auto holds_over = [](const Range& range, double low, double high) {
    EXPECT_LE(range.low, low);
    EXPECT_GE(range.high, high);
  };
  holds_over(rows::exp2_row::domain()[0], -126, 127.999);
  holds_over(rows::pow_row::domain()[0], 1e-6, 1e6);
  holds_over(rows::pow_row::domain()[1], -8, 8);
  constexpr double largest = 0x1.fffffep127;
  holds_over(rows::sin_row::domain()[0], -largest, largest);
  holds_over(rows::cos_row::domain()[0], -largest, largest);
  holds_over(rows::tan_row::domain()[0], -largest, largest);
  holds_over(rows::rotate2d_row::domain()[1], -largest, largest);
  holds_over(rows::srgb_encode_row::domain()[0], 0, 1);
  holds_over(rows::srgb_decode_row::domain()[0], 0, 1);
}

TEST(UnaryFunctions, StayWithinTheirBoundsForEveryFloat) {
  if (std::getenv("ISOSHADE_FULL") == nullptr) GTEST_SKIP() << "long; set ISOSHADE_FULL=1";
#define FUNCTION(row, signature, ulp, domain, reference_, unit_) \
  expect_all_floats_within<rows::row##_row>(#row, rows::row##_row::Variants{});
#include "compiler/functions/functions.def"
}

}  // namespace
}  // namespace isoshade::accuracy
