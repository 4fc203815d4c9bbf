// SPDX-License-Identifier: Apache-2.0
// The library's BRDFs against numbers that others computed, and the energy that they return.
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>

#include "tests/accuracy/furnace.h"
#include "tests/accuracy/samples.h"
#include "tests/accuracy/subject.h"

namespace isoshade::accuracy {
namespace {

/// The numbers of a file of data/, row by row, by the names of the columns.
std::vector<std::map<std::string, double>> table(const std::string& name) {
  std::ifstream file(ISOSHADE_ACCURACY_DATA "/" + name + ".csv");
  std::vector<std::string> columns;
  std::vector<std::map<std::string, double>> rows;
  for (std::string line; std::getline(file, line);) {
    std::stringstream cells(line);
    std::vector<std::string> texts;
    for (std::string cell; std::getline(cells, cell, ',');) texts.push_back(cell);
    if (columns.empty()) {
      columns = texts;
      continue;
    }
    auto& row = rows.emplace_back();
    for (size_t i = 0; i < columns.size(); ++i) row[columns[i]] = std::stod(texts[i]);
  }
  EXPECT_FALSE(rows.empty()) << name;
  return rows;
}

void append(std::vector<float>& inputs, const Direction& direction) {
  for (const double c : direction) inputs.push_back(static_cast<float>(c));
}

/// The share of light from everywhere that the specular lobe returns.
double albedo_of_cook_torrance(float roughness, double n_dot_v, float f0) {
  static const Subject brdf = Subject::document("library/brdf/cook_torrance");
  const Direction v = {std::sqrt(1 - n_dot_v * n_dot_v), 0, n_dot_v};
  const std::vector<Sample> samples = mirrored_lights(roughness, n_dot_v, 800);
  std::vector<float> inputs;
  for (const Sample& sample : samples) {
    for (const Direction& direction : {Direction{0, 0, 1}, sample.light, v}) append(inputs, direction);
    inputs.insert(inputs.end(), {roughness, f0, f0, f0});
  }
  const std::vector<float> results = brdf.on_one_backend(inputs);
  double albedo = 0;
  for (size_t i = 0; i < samples.size(); ++i) albedo += results[6 * i] * samples[i].weight;
  return albedo;
}

TEST(Brdf, CookTorranceAlbedoMatchesQuadratureInAWhiteFurnace) {
  for (const auto& row : table("white_furnace")) {
    const double roughness = row.at("roughness");
    const double albedo = albedo_of_cook_torrance(static_cast<float>(roughness), row.at("n_dot_v"), 1);
    EXPECT_NEAR(albedo, row.at("albedo"), roughness < 0.1 ? 5e-4 : 1.5e-4)
        << "roughness " << roughness << ", n.v " << row.at("n_dot_v");
    EXPECT_LE(albedo, 1.0);
  }
}

TEST(Brdf, DielectricsConserveEnergy) {
  // What is not mirrored is scattered by a white base: kd = 1 - F(n.v). With F(v.h) instead, another one for each light,
  // a surface seen at a grazing angle would return up to 1.55 times what it gets.
  const Subject fresnel = Subject::document("library/brdf/schlick_f");
  for (const float roughness : {0.05f, 0.25f, 0.5f, 1.0f}) {
    for (const double n_dot_v : {0.05, 0.2, 0.5, 0.9, 1.0}) {
      const double specular = albedo_of_cook_torrance(roughness, n_dot_v, 0.04f);
      const double kd = 1 - fresnel.on_one_backend({0.04f, 0.04f, 0.04f, static_cast<float>(n_dot_v)})[0];
      EXPECT_LE(specular + kd, 1.001) << "roughness " << roughness << ", n.v " << n_dot_v;
      EXPECT_GE(specular + kd, 0.3);
    }
  }
}

TEST(Brdf, CookTorranceIsNearTheReferenceOverRoughnessAndMetalness) {
  // Also with the light in the horizon, and with roughness as materials clamp it.
  const Subject lit = Subject::document("library/brdf/cook_torrance");
  std::vector<float> inputs;
  for (int roughness = 0; roughness <= 10; ++roughness)
    for (int metallic = 0; metallic <= 10; ++metallic)
      for (const double height : {0.0, 0.01, 0.3, 0.8, 1.0}) {
        const Direction v = {0.6, 0, 0.8}, l = {-std::sqrt(1 - height * height), 0, height};
        for (const Direction& direction : {Direction{0, 0, 1}, l, v}) append(inputs, direction);
        const float f0 = 0.04f + 0.096f * static_cast<float>(metallic);
        inputs.insert(inputs.end(), {std::max(1e-3f, 0.1f * static_cast<float>(roughness)), f0, f0, f0});
      }
  const std::vector<float> results = lit(inputs);
  const std::vector<reference::Real> exact = lit.exact(inputs);
  ASSERT_EQ(results.size(), exact.size());
  for (size_t i = 0; i < results.size(); ++i) {
    ASSERT_TRUE(std::isfinite(results[i]));
    const double wanted = static_cast<double>(exact[i]);
    ASSERT_LE(std::abs(results[i] - wanted), 0x1p-10 * std::max(1.0, wanted));
  }
  // The peak falls from each roughness to the next.
  std::vector<float> peaks;
  for (int roughness = 0; roughness <= 10; ++roughness) {
    for (int i = 0; i < 3; ++i) append(peaks, {0, 0, 1});
    peaks.insert(peaks.end(), {std::max(1e-3f, 0.1f * static_cast<float>(roughness)), 1, 1, 1});
  }
  const std::vector<float> heights = lit(peaks);
  for (size_t i = 6; i < heights.size(); i += 6) EXPECT_LT(heights[i], heights[i - 6]);
}

TEST(Brdf, SmithMaskingMatchesMitsuba) {
  const Subject g = Subject::document("library/brdf/smith_g_separable");
  std::vector<float> inputs;
  const auto rows = table("mitsuba_ggx_g1");
  // G1 of one direction: the other one is along the normal, which masks nothing.
  for (const auto& row : rows) {
    const double theta = M_PI / 3 + row.at("theta_index") * M_PI / 114;
    inputs.insert(inputs.end(), {0.1f, static_cast<float>(std::cos(theta)), 1});
  }
  const std::vector<float> results = g(inputs);
  for (size_t i = 0; i < rows.size(); ++i) EXPECT_NEAR(results[2 * i], rows[i].at("g1"), 4e-6) << i;
}

TEST(Brdf, GgxDistributionMatchesMitsuba) {
  const Subject d = Subject::document("library/brdf/ggx_d");
  std::vector<float> inputs;
  std::vector<double> wanted;
  for (const auto& row : table("mitsuba_ggx_pdf")) {
    // In the plane of an azimuth an anisotropic distribution is an isotropic one of another roughness.
    const double u1 = row.at("u1_sixths") / 6, u2 = row.at("u2_sixths") / 6, x = 0.1, y = 0.3;
    const double phi = std::atan2(y * std::sin(2 * M_PI * u2), x * std::cos(2 * M_PI * u2));
    const double square = 1 / (std::pow(std::cos(phi) / x, 2) + std::pow(std::sin(phi) / y, 2));
    const double cosine = 1 / std::sqrt(1 + square * u1 / (1 - u1));
    inputs.insert(inputs.end(), {static_cast<float>(std::sqrt(square)), static_cast<float>(cosine)});
    wanted.push_back(row.at("pdf") / cosine * x * y / square);
  }
  const std::vector<float> results = d(inputs);
  for (size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(results[i], wanted[i], 2e-5 * wanted[i]) << i;
}

TEST(Brdf, SmithAlbedoMatchesQuadratureInAWhiteFurnace) {
  const Subject forms[] = {Subject::document("library/brdf/smith_g_correlated"),
                           Subject::document("library/brdf/smith_g_separable")};
  const char* const columns[] = {"correlated", "separable"};
  for (const auto& row : table("ggx_albedo")) {
    const double roughness = row.at("alpha"), n_dot_v = row.at("n_dot_v");
    const std::vector<Sample> samples = mirrored_lights(roughness, n_dot_v, 250);
    std::vector<float> inputs;
    for (const Sample& sample : samples)
      inputs.insert(inputs.end(), {static_cast<float>(roughness), static_cast<float>(sample.light[2]),
                                   static_cast<float>(n_dot_v)});
    for (size_t form = 0; form < 2; ++form) {
      const std::vector<float> results = forms[form].on_one_backend(inputs);
      double albedo = 0;
      for (size_t i = 0; i < samples.size(); ++i) {
        const double c = samples[i].half[2];
        const double root = (1 - c * c) + c * c * roughness * roughness;
        const double d = roughness * roughness / (M_PI * root * root);
        albedo += d * results[2 * i + 1] * samples[i].weight;
      }
      EXPECT_NEAR(albedo, row.at(columns[form]), roughness < 0.05 ? 4e-4 : 1e-4)
          << columns[form] << ", alpha " << roughness << ", n.v " << n_dot_v;
    }
  }
}

TEST(Brdf, SplitSumIsNearTheQuadrature) {
  const Subject split = Subject::document("library/brdf/split_sum");
  double worst_total = 0, worst_bias = 0, worst_scale = 0;
  for (const auto& row : table("ggx_split_sum")) {
    const std::vector<float> found =
        split({static_cast<float>(row.at("n_dot_v")), static_cast<float>(row.at("alpha"))});
    const double scale = static_cast<double>(found[0]), bias = static_cast<double>(found[1]);
    worst_total = std::max(worst_total, std::abs(scale + bias - row.at("scale") - row.at("bias")));
    worst_bias = std::max(worst_bias, std::abs(bias - row.at("bias")));
    worst_scale = std::max(worst_scale, std::abs(scale - row.at("scale")));
  }
  std::printf("    scale + bias %.5f, bias %.5f, scale %.5f\n", worst_total, worst_bias, worst_scale);
  EXPECT_LT(worst_total, 0.0084);
  EXPECT_LT(worst_bias, 0.0144);
  EXPECT_LT(worst_scale, 0.021);
}

TEST(Brdf, SmithMaskingIsNearTheReferenceDownToTheHorizon) {
  for (const char* name : {"library/brdf/smith_g_correlated", "library/brdf/smith_g_separable"}) {
    const Subject g = Subject::document(name);
    std::vector<float> inputs;
    Samples alphas({1e-4, 1}, 0, 1), lights({0, 1}, 0x1p-40f, 2), viewers({0, 1}, 0x1p-40f, 3);
    for (int i = 0; i < 20000; ++i)
      inputs.insert(inputs.end(), {alphas.next(), lights.next(), viewers.next()});
    const std::vector<float> results = g(inputs);
    const std::vector<reference::Real> exact = g.exact(inputs);
    double worst = 0;
    for (size_t i = 0; i < results.size(); ++i) {
      ASSERT_TRUE(std::isfinite(results[i]));
      const double wanted = static_cast<double>(exact[i]);
      if (wanted == 0) continue;
      const double unit = std::ldexp(1.0, std::max(std::ilogb(wanted), -126) - 23);
      worst = std::max(worst, static_cast<double>(abs(exact[i] - results[i])) / unit);
    }
    EXPECT_LE(worst, 8) << name << ", in ULP";
    std::printf("    %s: %.3f ULP\n", name, worst);
    EXPECT_EQ(g({0, 0, 0})[0], 0) << "without roughness, in the horizon";
  }
}

}  // namespace
}  // namespace isoshade::accuracy
