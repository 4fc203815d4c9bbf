// SPDX-License-Identifier: Apache-2.0
// What holds of the library's forms everywhere, not only at chosen cases: order, range, continuity, limits. On every
// backend, at inputs that are the same in every run. stress_brdf_test.cpp has those of the BRDF.
#include <array>
#include <cmath>
#include <gtest/gtest.h>

#include "tests/accuracy/property.h"
#include "tests/accuracy/stress_cases.h"

namespace isoshade::accuracy {
namespace {

using reference::Real;

TEST(StressProperty, HighlightStepSwitchesExactlyAtItsThreshold) {
  for (const auto& [literal, text] : {std::pair{0.0001f, "0.0001"}, std::pair{0.1f, "0.1"}}) {
    const Subject step = Subject::expression({"scale"}, std::string("step(") + text + ", scale)");
    const Subject highlight = Subject::document("library/toon/highlight");
    std::vector<float> scales, arguments;
    for (int i = -3; i <= 3; ++i) {
      scales.push_back(from_order(order(literal) + i));
      arguments.insert(arguments.end(), {1, scales.back(), 0.01f, literal});
    }
    const std::vector<float> steps = step(scales), shown = highlight(arguments);
    for (size_t i = 0; i < scales.size(); ++i) {
      EXPECT_EQ(steps[i], scales[i] >= literal ? 1.0f : 0.0f) << scales[i];
      EXPECT_EQ(shown[i] > 0, scales[i] >= literal) << scales[i];
    }
  }
}

TEST(StressProperty, AngleBetweenIsContinuousDownToZero) {
  const Subject angle = Subject::document("library/geometry/angle_between");
  const Subject source = Subject::document("source_forms/angle_between");
  Random random;
  std::vector<float> inputs;
  for (int i = 0; i < 700; ++i) {
    std::array<float, 3> n = random.direction(), other = random.direction();
    if (i < 6 * 7) {  // from each axis towards each other one
      const size_t from = static_cast<size_t>(i / 7) % 3, step = 1 + static_cast<size_t>(i / 7) / 3;
      n = other = {};
      n[from] = other[(from + step) % 3] = 1;
    }
    const double turn = std::pow(10.0, -(i % 7));
    // m is n turned towards another direction.
    double along = 0, length = 0, across[3];
    for (size_t k = 0; k < 3; ++k) along += double{n[k]} * other[k];
    for (size_t k = 0; k < 3; ++k) across[k] = other[k] - along * n[k], length += across[k] * across[k];
    inputs.insert(inputs.end(), n.begin(), n.end());
    for (size_t k = 0; k < 3; ++k)
      inputs.push_back(
          static_cast<float>(std::cos(turn) * n[k] + std::sin(turn) * across[k] / std::sqrt(length)));
  }
  const std::vector<float> results = angle(inputs), sources = source(inputs);
  double worst_of_source = 0;
  for (size_t i = 0; i < results.size(); ++i) {
    const float* const in = &inputs[6 * i];
    Real cross = 0, dot = 0;
    for (size_t k = 0; k < 3; ++k) {
      const size_t a = (k + 1) % 3, b = (k + 2) % 3;
      const Real c = Real(in[a]) * in[3 + b] - Real(in[b]) * in[3 + a];
      cross += c * c;
      dot += Real(in[k]) * in[3 + k];
    }
    const Real exact = atan2(sqrt(cross), dot);
    // At 1 radian 2^-23 is one unit in the last place, which atan2 alone may use up: some random directions need more.
    const double allowed = exact < 0.5 || i < 6 * 7 ? 0x1p-23 : 0x1.2p-23;
    EXPECT_LE(static_cast<double>(abs(exact - results[i])), allowed) << "of " << exact.text(6);
    if (exact < 1e-3)
      worst_of_source = std::max(worst_of_source, static_cast<double>(abs(exact - sources[i]) / exact));
  }
  EXPECT_GT(worst_of_source, 0.1) << "the source's form, which this replaces";
}

TEST(StressProperty, DistancesSurviveTheReversedDepthRoundTrip) {
  const Subject to_depth = Subject::expression({"z", "near"}, "near / z");
  const Subject from_depth = Subject::document("library/depth/from_infinite_reversed");
  std::vector<float> distances, inputs, depths;
  for (int i = 0; i < 100000; ++i) {
    distances.push_back(static_cast<float>(0.1 * std::pow(10000.0, i / 99999.0)));
    inputs.insert(inputs.end(), {distances.back(), 0.1f});
  }
  for (const float depth : to_depth(inputs)) depths.insert(depths.end(), {depth, 0.1f});
  const std::vector<float> back = from_depth(depths);
  for (size_t i = 0; i < back.size(); ++i)
    ASSERT_LE(std::abs(double{back[i]} - distances[i]), 2.5e-7 * distances[i]) << distances[i];
}

TEST(StressProperty, NormalizeReturnsUnitVectorsAtAnyScale) {
  const Subject normalize = Subject::expression({"v:vector3"}, "normalize(v)");
  Random random;
  std::vector<float> inputs;
  std::vector<int> scales;
  for (int i = 0; i < 100000; ++i) {
    scales.push_back(i % 267 - 140);
    for (const float c : random.direction()) inputs.push_back(std::ldexp(c, scales.back()));
  }
  const std::vector<float> results = normalize(inputs);
  std::vector<float> unscaled;
  for (size_t i = 0; i < inputs.size(); ++i) unscaled.push_back(std::ldexp(inputs[i], -scales[i / 3]));
  const std::vector<float> wanted = normalize(unscaled);
  size_t compared = 0;
  for (size_t i = 0; i < results.size(); i += 3) {
    bool whole = true, nothing = true;
    double square = 0;
    for (size_t k = i; k < i + 3; ++k) {
      ASSERT_TRUE(std::isfinite(results[k]));
      square += double{results[k]} * results[k];
      whole &= !is_denormal(inputs[k]);  // denormals are zeros
      nothing &= inputs[k] == 0 || is_denormal(inputs[k]);
    }
    if (nothing) continue;
    ASSERT_LE(std::abs(std::sqrt(square) - 1), 0x1p-22) << "at scale 2^" << scales[i / 3];
    if (!whole) continue;
    ++compared;
    for (size_t k = i; k < i + 3; ++k) ASSERT_LE(std::abs(order(results[k]) - order(wanted[k])), 1);
  }
  EXPECT_GT(compared, 80000u);
}

TEST(StressProperty, LimitingCasesReachTheirLimits) {
  Random random;
  std::vector<float> rough, grazing, metals, colors, fogs;
  for (int i = 0; i < 10000; ++i) {
    const auto x = static_cast<float>(random.between(0, 1)), y = static_cast<float>(random.between(0, 1));
    rough.insert(rough.end(), {1, x});
    grazing.insert(grazing.end(), {x, x, x, 1});
    metals.insert(metals.end(), {0.04f, x, i % 2 == 0 ? 0.0f : 1.0f});
    colors.insert(colors.end(), {x, y, x * 1000, y - 1, -2, 3, 0});
  }
  for (const float d : Subject::document("library/brdf/ggx_d")(rough))
    ASSERT_LE(std::abs(d - 0.31830988618379067), 3 * last_place(0.31));
  const std::vector<float> fresnel = Subject::document("library/brdf/schlick_f")(grazing);
  for (size_t i = 0; i < 10000; ++i) ASSERT_EQ(fresnel[3 * i], grazing[4 * i]);
  const std::vector<float> f0 = Subject::row("mix", 3)(metals);
  for (size_t i = 0; i < f0.size(); ++i) ASSERT_EQ(f0[i], i % 2 == 0 ? 0.04f : metals[3 * i + 1]);
  // A fog of density 0 leaves colours as they are.
  const Subject fog = Subject::document("library/fog/height_density");
  for (size_t i = 0; i < colors.size(); i += 7)
    fogs.insert(fogs.end(), {colors[i], colors[i + 2], colors[i + 3], colors[i + 4], colors[i + 5], 0});
  for (const float density : fog(fogs)) ASSERT_EQ(density, 0);
  // An edge without width is a step, half way only where it is.
  const Subject highlight = Subject::document("library/toon/highlight");
  for (const double spec : {0.5, 0.8999, 0.9001, 1.0}) {
    const std::vector<float> shown = highlight({static_cast<float>(spec), 0.1f, 0, 0});
    EXPECT_EQ(shown[0], spec > 0.9 ? 1.0f : 0.0f);
  }
}

TEST(StressProperty, FogIsContinuousInDepth) {
  const Subject fog = Subject::document("library/fog/height_density");
  Random random;
  for (const float z : {1.0f, 10.0f, 100.0f, 999.0f}) {
    std::vector<float> inputs;
    for (int i = 0; i < 1000; ++i) {
      const auto ray = static_cast<float>(random.between(-1, 1)),
                 camera = static_cast<float>(random.between(-50, 50));
      const auto begin = static_cast<float>(random.between(-60, 60));
      const auto end = static_cast<float>(begin + random.between(0.5, 60));
      for (const float at : {z, after(z)}) inputs.insert(inputs.end(), {camera, at, ray, begin, end, 1});
    }
    const std::vector<float> results = fog(inputs);
    for (size_t i = 0; i < results.size(); i += 2) {
      const float* const in = &inputs[6 * i];
      const double allowed = last_place(z) * std::abs(in[2]) / (double{in[4]} - in[3]) + 0x1p-22;
      ASSERT_LE(std::abs(results[i] - results[i + 1]), allowed * (1 + 1e-6)) << "at distance " << z;
    }
  }
}

TEST(StressProperty, EveryCasePassesWithFlushedDenormals) {
  // Tables are read so: denormals become zeros. What is accepted holds all the same, and no result is one.
  size_t with_denormals = 0;
  for (const Form& form : library_forms()) {
    for (const Outcome& outcome : outcomes(form)) {
      with_denormals += outcome.made->inputs_text.find("p-133") != std::string::npos ? 1 : 0;
      EXPECT_TRUE(outcome.accepted) << outcome.made->id;
      for (const float result : outcome.results) EXPECT_FALSE(is_denormal(result)) << outcome.made->id;
    }
  }
  EXPECT_GE(with_denormals, 4u);
}

TEST(StressProperty, MixIsExactAtBothEndsAndForEqualOperands) {
  const Subject mix = Subject::row("mix", 3);
  Random random;
  std::vector<float> inputs;
  for (int i = 0; i < 1000000; ++i) {
    const auto a = static_cast<float>(random.between(-1, 1) * std::exp2(random.between(-20, 20)));
    const auto b = static_cast<float>(random.between(-1, 1) * std::exp2(random.between(-20, 20)));
    switch (i % 3) {
      case 0: inputs.insert(inputs.end(), {a, b, 0}); break;
      case 1: inputs.insert(inputs.end(), {a, b, 1}); break;
      default: inputs.insert(inputs.end(), {a, a, static_cast<float>(random.between(0, 1))}); break;
    }
  }
  const std::vector<float> results = mix(inputs);
  for (size_t i = 0; i < results.size(); ++i) {
    const float wanted = inputs[3 * i + (i % 3 == 1 ? 1 : 0)];
    if (i % 3 == 2)
      ASSERT_LE(std::abs(order(results[i]) - order(wanted)), 1);
    else
      ASSERT_EQ(results[i], wanted);
  }
}

}  // namespace
}  // namespace isoshade::accuracy
