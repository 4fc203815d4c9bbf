// SPDX-License-Identifier: Apache-2.0
// The tonal art map that is shipped, and what is drawn with it and with computed lines.
#include <algorithm>

#include "runtime/render/image_layers.h"
#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

constexpr int tones = 6;
const std::vector<int> sizes{256, 128, 64, 32};

/// By tone, from light to dark: each mip level that a file holds.
std::vector<std::vector<scene::FileImage>> shipped_strokes() {
  support::Diagnostics diagnostics;
  const auto image = render::LayeredImage::open({ISOSHADE_GRAPHS "/textures/hatching.json", nullptr, {}}, nullptr, diagnostics);
  auto layers = image ? image->decode(true, diagnostics) : std::nullopt;
  EXPECT_TRUE(layers) << diagnostics.text();
  return layers.value_or(std::vector<std::vector<scene::FileImage>>());
}

uint32_t grey(uint32_t word) { return word & 255; }

TEST(TonalArtMap, EachToneHasTheStrokesOfTheLighterOneInEveryPixel) {
  const auto layers = shipped_strokes();
  ASSERT_EQ(layers.size(), size_t{tones});
  for (size_t tone = 0; tone < layers.size(); ++tone) {
    ASSERT_EQ(layers[tone].size(), sizes.size());
    for (size_t level = 0; level < sizes.size(); ++level) {
      const scene::FileImage& image = layers[tone][level];
      ASSERT_EQ(image.width, sizes[level]);
      ASSERT_EQ(image.height, sizes[level]);
      double sum = 0;
      size_t darker = 0;
      for (size_t i = 0; i < image.bytes.size(); ++i) {
        sum += grey(image.bytes[i]);
        if (tone == 0) continue;
        const uint32_t before = grey(layers[tone - 1][level].bytes[i]);
        ASSERT_LE(grey(image.bytes[i]), before) << "tone " << tone << ", level " << level << ", pixel " << i;
        darker += grey(image.bytes[i]) < before;
      }
      EXPECT_TRUE(tone == 0 || darker > image.bytes.size() / 20) << tone;
      // All levels of a tone are as light: a sixth of the way to the darkest for each tone.
      const double light = sum / (255.0 * static_cast<double>(image.bytes.size()));
      EXPECT_NEAR(light, 1 - 0.87 * static_cast<double>(tone + 1) / tones, sizes[level] == 32 ? 0.03 : 0.01)
          << "tone " << tone << ", level " << level;
    }
  }
}

/// What part of the screen ink covers, and how many strokes a column of 100 pixels crosses.
struct Density {
  double ink = 0, strokes = 0;
};

backends::Backend& backend() {
  static const std::unique_ptr<backends::Backend> one = cpu_backend();
  return *one;
}

/// Of a wall of this grey from this distance.
Density density_of(const std::string& effect, double grey, double distance) {
  const std::string light = std::to_string(grey);
  const std::string text = R"({"isoshade": 1, "scene": "wall", "camera": {"position": [0, 0, )" +
                           std::to_string(distance) +
                           R"(], "target": [0, 0, 0], "fov": 53.130102, "near": 0.05},
"objects": {"wall": {"mesh": {"type": "plane", "size": [16, 16]}, "transform": {"rotate": [90, 0, 0]},
"effect": "../effects/)" + effect + R"(", "parameters": {"paper": [1, 1, 1], "ink": [0, 0, 0], "outline": 0,
"color": [1, 1, 1], "tiling": [16, 16], "ambient": [)" + light + ", " + light + ", " + light + "]}}}}";
  const auto source = std::make_shared<support::SourceFile>(ISOSHADE_GRAPHS "/scenes/wall_of_a_test.json", text);
  const backends::Image image = draw(plan(load(source), 256, 256), backend());
  Density density;
  for (int x = 0; x < 256; ++x) {
    bool was_dark = false;
    for (int y = 0; y < 256; ++y) {
      const double paper = image.rgba[static_cast<size_t>(4 * (256 * y + x))];
      density.ink += (1 - paper) / (256.0 * 256.0);
      const bool dark = was_dark ? paper < 0.75 : paper < 0.6;
      density.strokes += dark && !was_dark ? 100 / (256.0 * 256.0) : 0;
      was_dark = dark;
    }
  }
  return density;
}

TEST(Drawings, StrokesAreAsDenseOnTheScreenAtAnyDistance) {
  const Density near = density_of("sketch.json", 0.36, 1);  // tone 0.6
  EXPECT_GT(near.strokes, 5);
  for (const double distance : {1.2, 1.5, 2.0, 2.7, 4.0, 5.5, 8.0}) {
    const Density far = density_of("sketch.json", 0.36, distance);
    EXPECT_NEAR(far.ink, near.ink, 0.1 * near.ink) << distance;
  }
}

TEST(Drawings, ComputedLinesAreAsDenseOnTheScreenAtAnyDistance) {
  const Density near = density_of("cross_hatching.json", 0.36, 1);
  EXPECT_GT(near.ink, 0.1);
  for (const double distance : {1.2, 1.5, 2.0, 2.7, 4.0, 5.5, 8.0}) {
    const Density far = density_of("cross_hatching.json", 0.36, distance);
    EXPECT_NEAR(far.ink, near.ink, 0.1 * near.ink) << distance;
  }
}

}  // namespace
}  // namespace isoshade::equivalence
