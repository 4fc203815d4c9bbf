// SPDX-License-Identifier: Apache-2.0
// The shipped function documents against their formulas in double precision.
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>

#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

using Floats = std::vector<float>;
constexpr double pi = std::numbers::pi;

Program load(const std::string& document) {
  FrontEnd front_end(ISOSHADE_GRAPHS "/library");
  return Program(front_end.lower_file(ISOSHADE_GRAPHS "/" + document + ".json"));
}

/// How far `value` is from `reference`, in units in the last place of the reference.
double ulps(float value, double reference) {
  const int exponent = std::max(std::ilogb(reference), -126);
  return std::abs(value - reference) / std::ldexp(1.0, exponent - 23);
}

struct Random {
  std::mt19937 engine{12345};
  float between(float low, float high) {
    return low + (high - low) * static_cast<float>(engine() >> 8) * 0x1p-24f;
  }
  Floats direction() {
    const double z = between(-1, 1), angle = between(0, 6.2831853f), r = std::sqrt(1 - z * z);
    return {static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)),
            static_cast<float>(z)};
  }
};

double dot(const Floats& a, const Floats& b) {
  return double(a[0]) * b[0] + double(a[1]) * b[1] + double(a[2]) * b[2];
}
double length(const Floats& a) { return std::sqrt(dot(a, a)); }

double ggx_d(double r, double n) {
  const double t = (1 - n) * (1 + n) + n * n * r * r;
  return r * r / (pi * t * t);
}
double schlick(double f0, double c) { return f0 + (1 - f0) * std::pow(1 - c, 5); }

TEST(LibraryGraphs, EveryShippedGraphChecksWithoutDiagnostics) {
  int count = 0;
  for (const char* folder : {"library", "source_forms", "materials", "effects"}) {
    for (const auto& file :
         std::filesystem::recursive_directory_iterator(ISOSHADE_GRAPHS "/" + std::string(folder))) {
      if (file.path().extension() != ".json") continue;
      FrontEnd front_end(ISOSHADE_GRAPHS "/library");
      EXPECT_NE(front_end.check_file(file.path().string()), nullptr);
      EXPECT_EQ(front_end.diagnostics.text(), "");
      ++count;
    }
  }
  EXPECT_GE(count, 12);
}

TEST(LibraryGraphs, HullMovesOutwardsAndAwayFromTheViewer) {
  Program hull = load("library/outline/hull_position");
  const auto moved = [&](std::vector<float> normal, int mode) {
    std::vector<float> arguments{1, 2, -10};
    // One surface: its normal, and three times that as those of a corner.
    for (int i = 0; i < 4; ++i) arguments.insert(arguments.end(), normal.begin(), normal.end());
    const std::vector<float> rest{0, 0, 1, /* outline */ 4, /* pixel */ 0.5, std::bit_cast<float>(mode)};
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    return hull(arguments);
  };
  for (const float z : {1.0f, -1.0f}) {
    EXPECT_EQ(moved({0, 0, z}, 0), (std::vector<float>{1, 2, -14}));
    EXPECT_EQ(moved({0, 0, z}, 1), (std::vector<float>{1, 2, -12}));
  }
  const float step = 4 / std::sqrt(2.0f);
  const std::vector<float> aside = moved({1, 0, 0}, 0);
  EXPECT_FLOAT_EQ(aside[0], 1 + step);
  EXPECT_FLOAT_EQ(aside[2], -10 - step);
  Program source = load("source_forms/hull_position");
  EXPECT_EQ(moved({0.5f, 0.25f, 0.8f}, 0), source({1, 2, -10, 0.5f, 0.25f, 0.8f, 4}));
  // Four pixels of half a unit, however much of the normal is seen.
  const std::vector<float> on_screen = moved({0, 0.25f, 0.8f}, 1);
  EXPECT_FLOAT_EQ(on_screen[0], 1);
  EXPECT_FLOAT_EQ(on_screen[1], 4);
  EXPECT_FLOAT_EQ(on_screen[2], -12);
}

TEST(LibraryGraphs, HullKeepsItsWidthOnBothSidesOfACorner) {
  Program hull = load("library/outline/hull_position");
  const auto sideways = [&](std::array<std::vector<float>, 3> corners) {
    std::vector<float> arguments{0, 0, -10, 0, 0, 1};
    for (const std::vector<float>& corner : corners) arguments.insert(arguments.end(), corner.begin(), corner.end());
    arguments.insert(arguments.end(), {0, 0, 1, /* outline */ 4, /* pixel */ 0.5, std::bit_cast<float>(1)});
    std::vector<float> moved = hull(arguments);
    moved.pop_back();
    return moved;
  };
  const std::vector<float> x{1, 0, 0}, y{0, 1, 0}, front{0, 0, 1};
  const float h = std::sqrt(0.5f), t = std::sqrt(1 / 3.0f), s = std::sqrt(1 / 6.0f);
  // A box seen from the front, whichever of its sides comes first.
  for (const auto& corners : {std::array{x, y, front}, std::array{front, x, y}, std::array{y, front, x}})
    EXPECT_EQ(sideways(corners), (std::vector<float>{2, 2}));
  // Turned by 45 degrees about y: still as wide to the right as upwards.
  const std::vector<float> turned = sideways({std::vector{h, 0.0f, h}, std::vector{h, 0.0f, -h}, y});
  EXPECT_FLOAT_EQ(turned[0], 2);
  EXPECT_FLOAT_EQ(turned[1], 2);
  // Seen along a diagonal: a corner of the hexagon, whose sides are 2 off along their normals.
  const std::vector<float> corner =
      sideways({std::vector{h, s, t}, std::vector{-h, s, t}, std::vector{0.0f, 2 * s, -t}});
  EXPECT_NEAR(corner[0], 0, 1e-6f);
  EXPECT_NEAR(corner[1], 4 * t, 1e-5f);
  // A rim, of two surfaces; a spike is at most four times as wide.
  EXPECT_EQ(sideways({x, front, x}), (std::vector<float>{2, 0}));
  const std::vector<float> spike =
      sideways({std::vector{0.0f, 1.0f, 0.0f}, std::vector{0.01f, -0.99995f, 0.0f}, front});
  EXPECT_LE(std::hypot(spike[0], spike[1]), 8.01f);
}

TEST(LibraryGraphs, GgxIsWithin9UlpDownToTheLeastAlpha) {
  Program d = load("library/brdf/ggx_d");
  Random random;
  double worst = 0;
  for (int i = 0; i < 200'000; ++i) {
    const float alpha = std::exp2(random.between(-13.28f, 0));
    const float n = i % 2 ? 1 - std::exp2(random.between(-24, -1)) : random.between(0, 1);
    worst = std::max(worst, ulps(d({alpha, n})[0], ggx_d(alpha, n)));
  }
  EXPECT_LE(worst, 9);
  EXPECT_GE(worst, 1);
  EXPECT_EQ(d({1, 1}), Floats{static_cast<float>(1 / pi)});
}

TEST(LibraryGraphs, SchlickIsWithin4UlpAndExactAtBothEnds) {
  Program f = load("library/brdf/schlick_f");
  Random random;
  double worst = 0;
  for (int i = 0; i < 100'000; ++i) {
    const float f0 = random.between(0, 1), c = random.between(0, 1);
    worst = std::max(worst, ulps(f({f0, 0, 1, c})[0], schlick(f0, c)));
  }
  EXPECT_LE(worst, 4);
  EXPECT_EQ(f({0.04f, 0.5f, 1, 1}), (Floats{0.04f, 0.5f, 1}));
  EXPECT_EQ(f({0.04f, 0.5f, 1, 0}), (Floats{1, 1, 1}));
}

// A scalar product of unit vectors may exceed 1 by rounding.
TEST(LibraryGraphs, CosinesSlightlyAbove1CountAs1) {
  Program d = load("library/brdf/ggx_d"), f = load("library/brdf/schlick_f");
  Program ambient = load("library/brdf/ambient_reflectance"), g = load("library/brdf/cook_torrance_g");
  Program separable = load("library/brdf/smith_g_separable"), correlated = load("library/brdf/smith_g_correlated");
  Program highlight = load("library/toon/highlight"), cook_torrance = load("library/brdf/cook_torrance");
  for (const float excess : {0x1p-23f, 0x1p-22f, 0x1p-21f, 0x1p-20f}) {
    const float c = 1 + excess;
    for (const float alpha : {1e-4f, 1e-3f, 0.25f, 1.0f}) {
      EXPECT_EQ(d({alpha, c}), d({alpha, 1})) << alpha << " " << c;
      for (const float other : {0.0f, 0.5f, 1.0f}) {
        for (Program* masking : {&separable, &correlated}) {
          EXPECT_EQ((*masking)({alpha, c, other}), (*masking)({alpha, 1, other}));
          EXPECT_EQ((*masking)({alpha, other, c}), (*masking)({alpha, other, 1}));
        }
        EXPECT_EQ(ambient({c, alpha, 0, other, 1}), ambient({1, alpha, 0, other, 1}));
      }
      // Vectors as long as make such cosines.
      const float z = 1 + excess / 2;
      const Floats seen = cook_torrance({0, 0, z, 0, 0, z, 0, 0, z, alpha, 0, 0.5f, 1});
      const Floats unit = cook_torrance({0, 0, 1, 0, 0, 1, 0, 0, 1, alpha, 0, 0.5f, 1});
      for (size_t i = 0; i < unit.size(); ++i) EXPECT_NEAR(seen[i], unit[i], 1e-5f * unit[i]) << alpha << " " << i;
    }
    EXPECT_EQ(f({0, 0.04f, 1, c}), f({0, 0.04f, 1, 1}));
    for (int which = 0; which < 16; ++which) {
      const auto cosine = [&](int i) { return (which >> i & 1) != 0 ? c : 1.0f; };
      EXPECT_EQ(g({cosine(0), cosine(1), cosine(2), cosine(3)}), Floats{1}) << which;
    }
    for (const float width : {0.0f, 0.1f})
      EXPECT_EQ(highlight({c, 0.5f, width, 0}), highlight({1, 0.5f, width, 0}));
  }
}

TEST(LibraryGraphs, CookTorranceGIsAccurateAndWithin0And1) {
  Program g = load("library/brdf/cook_torrance_g");
  EXPECT_EQ(g({0, 0, 0, 0}), Floats{0});
  EXPECT_EQ(g({1, 1, 1, 1}), Floats{1});
  EXPECT_EQ(g({1, 1, 1, 0}), Floats{1});
  Random random;
  for (int i = 0; i < 20'000; ++i) {
    const float h = random.between(0, 1), l = random.between(0, 1), v = random.between(0, 1);
    const float vh = random.between(0, 1);
    const double expected = std::min({1.0, 2.0 * h * l / vh, 2.0 * h * v / vh});
    EXPECT_LE(ulps(g({h, l, v, vh})[0], expected), 3);
  }
}

/// D F G / (4 (n.l) (n.v)) in double, from the vectors as they are rounded, made unit.
double cook_torrance(Floats n, Floats l, Floats v, double r, double f0) {
  const double ln = length(n), ll = length(l), lv = length(v);
  double h[3], hh = 0, nh = 0;
  for (int i = 0; i < 3; ++i) {
    h[i] = l[i] / ll + v[i] / lv;
    hh += h[i] * h[i];
    nh += n[i] / ln * h[i];
  }
  const double x[3] = {n[1] * h[2] - n[2] * h[1], n[2] * h[0] - n[0] * h[2], n[0] * h[1] - n[1] * h[0]};
  const double sin2 = (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]) / (ln * ln) / hh;
  const double t = sin2 + r * r * nh * nh / hh;
  const double nl = dot(n, l) / ln / ll, nv = dot(n, v) / ln / lv;
  if (nl <= 0 || nv <= 0) return 0;
  const double vh = std::sqrt(hh) / 2, cos_nh = nh / std::sqrt(hh);
  const double g = std::min({1.0, 2 * cos_nh * nl / vh, 2 * cos_nh * nv / vh});
  return r * r / (pi * t * t) * schlick(f0, vh) * g / (4 * nl * nv);
}

TEST(LibraryGraphs, CookTorranceMatchesItsFormulaAndIsReciprocalAndFinite) {
  Program brdf = load("library/brdf/cook_torrance");
  Random random;
  double sum = 0;
  int above = 0;
  for (int i = 0; i < 50'000; ++i) {
    const Floats n = random.direction(), l = random.direction(), v = random.direction();
    const float r = std::exp2(random.between(-10, 0)), f0 = random.between(0, 1);
    const Floats forward = brdf({n[0], n[1], n[2], l[0], l[1], l[2], v[0], v[1], v[2], r, f0, f0, 1});
    const Floats backward = brdf({n[0], n[1], n[2], v[0], v[1], v[2], l[0], l[1], l[2], r, f0, f0, 1});
    EXPECT_EQ(forward, backward);
    EXPECT_TRUE(std::isfinite(forward[0]));
    const double expected = cook_torrance(n, l, v, r, f0);
    if (expected == 0) {
      EXPECT_EQ(forward[0], 0);
    } else if (dot(n, l) > 1e-3 && dot(n, v) > 1e-3) {
      sum += ulps(forward[0], expected);
      ++above;
    }
  }
  ASSERT_GT(above, 5'000);
  EXPECT_LT(sum / above, 8);
}

TEST(LibraryGraphs, CookTorranceIsFiniteAtGrazingAndOppositeDirections) {
  Program brdf = load("library/brdf/cook_torrance");
  const auto specular = [&](Floats l, Floats v) {
    const Floats out = brdf({0, 0, 1, l[0], l[1], l[2], v[0], v[1], v[2], 1e-3f, 1, 1, 1});
    for (const float value : out) EXPECT_TRUE(std::isfinite(value));
    return out[0];
  };
  EXPECT_EQ(specular({1, 0, 0}, {-1, 0, 0}), 0);
  EXPECT_EQ(specular({0, 0, -1}, {0, 0, 1}), 0);
  EXPECT_EQ(specular({1, 0, 0}, {0, 0, 1}), 0);
  specular({1, 0, 1e-30f}, {-1, 0, 1e-30f});
  specular({1, 0, 1e-20f}, {1, 0, 1e-20f});
  EXPECT_NEAR(specular({0, 0, 1}, {0, 0, 1}) / (1 / (4 * pi * 1e-6)), 1, 1e-5);
}

TEST(LibraryGraphs, SourceFormsAgreeWhereTheyAreStable) {
  Program stable = load("library/brdf/cook_torrance"), source = load("source_forms/cook_torrance");
  Random random;
  int compared = 0;
  for (int i = 0; i < 5'000; ++i) {
    const Floats n = random.direction(), l = random.direction(), v = random.direction();
    if (dot(n, l) < 0.1 || dot(n, v) < 0.1) continue;
    Floats in = {n[0],  n[1], n[2], l[0], l[1], l[2], v[0], v[1], v[2], random.between(0.3f, 1),
                 0.04f, 0.5f, 1};
    const Floats a = stable(in);
    in.insert(in.end(), {0, 0, 0, 1, 1, 1, 1, 1, 1});
    const Floats b = source(in);
    for (int channel = 0; channel < 6; ++channel) EXPECT_NEAR(b[channel] / a[channel], 1, 1e-4);
    for (int channel = 0; channel < 3; ++channel) EXPECT_EQ(b[6 + channel], b[channel]);
    ++compared;
  }
  EXPECT_GT(compared, 500);
}

/// The sky with horizon 1, zenith `zenith` and ground 0 at a height.
double sky_at(Program& sky, double y, float roughness, float zenith) {
  const auto x = static_cast<float>(std::sqrt(1 - y * y));
  return sky({x, static_cast<float>(y), 0, roughness, 1, 1, 1, zenith, 1, 1, 0, 0, 0, 1e-4f})[0];
}

TEST(LibraryGraphs, SkyBlurPreservesTheMean) {
  Program sky = load("library/sky");
  for (const float roughness : {0.0f, 0.1f, 0.3f, 0.6f, 1.0f}) {
    double sum = 0;
    constexpr int steps = 2000;
    for (int i = 0; i < steps; ++i) sum += sky_at(sky, -1 + 2 * (i + 0.5) / steps, roughness, 3);
    EXPECT_NEAR(sum / steps, (1 + 3) / 4.0, 1e-3) << roughness;
  }
}

TEST(LibraryGraphs, SkyIsSharpForMirrorsAndIrradianceForRoughSurfaces) {
  Program sky = load("library/sky");
  EXPECT_NEAR(sky_at(sky, 0.5, 0, 3), 1 + 2 * 0.5, 1e-3);
  EXPECT_NEAR(sky_at(sky, -0.5, 0, 3), 0, 1e-3);
  // Irradiance / pi of what the mirror shows, by quadrature over the hemisphere around each normal.
  for (const double height : {-1.0, -0.6, 0.0, 0.3, 1.0}) {
    double sum = 0;
    constexpr int rings = 60, sectors = 60;
    for (int i = 0; i < rings; ++i) {
      const double cosine = std::sqrt((i + 0.5) / rings), sine = std::sqrt(1 - cosine * cosine);
      for (int j = 0; j < sectors; ++j) {
        const double y =
            cosine * height + sine * std::cos(2 * pi * (j + 0.5) / sectors) * std::sqrt(1 - height * height);
        sum += y > 0 ? 1 + 2 * y * y * (3 - 2 * y) : 0;
      }
    }
    EXPECT_NEAR(sky_at(sky, height, 1, 3), sum / (rings * sectors), 0.02) << height;
  }
}

TEST(LibraryGraphs, AmbientReflectanceStaysWithin0And1) {
  Program reflectance = load("library/brdf/ambient_reflectance");
  for (int i = 0; i <= 20; ++i) {
    for (int j = 0; j <= 20; ++j) {
      const Floats out = reflectance({i / 20.0f, j / 20.0f, 0, 0.04f, 1});
      for (const float share : out) {
        EXPECT_GE(share, 0);
        EXPECT_LE(share, 1);
      }
    }
  }
  EXPECT_NEAR(reflectance({1, 0.5f, 1, 1, 1})[0], 0.699, 0.05);  // white furnace
  EXPECT_NEAR(reflectance({0.2f, 0.25f, 1, 1, 1})[0], 0.932, 0.05);
  EXPECT_NEAR(reflectance({1, 1, 1, 1, 1})[0], 0.375, 0.05);
}

}  // namespace
}  // namespace isoshade
