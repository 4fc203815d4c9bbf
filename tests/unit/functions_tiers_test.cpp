// SPDX-License-Identifier: Apache-2.0
// The tiers: which bodies there are, and what they give at the ends of their domains and beyond, as their docstrings
// say.
#include <gtest/gtest.h>

#include "compiler/functions/all.h"
#include "compiler/functions/library.h"
#include "compiler/ir/printer.h"
#include "tests/unit/functions_values.h"

namespace isoshade::functions {
namespace {

template <class... T>
float call(float (*function)(T...), std::type_identity_t<T>... arguments) {
  const lanes::FpGuard guard;
  return hidden(function(hidden(arguments)...));
}

std::string expanded(std::string_view row, Tier tier) {
  ir::Module module;
  for (const Variant& variant : variants())
    if (variant.row == row) declare(module, variant);
  expand(module, tier);
  return ir::print(module);
}

TEST(Tiers, AreFoundByName) {
  for (const Tier tier : tiers) EXPECT_EQ(find_tier(tier_name(tier)), tier);
  EXPECT_EQ(tier_name(Tier::standard), "default");
  EXPECT_EQ(find_tier("best"), std::nullopt);
}

TEST(Tiers, HaveTheirOwnBodiesWhereTheTableSaysSo) {
#define TIER(tier, row, ulp, domain, unit) \
  EXPECT_NE(expanded(#row, Tier::tier), expanded(#row, Tier::standard)) << #row " " #tier;
#define FOLLOWS TIER
#include "compiler/functions/functions.def"
  EXPECT_EQ(expanded("mix", Tier::fast), expanded("mix", Tier::standard));
}

TEST(Tiers, ApplyToCalledFunctions) {
  // A vector's power is that of each component, and safepower's magnitude a power.
  for (const Variant& variant : variants()) {
    if (variant.row != "safepower" && variant.name != "pow_v3") continue;
    EXPECT_FALSE(variant.has_own_body(Tier::fast)) << variant.name;
    EXPECT_NE(variant.accuracy[static_cast<size_t>(Tier::fast)].ulp,
              variant.accuracy[static_cast<size_t>(Tier::standard)].ulp)
        << variant.name;
    ir::Module fast, usual;
    declare(fast, variant), expand(fast, Tier::fast);
    declare(usual, variant), expand(usual);
    EXPECT_NE(ir::print(fast), ir::print(usual)) << variant.name;
  }
}

TEST(Tiers, PreciseBoundNeverExceedsTheDefault) {
  for (const Variant& variant : variants())
    EXPECT_LE(variant.accuracy[static_cast<size_t>(Tier::precise)].ulp,
              variant.accuracy[static_cast<size_t>(Tier::standard)].ulp)
        << variant.name;
}

TEST(SpecialValues, InThePreciseTierMatchTheDefault) {
  const float spicy[] = {0.0f, -0.0f, 1,     -1,     2,   0.5f, tiny, -tiny, inf,
                         -inf, nan,   3e38f, -3e38f, 128, -126, 1e6f, -150};
  for (const float x : spicy) {
    EXPECT_EQ(bits_of(call(precise::exp2<float>, x)) >> 3, bits_of(call(exp2<float>, x)) >> 3) << x;
    EXPECT_EQ(bits_of(call(precise::sin<float>, x)) >> 8, bits_of(call(sin<float>, x)) >> 8) << x;
    EXPECT_EQ(bits_of(call(precise::cos<float>, x)) >> 8, bits_of(call(cos<float>, x)) >> 8) << x;
    EXPECT_EQ(bits_of(call(precise::srgb_encode<float>, x)) >> 3, bits_of(call(srgb_encode<float>, x)) >> 3)
        << x;
    if (!(x > 0) || x == inf || x == 1) {
      EXPECT_EQ(bits_of(call(precise::rsqrt<float>, x)), bits_of(call(rsqrt<float>, x))) << x;
    }
    for (const float y : {0.0f, -0.0f, inf, -inf, nan})
      EXPECT_EQ(bits_of(call(precise::pow<float>, x, y)), bits_of(call(pow<float>, x, y))) << x << " " << y;
    const lanes::FpGuard guard;
    for (const float y : {0.0f, nan, inf, 3e38f, tiny}) {
      const vec<float, 2> v{hidden(x), hidden(y)};
      for (int i = 0; i < 2; ++i) {
        const float a = precise::normalize(v)[i], b = functions::normalize(v)[i];
        if (v[0] == v[0] && v[1] == v[1]) {
          EXPECT_TRUE(bits_of(a) == bits_of(b) || std::abs(a - b) < 3e-7f)
              << x << " " << y << ": " << a << " " << b;
        }
      }
      for (int i = 0; i < 2; ++i)
        EXPECT_EQ(v[i] != v[i], v[i] != v[i] && precise::normalize(v)[i] != precise::normalize(v)[i]);
      const float a = precise::length(v), b = functions::length(v);
      EXPECT_TRUE(bits_of(a) == bits_of(b) || std::abs(a - b) < 3e-7f * b)
          << x << " " << y << ": " << a << " " << b;
    }
  }
}

TEST(SpecialValues, InTheFastTierMatchClampedArguments) {
  for (const float x : {-inf, nan, -1e6f, -126.0f}) {
    EXPECT_EQ(call(fast::exp2<float>, x), 0x1p-126f) << x;
    EXPECT_EQ(call(fast::exp<float>, x), 0x1p-126f) << x;
  }
  EXPECT_EQ(call(fast::exp2<float>, inf), call(fast::exp2<float>, 127.9999f));
  EXPECT_EQ(call(fast::exp2<float>, 0.0f), 1.0f);
  EXPECT_EQ(call(fast::exp2<float>, -3.0f), 0.125f);
  for (const float x : {0.0f, -0.0f, -1.0f, nan, -inf}) {
    EXPECT_EQ(call(fast::log2<float>, x), -126.0f) << x;
    EXPECT_EQ(call(fast::rsqrt<float>, x), call(fast::rsqrt<float>, 0x1p-126f)) << x;
    EXPECT_EQ(call(fast::pow<float>, x, 1.0f), 0x1p-126f) << x;
    EXPECT_EQ(call(fast::pow<float>, x, 0.0f), 1.0f) << x;
  }
  EXPECT_EQ(call(fast::log2<float>, inf), 128.0f);
  EXPECT_EQ(call(fast::log2<float>, 8.0f), 3.0f);
  EXPECT_EQ(call(fast::pow<float>, 1.0f, 1000.0f), 1.0f);
  EXPECT_EQ(call(fast::pow<float>, 2.0f, nan), 0x1p-126f);
  EXPECT_EQ(call(fast::sin<float>, 0.0f), 0.0f);
  EXPECT_EQ(bits_of(call(fast::sin<float>, -0.0f)), 0u);
  for (const float x : {inf, -inf, nan}) {
    EXPECT_EQ(bits_of(call(fast::sin<float>, x)), bits_of(nan)) << x;
    EXPECT_EQ(bits_of(call(fast::cos<float>, x)), bits_of(nan)) << x;
  }
  for (const float x : {1e6f, -3e38f, 8193.0f}) {
    EXPECT_EQ(call(fast::sin<float>, x), call(sin<float>, x)) << x;
    EXPECT_EQ(call(fast::cos<float>, x), call(cos<float>, x)) << x;
  }
  const lanes::FpGuard guard;
  const vec<float, 3> zero{hidden(0.0f), hidden(0.0f), hidden(-0.0f)};
  EXPECT_EQ(fast::length(zero), 0.0f);
  EXPECT_EQ(bits_of(fast::normalize(zero)[2]), bits_of(-0.0f));
}

}  // namespace
}  // namespace isoshade::functions
