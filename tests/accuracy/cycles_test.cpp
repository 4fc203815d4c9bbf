// SPDX-License-Identifier: Apache-2.0
// Whole pixels against renders of Blender's Cycles: a unit sphere under an orthographic camera and one sun. They lie in a
// folder that ISOSHADE_DATA names; without it there is nothing to compare with.
#include <algorithm>
#include <cstdlib>

#include "runtime/scene/image_file.h"
#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

constexpr int size = 256, samples = 8;  // a pixel, each way: Cycles averages over pixels

/// The sphere with an effect of tests/accuracy/graphs: red, pixel by pixel.
std::vector<double> sphere(const std::string& effect) {
  const std::string text = R"({"isoshade": 1, "scene": "sphere",
    "camera": {"type": "orthographic", "position": [0, 0, 10], "target": [0, 0, 0], "height": 2},
    "lights": {"sun": {"type": "directional", "direction": [-0.3, -0.5, -0.8], "intensity": 3.14159265}},
    "background": [0, 0, 0, 0],
    "objects": {"sphere": {"mesh": {"type": "sphere", "segments": 512, "rings": 256}, "effect": ")" +
                           effect + R"(.json"}}})";
  const auto source =
      std::make_shared<support::SourceFile>(ISOSHADE_ACCURACY_GRAPHS "/scene_of_a_test.json", text);
  const backends::Image image = draw(plan(load(source), size * samples, size * samples), *cpu_backend());
  std::vector<double> pixels(size * size);
  for (int y = 0; y < size * samples; ++y)
    for (int x = 0; x < size * samples; ++x)
      pixels[static_cast<size_t>(y / samples * size + x / samples)] +=
          image.rgba[4 * static_cast<size_t>(y * size * samples + x)] / (samples * samples);
  return pixels;
}

void expect_as_cycles(const std::string& effect, const std::string& file) {
  const char* folder = std::getenv("ISOSHADE_DATA");
  if (folder == nullptr)
    GTEST_SKIP() << "the renders of Cycles are not here; ISOSHADE_DATA names their folder";
  support::Diagnostics diagnostics;
  const auto cycles = scene::read_image(std::string(folder) + "/" + file, diagnostics);
  ASSERT_TRUE(cycles) << diagnostics.text();
  ASSERT_EQ(cycles->width, size);
  ASSERT_EQ(cycles->height, size);
  const std::vector<double> ours = sphere(effect);
  std::vector<double> errors;
  for (size_t i = 0; i < ours.size(); ++i) errors.push_back(std::abs(ours[i] - double{cycles->rgba[4 * i]}));
  std::sort(errors.begin(), errors.end());
  const auto at = [&](double share) {
    return errors[static_cast<size_t>(share * static_cast<double>(errors.size() - 1))];
  };
  std::printf("    %s: median %.2e, 95 %% below %.2e, 99 %% below %.2e\n", effect.c_str(), at(0.5), at(0.95),
              at(0.99));
  EXPECT_LE(at(0.95), 1e-3);
}

TEST(CyclesComparison, LambertSphereMatches) { expect_as_cycles("white_lambert", "lambert.exr"); }
TEST(CyclesComparison, GgxSphereMatches) { expect_as_cycles("white_ggx", "ggx_white_r0.6.exr"); }

}  // namespace
}  // namespace isoshade::equivalence
