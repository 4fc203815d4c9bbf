// SPDX-License-Identifier: Apache-2.0
// The reference's functions are those of the library: near their bodies on ordinary arguments, and of the same kind
// where arguments are infinite, zero or NaN.
#include <algorithm>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <set>

#include "backends/reference/functions.h"
#include "compiler/ir/interpreter.h"

namespace isoshade::reference {
namespace {

/// The body of a variant, in floats.
class Body {
 public:
  explicit Body(const functions::Variant& variant)
      : variant_(variant), function_(functions::declare(module_, variant)) {
    functions::expand(module_);
  }

  std::vector<float> operator()(const std::vector<float>& arguments) {
    std::vector<uint32_t> in, out;
    for (const float argument : arguments) in.push_back(std::bit_cast<uint32_t>(argument));
    for (const ir::Type type : variant_.results) out.resize(out.size() + type.width);
    ir::Interpreter interpreter(module_);
    EXPECT_TRUE(interpreter.run(function_, in, out));
    std::vector<float> results;
    for (const uint32_t bits : out) results.push_back(std::bit_cast<float>(bits));
    return results;
  }

 private:
  const functions::Variant& variant_;
  ir::Module module_;
  uint32_t function_;
};

std::vector<Real> exact(const functions::Variant& variant, const std::vector<float>& arguments,
                        size_t results) {
  const std::vector<Real> numbers(arguments.begin(), arguments.end());
  std::vector<Real> out(results);
  evaluate(variant, numbers, out);
  return out;
}

TEST(Reference, IsNearTheBodyOfEveryVariant) {
  std::mt19937 random(1);
  for (const functions::Variant& variant : functions::variants()) {
    Body body(variant);
    for (int sample = 0; sample < 20; ++sample) {
      std::vector<float> arguments;
      for (const ir::Type type : variant.parameters)
        for (uint32_t i = 0; i < type.width; ++i)
          arguments.push_back(0.1f + static_cast<float>(random() >> 8) * (0.8f * 0x1p-24f));
      const std::vector<float> given = body(arguments);
      const std::vector<Real> wanted = exact(variant, arguments, given.size());
      double size = 0;
      for (const Real& result : wanted) size = std::max(size, static_cast<double>(abs(result)));
      for (size_t i = 0; i < given.size(); ++i) {
        const auto off = static_cast<double>(abs(wanted[i] - given[i]));
        // Inverses of what is nearly singular are far off, but no further than their size tells.
        EXPECT_LE(off, 1e-5 * (1 + size * size)) << variant.name << " result " << i;
      }
    }
  }
}

constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
constexpr float huge = std::numeric_limits<float>::max(), tiny = 0x1p-126f;

/// The n-th of all combinations of values.
std::vector<float> combination(const std::vector<float>& values, size_t count, size_t n) {
  std::vector<float> chosen;
  for (size_t i = 0; i < count; ++i, n /= values.size()) chosen.push_back(values[n % values.size()]);
  return chosen;
}

TEST(Reference, MatchesScalarBodiesAtSpecialValues) {
  const std::vector<float> ordinary{0, -0.0f, 1, -1, 2, 0.5f, -2.5f, inf, -inf, nan};
  std::vector<float> all = ordinary;
  all.insert(all.end(), {tiny, -tiny, huge, -huge, 3e9f, -3e9f, 0x1p31f, 1e-30f, 1e30f, 131073, 1e6f, 0x1p24f,
                         0x1.fffffep-1f, 0x1.000002p0f});
  // Sums that overflow or cancel where the exact ones do not.
  const std::set<std::string_view> sums = {"mod", "mix", "contrast", "smoothstep"};
  for (const functions::Variant& variant : functions::variants()) {
    if (variant.name != variant.row || variant.parameters.size() > 3) continue;
    if (!std::ranges::all_of(variant.parameters, [](ir::Type t) { return t == ir::float_type; })) continue;
    Body body(variant);
    const std::vector<float>& values = sums.contains(variant.row) ? ordinary : all;
    const size_t count = variant.parameters.size();
    size_t combinations = 1;
    for (size_t i = 0; i < count; ++i) combinations *= values.size();
    for (size_t n = 0; n < combinations; ++n) {
      const std::vector<float> arguments = combination(values, count, n);
      const float given = body(arguments)[0];
      const float wanted = stored(exact(variant, arguments, 1)[0]);
      EXPECT_TRUE(std::isnan(given)                 ? std::isnan(wanted)
                  : std::isinf(given) || given == 0 ? given == wanted
                                                    : std::abs(given - wanted) <= 1e-5f * std::abs(wanted))
          << variant.name << testing::PrintToString(arguments) << " is " << given << ", not " << wanted;
    }
  }
}

TEST(Reference, MatchesVectorAndMatrixBodiesAtSpecialValues) {
  // Large enough for what is said of 2^31 and of whole turns, and not so large that products of four overflow.
  const std::vector<float> values{0, -0.0f, 1, -1, 2, 0.5f, -2.5f, 3e9f, -3e9f, 0x1p31f, 131073, 1e6f, 1e-6f};
  // How far sums of products of such numbers may be off, where they cancel, and what they then make of it.
  const std::set<std::string_view> unstable = {"refract", "inverse", "rotate2d", "place2d", "normal_matrix",
                                               "transform_normal", "fractal3d", "fractal3d_vector3"};
  std::mt19937 random(2);
  for (const functions::Variant& variant : functions::variants()) {
    if (unstable.contains(variant.row)) continue;
    Body body(variant);
    size_t words = 0;
    for (const ir::Type type : variant.parameters) words += type.width;
    if (variant.name == variant.row && words == variant.parameters.size()) continue;  // of floats: above
    for (int sample = 0; sample < 200; ++sample) {
      std::vector<float> arguments;
      double size = 1;
      for (size_t i = 0; i < words; ++i) {
        arguments.push_back(values[random() % values.size()]);
        size = std::max(size, std::abs(static_cast<double>(arguments.back())));
      }
      const std::vector<float> given = body(arguments);
      const std::vector<Real> wanted = exact(variant, arguments, given.size());
      for (size_t i = 0; i < given.size(); ++i) {
        const float nearest = stored(wanted[i]);
        const bool alike = std::isnan(given[i])   ? std::isnan(nearest)
                           : std::isinf(given[i]) ? given[i] == nearest
                                                  : std::isfinite(nearest);
        EXPECT_TRUE(alike) << variant.name << testing::PrintToString(arguments) << " is " << given[i] << ", not "
                           << nearest;
        if (!std::isfinite(nearest) || !std::isfinite(given[i])) continue;
        const double most = 1e-5 * std::max(std::pow(size, 4.0), std::abs(static_cast<double>(nearest)));
        EXPECT_LE(std::abs(static_cast<double>(given[i]) - nearest), most) << variant.name;
      }
    }
  }
}

TEST(Reference, TreatsFarNoiseCoordinatesAsZeroLikeTheBodies) {
  for (const functions::Variant& variant : functions::variants()) {
    if (!variant.row.starts_with("noise") && !variant.row.starts_with("cellnoise") &&
        !variant.row.starts_with("worleynoise"))
      continue;
    Body body(variant);
    const uint32_t width = variant.parameters[0].width;
    for (const float far : {0x1p31f, -3e9f, 1e30f, huge, inf, -inf, nan}) {
      std::vector<float> at(width, 0.25f), near(width, 0.25f);
      at[0] = far, near[0] = 0;
      if (variant.parameters.size() > 1) at.push_back(0.5f), near.push_back(0.5f);
      const std::vector<float> given = body(at), wanted = body(near);
      const std::vector<Real> reference = exact(variant, at, given.size());
      EXPECT_EQ(given, wanted) << variant.name << far;
      for (size_t i = 0; i < given.size(); ++i)
        EXPECT_NEAR(given[i], stored(reference[i]), 1e-6) << variant.name << far;
    }
  }
}

TEST(Real, FollowsIeee754AtInfinityAndNan) {
  const Real zero = 0, one = 1, nan = zero / zero;
  EXPECT_EQ(stored(one / zero), std::numeric_limits<float>::infinity());
  EXPECT_EQ(stored(one / -zero), -std::numeric_limits<float>::infinity());
  EXPECT_TRUE(nan.is_nan());
  EXPECT_TRUE(sqrt(Real(-1)).is_nan());
  EXPECT_FALSE(nan < one || nan > one || nan == nan || nan <= nan || nan >= nan);
  EXPECT_TRUE(nan != nan);
  EXPECT_EQ(std::bit_cast<uint32_t>(stored(nan)), 0x7fc00000u);
}

TEST(Real, IsStoredAsTheNearestFloatWithoutDenormals) {
  EXPECT_EQ(stored(Real(1) / 3), 0x1.555556p-2f);
  EXPECT_EQ(stored(Real(0x1p-126)), 0x1p-126f);
  EXPECT_EQ(std::bit_cast<uint32_t>(stored(Real(-0x1p-127))), 0x80000000u);
  EXPECT_EQ(stored(Real(0x1p127) * 2), std::numeric_limits<float>::infinity());
  EXPECT_EQ(stored(Real(1) + Real(0x1p-24)), 1.0f);                            // ties to even
  EXPECT_EQ(stored(Real(1) + Real(0x1p-24) + Real(0x1p-100)), 0x1.000002p0f);  // rounded once
}

TEST(Real, NeitherOverflowsNorUnderflows) {
  Real huge = 1e30, tiny = 1e-30;
  for (int i = 0; i < 10; ++i) huge *= huge, tiny *= tiny;
  EXPECT_TRUE(huge.is_finite());
  EXPECT_EQ(abs(huge * tiny - 1) < 1e-12, true);
  EXPECT_EQ((Real(1) / 3).text(40), "0.3333333333333333333333333333333333333333");
  EXPECT_EQ(Real(0.5).text(40), "0.5");
}

}  // namespace
}  // namespace isoshade::reference
