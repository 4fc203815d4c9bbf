// SPDX-License-Identifier: Apache-2.0
// Derivatives on the screen are what neighbouring pixels differ by.
#include <cmath>

#include "tests/equivalence/scene_folder.h"

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

/// A floor that shows this, of `uv`, the texture coordinates, and of "f", a smooth function of them.
class SecondDerivatives : public SceneFolder {
 protected:
  render::Plan showing(const std::string& nodes) {
    folder_.write("shown.json", R"json({"isoshade": 1, "effect": "shown", "nodes": {"uv": {"type": "texcoord"},
"f": {"type": "expression", "code": "vector2(sin(9 * uv.x) * uv.y, exp2(3 * uv.y) / (1 + uv.x * uv.x))", "uv": "uv"},
)json" + nodes + R"json(,
"color": {"type": "combine3", "in1": "shown.x", "in2": "shown.y", "to": "color3"}},
"passes": [{"name": "base", "color": "color"}]})json");
    return plan({width, height}, 1, R"("camera": {"position": [1, 4, 6], "target": [0, 0, 0], "up": [0.2, 1, 0.1],
"fov": 40}, "objects": {"floor": {"mesh": {"type": "plane", "size": [60, 60], "segments": 4}, "effect": "shown.json"}})");
  }
  backends::Image image_of(const std::string& nodes) { return draw(showing(nodes), *cpu_backend()); }
};

TEST_F(SecondDerivatives, AreWhatFirstDerivativesOfNeighbouringPixelsDifferBy) {
  for (const char* what : {"uv", "f"}) {
    for (const char* first : {"ddx", "ddy"}) {
      const std::string slope = R"("slope": {"type": ")" + std::string(first) + R"(", "in": ")" + what + "\"}, ";
      const auto second = [&](const char* then) {
        return image_of(slope + R"("shown": {"type": ")" + then + R"(", "in": "slope"})");
      };
      const backends::Image value = image_of(slope + R"("shown": {"type": "add", "in1": "slope", "in2": 0})"),
                            right = second("ddx"), down = second("ddy");
      double greatest = 0, sum = 0, error = 0;
      for (int y = 1; y < height - 1; ++y) {
        for (int x = 1; x < width - 1; ++x) {
          for (int c = 0; c < 2; ++c) {
            const auto at = [&](const backends::Image& image, int dx, int dy) {
              return double{image.rgba[static_cast<size_t>(((y + dy) * width + x + dx) * 4 + c)]};
            };
            const double dx = (at(value, 1, 0) - at(value, -1, 0)) / 2, dy = (at(value, 0, 1) - at(value, 0, -1)) / 2;
            greatest = std::max({greatest, std::abs(at(right, 0, 0) - dx), std::abs(at(down, 0, 0) - dy)});
            error += std::abs(at(right, 0, 0) - dx) + std::abs(at(down, 0, 0) - dy);
            sum += std::abs(dx) + std::abs(dy);
          }
        }
      }
      // Central differences have the part of the fourth derivative, and the roundings of first derivatives.
      EXPECT_GT(sum, 1e-3) << what;
      EXPECT_LT(error, 0.02 * sum) << what << " " << first << ", worst " << greatest;
    }
  }
}

TEST_F(SecondDerivatives, AreIdenticalOnEveryBackendAndThroughFunctions) {
  folder_.write("slope_of.json", R"({"isoshade": 1, "function": "slope_of", "inputs": {"x": {"type": "float"}},
"nodes": {"n": {"type": "normal"}, "d": {"type": "fwidth", "in": "x"}, "e": {"type": "multiply", "in1": "d", "in2": "n.y"}},
"outputs": {"out": "e"}})");
  const render::Plan plan = showing(R"("a": {"type": "slope_of.json", "x": "f.x"}, "b": {"type": "slope_of.json", "x": "a"},
"w": {"type": "fwidth", "in": "f"}, "s": {"type": "ddy", "in": "w"},
"shown": {"type": "combine2", "in1": "b", "in2": "s.y"})");
  const backends::Image image = draw(plan, *interpreter::create());
  for (const char* lanes : {"1", "4", "8", "8x2"})
    expect_identical(image, draw(plan, *cpu_backend(lanes)), lanes);
#ifdef ISOSHADE_VULKAN
  expect_identical(image, draw(plan, *vulkan_backend()), "vulkan");
#endif
  // The function of the function is that of its formula.
  const backends::Image direct = image_of(R"("da": {"type": "fwidth", "in": "f.x"}, "n": {"type": "normal"},
"a": {"type": "multiply", "in1": "da", "in2": "n.y"}, "db": {"type": "fwidth", "in": "a"},
"b": {"type": "multiply", "in1": "db", "in2": "n.y"}, "w": {"type": "fwidth", "in": "f"}, "s": {"type": "ddy", "in": "w"},
"shown": {"type": "combine2", "in1": "b", "in2": "s.y"})");
  expect_identical(image, direct, "without functions");
}

TEST_F(SecondDerivatives, OfAttributesAndOfInputsOfFunctionsAreIdenticalEverywhere) {
  folder_.write("bend_of.json", R"({"isoshade": 1, "function": "bend_of", "inputs": {"x": {"type": "float"}},
"nodes": {"d": {"type": "ddx", "in": "x"}, "e": {"type": "ddy", "in": "d"}}, "outputs": {"out": "e"}})");
  for (const char* nodes :
       {R"("a": {"type": "ddx", "in": "uv"}, "shown": {"type": "ddx", "in": "a"})",
        R"("a": {"type": "fwidth", "in": "uv"}, "shown": {"type": "fwidth", "in": "a"})",
        R"("p": {"type": "position"}, "a": {"type": "multiply", "in1": "p.x", "in2": "p.x"}, "b": {"type": "ddy", "in": "a"},
"c": {"type": "ddx", "in": "b"}, "shown": {"type": "combine2", "in1": "c", "in2": "b"})",
        R"("n": {"type": "noise2d", "texcoord": "f", "to": "vector2"}, "a": {"type": "ddx", "in": "n"},
"shown": {"type": "ddy", "in": "a"})",
        R"("a": {"type": "bend_of.json", "x": "f.x"}, "b": {"type": "bend_of.json", "x": "uv.y"},
"shown": {"type": "combine2", "in1": "a", "in2": "b"})"}) {
    const render::Plan plan = showing(nodes);
    const backends::Image image = draw(plan, *interpreter::create());
    for (const char* lanes : {"1", "8x2"}) expect_identical(image, draw(plan, *cpu_backend(lanes)), nodes);
#ifdef ISOSHADE_VULKAN
    expect_identical(image, draw(plan, *vulkan_backend()), nodes);
#endif
  }
}

}  // namespace
}  // namespace isoshade::equivalence
