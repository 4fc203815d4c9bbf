// SPDX-License-Identifier: Apache-2.0
// What holds of the BRDF and its parts everywhere: symmetry, order, range, continuity.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>

#include "tests/accuracy/property.h"
#include "tests/accuracy/stress_cases.h"

namespace isoshade::accuracy {
namespace {

/// The arguments of brdf/cook_torrance.
struct Surface {
  std::array<float, 3> n, l, v;
  float roughness = 0.5f;
  float f0 = 0.04f;
};
void append(std::vector<float>& inputs, const Surface& s) {
  for (const auto& direction : {s.n, s.l, s.v})
    inputs.insert(inputs.end(), direction.begin(), direction.end());
  inputs.insert(inputs.end(), {s.roughness, s.f0, s.f0, s.f0});
}

/// The cases of specular_vec and random surfaces, seen and lit from above.
std::vector<Surface> surfaces(int random_ones) {
  std::vector<Surface> all;
  for (const Case& made : cases()) {
    if (!made.id.starts_with("specular_vec")) continue;
    const auto vector = [&](const char* name) {
      const std::vector<float>& c = made.inputs.at(name);
      return std::array{c[0], c[1], c[2]};
    };
    all.push_back({vector("n"), vector("l"), vector("v"), made.inputs.at("r")[0], made.inputs.at("R")[0]});
  }
  Random random;
  for (int i = 0; i < random_ones; ++i) {
    Surface s{random.direction(), random.direction(), random.direction()};
    for (auto* towards : {&s.l, &s.v}) {
      float cosine = 0;
      for (size_t k = 0; k < 3; ++k) cosine += s.n[k] * (*towards)[k];
      if (cosine < 0)
        for (float& c : *towards) c = -c;
    }
    s.roughness = static_cast<float>(std::exp2(random.between(-10, 0)));
    s.f0 = static_cast<float>(random.between(0, 1));
    all.push_back(s);
  }
  return all;
}

const Subject& cook_torrance() {
  static const Subject subject = Subject::document("library/brdf/cook_torrance");
  return subject;
}
std::vector<float> specular(const std::vector<Surface>& all) {
  std::vector<float> inputs, out;
  for (const Surface& s : all) append(inputs, s);
  const std::vector<float> results = cook_torrance()(inputs);
  for (size_t i = 0; i < all.size(); ++i) out.push_back(results[i * cook_torrance().results()]);
  return out;
}

void expect_same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  size_t differing = 0;
  for (size_t i = 0; i < a.size(); ++i)
    differing += std::bit_cast<uint32_t>(a[i]) != std::bit_cast<uint32_t>(b[i]);
  EXPECT_EQ(differing, 0u) << "of " << a.size();
}

TEST(StressProperty, BrdfIsReciprocalBitForBit) {
  std::vector<Surface> all = surfaces(100000);
  const std::vector<float> straight = specular(all);
  for (Surface& s : all) std::swap(s.l, s.v);
  expect_same_bits(straight, specular(all));
}

TEST(StressProperty, MirroringAndSwappingAxesChangesNoBitOfTheBrdf) {
  const std::vector<Surface> all = surfaces(20000);
  const std::vector<float> straight = specular(all);
  for (int mirrored = 0; mirrored < 8; ++mirrored) {
    for (const bool exchanged : {false, true}) {
      std::vector<Surface> moved = all;
      for (Surface& s : moved) {
        for (auto* vector : {&s.n, &s.l, &s.v}) {
          for (size_t k = 0; k < 3; ++k)
            if (mirrored >> k & 1) (*vector)[k] = -(*vector)[k];
          if (exchanged) std::swap((*vector)[0], (*vector)[1]);
        }
      }
      expect_same_bits(straight, specular(moved));
    }
  }
}

TEST(StressProperty, ScalingLightByAPowerOfTwoScalesTheResultExactly) {
  const Subject lit = Subject::expression({"specular:color3", "diffuse:color3", "light:color3", "cosine"},
                                          "(diffuse + specular) * (light * color3(max(cosine, 0)))");
  Random random;
  std::vector<float> inputs, brighter;
  for (int i = 0; i < 10000; ++i) {
    for (int k = 0; k < 10; ++k) {
      inputs.push_back(static_cast<float>(random.between(0, 2)));
      brighter.push_back(k >= 6 && k < 9 ? inputs.back() * 0x1p13f : inputs.back());
    }
  }
  std::vector<float> scaled = lit(inputs);
  for (float& x : scaled) x *= 0x1p13f;
  expect_same_bits(scaled, lit(brighter));
}

TEST(StressProperty, GgxDistributionIsMonotonicTowardsItsPeak) {
  const Subject d = Subject::document("library/brdf/ggx_d");
  Random random;
  for (const float r : {1e-3f, 0.01f, 0.1f, 0.5f}) {
    std::vector<float> inputs;
    for (int i = 1 << 12; i >= 0; --i) inputs.insert(inputs.end(), {r, from_order(order(1.0f) - i)});
    const std::vector<float> near_peak = d(inputs);
    EXPECT_TRUE(std::is_sorted(near_peak.begin(), near_peak.end())) << "roughness " << r;
    std::vector<float> cosines;
    for (int i = 0; i < 100000; ++i) cosines.push_back(static_cast<float>(random.between(0, 1)));
    std::sort(cosines.begin(), cosines.end());
    inputs.clear();
    for (const float cosine : cosines) inputs.insert(inputs.end(), {r, cosine});
    const std::vector<float> all = d(inputs);
    float highest = 0;
    for (const float value : all) {
      ASSERT_LE(highest - value, 12 * last_place(highest)) << "roughness " << r;
      highest = std::max(highest, value);
    }
  }
}

TEST(StressProperty, GgxDistributionIsContinuousAtItsPeak) {
  const Subject d = Subject::document("library/brdf/ggx_d");
  for (double r = 1e-3; r <= 1; r *= 1.01) {
    const auto roughness = static_cast<float>(r);
    const std::vector<float> results = d.on_one_backend({roughness, 1, roughness, before(1)});
    const double square = double{roughness} * roughness;
    EXPECT_LE(std::abs(double{results[0]} - results[1]), (0x1p-22 / square + 24 * 0x1p-24) * results[0]) << r;
  }
}

TEST(StressProperty, GgxPeakDecreasesWithRoughness) {
  const Subject d = Subject::document("library/brdf/ggx_d");
  std::vector<float> inputs;
  for (int i = 0; i < 4096; ++i)
    inputs.insert(inputs.end(), {static_cast<float>(std::exp2(-13.0 + 13.0 * i / 4095)), 1});
  const std::vector<float> peaks = d(inputs);
  for (size_t i = 0; i < peaks.size(); ++i) {
    ASSERT_LT(peaks[i], i == 0 ? INFINITY : peaks[i - 1]);
    const double r = inputs[2 * i], exact = 1 / (3.14159265358979323846 * r * r);
    ASSERT_LE(std::abs(peaks[i] - exact), 12 * last_place(exact)) << r;
  }
}

TEST(StressProperty, FresnelDecreasesWithCosineAndStaysInRange) {
  const Subject schlick = Subject::document("library/brdf/schlick_f");
  Random random;
  for (const float f0 : {0.0f, 0.04f, 0.5f, 0.95f, 1.0f}) {
    // Pairs, the lesser cosine first: of successive floats below 1, and random ones.
    std::vector<float> inputs;
    const auto add = [&](float cosine) { inputs.insert(inputs.end(), {f0, f0, f0, cosine}); };
    for (int i = 1000000; i > 0; --i) add(from_order(order(1.0f) - i)), add(from_order(order(1.0f) - i + 1));
    for (int i = 0; i < 1000000; ++i) {
      const auto a = static_cast<float>(random.between(0, 1)), b = static_cast<float>(random.between(0, 1));
      add(std::min(a, b)), add(std::max(a, b));
    }
    const std::vector<float> results = schlick.on_one_backend(inputs);
    for (size_t i = 0; i < results.size(); i += 6) {
      ASSERT_LE(results[i + 3] - results[i], last_place(results[i]))
          << "f0 " << f0 << " at " << inputs[i / 3 * 4 + 3];
      for (const size_t k : {i, i + 3}) {
        ASSERT_GE(results[k], f0);
        ASSERT_LE(results[k], 1.0f);
      }
    }
  }
}

}  // namespace
}  // namespace isoshade::accuracy
