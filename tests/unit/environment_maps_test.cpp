// SPDX-License-Identifier: Apache-2.0
// The maps of environments: their bits, borders and energy, and the cache that keeps them.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <span>

#include "backends/cache.h"
#include "compiler/functions/environment.h"
#include "runtime/environment/environment.h"
#include "runtime/environment/sky.h"
#include "runtime/lanes/lanes.h"
#include "runtime/scene/image_file.h"
#include "tests/unit/cpu_folders.h"

namespace isoshade::environment {
namespace {

using cpu::TestFolder;
using support::Diagnostics;
using support::Id;

scene::TextureLevel image_of(int width, int height, float (*value)(int x, int y, int channel)) {
  scene::TextureLevel image{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 4; ++c) image.texels.push_back(c == 3 ? 1.0f : value(x, y, c));
  return image;
}

/// Smooth parts, and single bright texels.
scene::TextureLevel varied_image() {
  return image_of(256, 128, [](int x, int y, int c) {
    if (x == 77 && y == 40) return 5000.0f;
    return static_cast<float>((x * (c + 3) + y * 5) % 97) / 97.0f + (y > 64 ? 0.0f : 1.0f);
  });
}

Maps maps_of(const scene::TextureLevel& image, const PrefilterOptions& options, float rotate = 0) {
  Pyramid pyramid = project(image, rotate, 1, options);
  fill_levels(pyramid);
  return prefilter(pyramid, options);
}

bool same_bits(const Maps& a, const Maps& b) {
  return std::ranges::equal(a, b, [](const scene::TextureLevel& x, const scene::TextureLevel& y) {
    return x.texels.size() == y.texels.size() &&
           std::memcmp(x.texels.data(), y.texels.data(), x.texels.size() * sizeof(float)) == 0;
  });
}

bool has_lanes(int lanes) {
  if (lanes == 16) return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw");
  return lanes != 8 || __builtin_cpu_supports("avx2");
}

TEST(EnvironmentMaps, HaveTheSameBitsAtEveryLaneAndThreadCount) {
  const scene::TextureLevel image = varied_image();
  const Maps expected = maps_of(image, {1, 1}, 33);
  for (const int lanes : {4, 8, 16}) {
    if (!has_lanes(lanes)) continue;
    EXPECT_TRUE(same_bits(expected, maps_of(image, {lanes, 1}, 33))) << lanes;
  }
  EXPECT_TRUE(same_bits(expected, maps_of(image, {0, 3}, 33)));
}

TEST(EnvironmentMaps, OfAWhiteImageAreWhite) {
  const Maps maps = maps_of(image_of(64, 32, [](int, int, int) { return 1.0f; }), {});
  ASSERT_EQ(maps.size(), functions::environment_levels + 1u);
  float largest = 0;
  for (const scene::TextureLevel& map : maps)
    for (const float value : map.texels) largest = std::max(largest, std::abs(value - 1));
  EXPECT_LE(largest, 2e-6f);
}

TEST(EnvironmentMaps, AreFiniteAndNotNegativeWhateverTheImageHolds) {
  const Maps maps = maps_of(image_of(16, 8, [](int x, int y, int c) {
    return c == 0 ? -3.0f : c == 1 ? 3e38f : static_cast<float>(x * y) * 1e-39f;
  }), {});
  for (const scene::TextureLevel& map : maps)
    for (const float value : map.texels) ASSERT_TRUE(value >= 0 && value <= 1e6f) << value;
}

TEST(EnvironmentMaps, RepeatWhatIsBeyondAnEdgeInTheBorder) {
  for (const int side : {16, 512}) {
    const float size = static_cast<float>(side);
    // A texel of the border holds the texel in whose square its middle falls when the square is folded further.
    const int width = side + 2;
    std::vector<float> texels(static_cast<size_t>(4 * width * width));
    const lanes::FpGuard guard;
    for (int y = 1; y <= side; ++y)
      for (int x = 1; x <= side; ++x) {
        const auto d = functions::octahedral_direction(lanes::vec<float, 2>(
            (static_cast<float>(x) - 0.5f) / size, (static_cast<float>(y) - 0.5f) / size));
        const float values[] = {d.x, d.y, d.z, 1};
        std::copy_n(values, 4, &texels[static_cast<size_t>(4 * (y * width + x))]);
      }
    fill_border(texels.data(), side);
    // Neighbours across an edge are as near to each other as neighbours inside.
    const auto distance = [&](int x0, int y0, int x1, int y1) {
      float sum = 0;
      for (int c = 0; c < 3; ++c) {
        const float apart = texels[static_cast<size_t>(4 * (y0 * width + x0) + c)] -
                            texels[static_cast<size_t>(4 * (y1 * width + x1) + c)];
        sum += apart * apart;
      }
      return std::sqrt(sum);
    };
    const float step = 4 / size;
    for (int i = 0; i < width; ++i) {
      EXPECT_LT(distance(0, i, 1, i), step) << i;
      EXPECT_LT(distance(width - 2, i, width - 1, i), step) << i;
      EXPECT_LT(distance(i, 0, i, 1), step) << i;
      EXPECT_LT(distance(i, width - 2, i, width - 1), step) << i;
    }
  }
}

TEST(EnvironmentMaps, LevelsAndRoughnessesAreInversesOfEachOther) {
  const lanes::FpGuard guard;
  for (int level = 0; level < functions::environment_levels; ++level)
    EXPECT_NEAR(functions::environment_level(functions::environment_roughness(static_cast<float>(level))), level, 1e-5);
  EXPECT_EQ(functions::environment_level(0.0f), 0);
  EXPECT_EQ(functions::environment_level(1.0f), functions::environment_levels - 1);
  EXPECT_EQ(functions::environment_level(2.0f), functions::environment_levels - 1);
  EXPECT_EQ(functions::environment_level(-1.0f), 0);
}

TEST(EnvironmentMaps, PlacesAndDirectionsAreInversesOfEachOther) {
  const lanes::FpGuard guard;
  for (float u = 0.01f; u < 1; u += 0.07f)
    for (float v = 0.015f; v < 1; v += 0.06f) {
      const auto d = functions::octahedral_direction(lanes::vec<float, 2>(u, v));
      const auto place = functions::octahedral_place(d);
      EXPECT_NEAR(place.x, u, 2e-7);
      EXPECT_NEAR(place.y, v, 2e-7);
    }
  const auto nowhere = functions::octahedral_place(lanes::vec<float, 3>(0, 0, 0));
  EXPECT_TRUE(nowhere.x >= 0 && nowhere.x <= 1 && nowhere.y >= 0 && nowhere.y <= 1);
}

/// The texel of a map in whose square a direction lies.
const float* texel_at(const scene::TextureLevel& map, float x, float y, float z) {
  const int side = map.width - 2;
  const auto place = functions::octahedral_place(lanes::vec<float, 3>(x, y, z));
  const auto at = [&](float p) { return 1 + std::min(static_cast<int>(p * static_cast<float>(side)), side - 1); };
  return &map.texels[static_cast<size_t>(4 * (at(place.y) * map.width + at(place.x)))];
}

TEST(EnvironmentMaps, ShowAnImageTheRightWayRound) {
  // Red to the right of the middle, green above, blue in the middle.
  const scene::TextureLevel image = image_of(64, 32, [](int x, int y, int c) {
    if (c == 0) return x >= 44 && x < 52 ? 1.0f : 0.0f;
    return c == 1 ? (y < 8 ? 1.0f : 0.0f) : (x >= 28 && x < 36 ? 1.0f : 0.0f);
  });
  const Maps maps = maps_of(image, {});
  EXPECT_GT(texel_at(maps[0], 1, 0, 0)[0], 0.9f);
  EXPECT_LT(texel_at(maps[0], -1, 0, 0)[0], 0.1f);
  EXPECT_GT(texel_at(maps[0], 0.1f, 1, 0)[1], 0.9f);
  EXPECT_LT(texel_at(maps[0], 0.1f, -1, 0)[1], 0.1f);
  EXPECT_GT(texel_at(maps[0], 0, 0, -1)[2], 0.9f);
  EXPECT_LT(texel_at(maps[0], 0, 0, 1)[2], 0.1f);
  // Turned counter-clockwise, what was at +x is at -z.
  EXPECT_GT(texel_at(maps_of(image, {}, 90)[0], 0, 0, -1)[0], 0.9f);
}

class EnvironmentCache : public ::testing::Test {
 protected:
  std::optional<Made> make() {
    return make_environment(environment_, {&library_, folder_.path(), {}}, diagnostics_);
  }
  std::string write_image(const std::string& name, const scene::TextureLevel& image) const {
    const std::vector<float> depth(image.texels.size() / 4);
    cpu::write_text(folder_ / name, scene::exr({image.width, image.height, image.texels, depth}));
    return folder_ / name;
  }
  std::vector<std::string> entries() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      if (entry.path().extension() == ".maps") found.push_back(entry.path().string());
    return found;
  }

  TestFolder folder_;
  check::Library library_{ISOSHADE_GRAPHS "/library"};
  scene::Environment environment_;
  Diagnostics diagnostics_;
};

TEST_F(EnvironmentCache, KeepsMapsAndComputesDamagedOnesAgain) {
  environment_.file = write_image("a.exr", varied_image());
  const auto first = make();
  ASSERT_TRUE(first) << diagnostics_.text();
  EXPECT_FALSE(first->cached);
  const auto second = make();
  ASSERT_TRUE(second);
  EXPECT_TRUE(second->cached);
  EXPECT_TRUE(same_bits(first->maps, second->maps));
  ASSERT_EQ(entries().size(), 1u);
  std::string bytes = cpu::read_text(entries()[0]);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  cpu::write_text(entries()[0], bytes);
  const auto third = make();
  ASSERT_TRUE(third);
  EXPECT_FALSE(third->cached);
  EXPECT_TRUE(same_bits(first->maps, third->maps));
  EXPECT_TRUE(make()->cached);
  EXPECT_EQ(backends::Cache::open(folder_.path(), diagnostics_)->contents().entries, 1u);
}

TEST_F(EnvironmentCache, DistinguishesFilesByContentRotationAndIntensity) {
  environment_.file = write_image("a.exr", varied_image());
  ASSERT_TRUE(make());
  environment_.rotate = 10;
  EXPECT_FALSE(make()->cached);
  environment_.intensity = 2;
  EXPECT_FALSE(make()->cached);
  environment_.file = write_image("a.exr", image_of(16, 8, [](int, int, int) { return 0.5f; }));
  EXPECT_FALSE(make()->cached);
  environment_.file = write_image("b.exr", image_of(16, 8, [](int, int, int) { return 0.5f; }));
  EXPECT_TRUE(make()->cached);
}

TEST_F(EnvironmentCache, KeepsTheSharpMapAloneWhereNothingReadsTheOthers) {
  const auto make_sharp = [&] { return make_environment(environment_, {&library_, folder_.path(), {}, true}, diagnostics_); };
  environment_.sky.sun = scene::Sun{};
  environment_.sky.haze = 0.02f;
  for (const bool from_file : {false, true}) {
    if (from_file) environment_.file = write_image("a.exr", varied_image());
    const auto all = make();
    const auto sharp = make_sharp(), again = make_sharp();
    ASSERT_TRUE(all && sharp && again) << diagnostics_.text();
    EXPECT_FALSE(sharp->cached);
    EXPECT_EQ(again->cached, from_file);
    EXPECT_TRUE(same_bits(sharp->maps, again->maps));
    ASSERT_EQ(sharp->maps.size(), all->maps.size());
    EXPECT_TRUE(same_bits({sharp->maps[0]}, {all->maps[0]}));
    for (const scene::TextureLevel& map : std::span(sharp->maps).subspan(1)) {
      EXPECT_EQ(map.width, 1 + 2 * functions::environment_border);
      EXPECT_EQ(map.height, map.width);
      EXPECT_EQ(map.texels, std::vector<float>(static_cast<size_t>(4 * map.width * map.height)));
    }
  }
}

TEST_F(EnvironmentCache, IsNotNeeded) {
  environment_.file = write_image("a.exr", image_of(16, 8, [](int, int, int) { return 0.5f; }));
  const auto made = make_environment(environment_, {&library_, "/dev/null/nowhere", {}}, diagnostics_);
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_FALSE(made->cached);
  EXPECT_TRUE(diagnostics_.all().empty()) << diagnostics_.text();
}

TEST_F(EnvironmentCache, ReportsFilesThatAreNoImages) {
  environment_.file = folder_ / "missing.hdr";
  EXPECT_FALSE(make());
  cpu::write_text(folder_ / "bad.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\nabc");
  environment_.file = folder_ / "bad.hdr";
  EXPECT_FALSE(make());
  cpu::write_text(folder_ / "huge.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8192 +X 8193\n");
  environment_.file = folder_ / "huge.hdr";
  EXPECT_FALSE(make());
  cpu::write_text(folder_ / "large.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8192 +X 8192\nabc");
  environment_.file = folder_ / "large.hdr";
  EXPECT_FALSE(make());
  EXPECT_EQ(diagnostics_.error_count(), 4u) << diagnostics_.text();
}

TEST_F(EnvironmentCache, ASunGivesASurfaceThatFacesItItsIrradiance) {
  scene::Sun sun;
  sun.direction = {0.3f, -0.8f, 0.5f};
  sun.color = {1, 0.5f, 0.25f};
  sun.intensity = 3;
  constexpr double pi = 3.14159265358979;
  for (const float size : {0.53f, 2.0f, 10.0f}) {
    sun.size = size;
    environment_.sky.sun = sun;
    environment_.sky.haze = 0.02f;
    const auto made = make();
    ASSERT_TRUE(made) << diagnostics_.text();
    const float* const facing = texel_at(made->maps.back(), -0.3f, 0.8f, -0.5f);
    // The map has 32 texels a side: the nearest may face away by 0.1 radians, or 0.5 % of the cosine.
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(facing[c] * pi, static_cast<double>(sun.color[c] * sun.intensity), 0.02 * static_cast<double>(sun.color[c] * 3)) << size;
  }
}

}  // namespace
}  // namespace isoshade::environment
