// SPDX-License-Identifier: Apache-2.0
// Derivatives on the screen are what neighbouring pixels differ by.
#include <cmath>

#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

constexpr int width = 160, height = 90;

/// A floor that fills the picture, seen by this camera, showing one thing of graphs/materials/derivatives.json.
backends::Image floor_showing(int show, const std::string& camera) {
  const std::string text =
      R"({"isoshade": 1, "scene": "floor", "camera": )" + camera +
      R"(, "objects": {"floor": {"mesh": {"type": "plane", "size": [60, 60], "segments": 4},
    "effect": "../materials/derivatives.json", "parameters": {"show": )" +
      std::to_string(show) + "}}}}";
  const auto source =
      std::make_shared<support::SourceFile>(ISOSHADE_GRAPHS "/scenes/floor_of_a_test.json", text);
  return draw(plan(load(source), width, height), *cpu_backend());
}

/// Compares ddx, ddy and fwidth of the texture coordinates with central differences of them. The error allowed is a
/// share of the greatest derivative around: differences have the third derivative's part, and roundings of a float
/// near 1.
void expect_differences(const std::string& camera, float share) {
  const backends::Image value = floor_showing(0, camera), right = floor_showing(1, camera),
                        down = floor_showing(2, camera), across = floor_showing(3, camera);
  const auto at = [](const backends::Image& image, int x, int y, int c) {
    return image.rgba[static_cast<size_t>((y * width + x) * 4 + c)];
  };
  int compared = 0;
  for (int y = 1; y < height - 1; ++y) {
    for (int x = 1; x < width - 1; ++x) {
      for (int c = 0; c < 2; ++c) {
        const float dx = (at(value, x + 1, y, c) - at(value, x - 1, y, c)) / 2;
        const float dy = (at(value, x, y + 1, c) - at(value, x, y - 1, c)) / 2;
        const float allowed = share * (std::abs(dx) + std::abs(dy)) + 2e-7f;
        ASSERT_NEAR(at(right, x, y, c), dx, allowed) << x << ", " << y;
        ASSERT_NEAR(at(down, x, y, c), dy, allowed) << x << ", " << y;
        ASSERT_EQ(at(across, x, y, c), std::abs(at(right, x, y, c)) + std::abs(at(down, x, y, c)));
        compared += dx != 0 && dy != 0;
      }
    }
  }
  EXPECT_GT(compared, width * height);
}

TEST(PixelDerivatives, TexcoordDerivativesMatchPixelDifferencesInPerspective) {
  expect_differences(
      R"({"type": "perspective", "position": [1, 4, 6], "target": [0, 0, 0], "up": [0.2, 1, 0.1], "fov": 40})",
      2e-3f);
}

TEST(PixelDerivatives, TexcoordDerivativesMatchPixelDifferencesInOrthographic) {
  expect_differences(
      R"({"type": "orthographic", "position": [1, 4, 6], "target": [0, 0, 0], "up": [0.2, 1, 0.1], "height": 6})",
      1e-4f);
}

}  // namespace
}  // namespace isoshade::equivalence
