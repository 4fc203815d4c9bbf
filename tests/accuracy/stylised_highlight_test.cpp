// SPDX-License-Identifier: Apache-2.0
// The steps of effects/stylised_highlight.json: where the highlight of a ball goes, and what shape it takes.
#include <cmath>

#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

constexpr int size = 240;
constexpr double pixels = 100;  ///< the radius of the ball

/// The pixels of the highlight of a ball that is lit from the camera, from the middle of the ball, x to the right and y up.
struct Highlight {
  std::vector<std::array<double, 2>> points;

  double area() const { return static_cast<double>(points.size()); }
  double mean(size_t axis) const {
    double sum = 0;
    for (const auto& point : points) sum += point[axis];
    return sum / area();
  }
  /// The mean product of the distances from the middle of the highlight along two axes.
  double moment(size_t a, size_t b) const {
    double sum = 0;
    for (const auto& point : points) sum += (point[a] - mean(a)) * (point[b] - mean(b));
    return sum / area();
  }
  double extent(size_t axis) const {
    const auto [least, most] = std::ranges::minmax_element(
        points, {}, [&](const std::array<double, 2>& point) { return point[axis]; });
    return (*most)[axis] - (*least)[axis] + 1;
  }
  bool covers(double x, double y) const {
    return std::ranges::any_of(points, [&](const std::array<double, 2>& point) {
      return std::abs(point[0] - x) <= 0.5 && std::abs(point[1] - y) <= 0.5;
    });
  }
};

Highlight highlight(const std::string& parameters, backends::Backend& backend) {
  const backends::Image image =
      draw(plan(load(std::make_shared<support::SourceFile>(
                    scene_path("lit_ball"),
                    R"({"isoshade": 1, "scene": "lit_ball", "background": [0, 0, 0, 1],
                   "camera": {"type": "orthographic", "position": [0, 0, 4], "target": [0, 0, 0], "height": 2.4},
                   "lights": {"lamp": {"type": "directional", "direction": [0, 0, -1]}},
                   "objects": {"ball": {"mesh": {"type": "icosphere", "subdivisions": 6},
                                        "effect": "../effects/stylised_highlight.json",
                                        "parameters": {"color": [0, 0, 0], "specular": [1, 1, 1], "specular_scale": 0.02,
                                                       "specular2_scale": 0, "outline": 0)" +
                        parameters + "}}}}")),
                size, size),
           backend);
  Highlight found;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      if (image.rgba[4 * static_cast<size_t>(y * size + x)] > 0.5f)
        found.points.push_back({x + 0.5 - size / 2, size / 2 - y - 0.5});
  return found;
}

/// The radius of the unchanged highlight, in pixels: its border is where the cosine is 1 - specular_scale.
double radius() { return pixels * std::sqrt(1 - 0.98 * 0.98); }

TEST(StylisedHighlight, IsADiscOfTheCartoonEffectByDefault) {
  const auto backend = cpu_backend();
  const Highlight round = highlight("", *backend);
  EXPECT_NEAR(round.mean(0), 0, 0.1);
  EXPECT_NEAR(round.mean(1), 0, 0.1);
  EXPECT_NEAR(2 * std::sqrt(round.area() / M_PI), 2 * radius(), 1);
}

TEST(StylisedHighlight, DefaultsShowTheCartoonEffect) {
  const auto backend = cpu_backend();
  scene::Scene scene = load(scene_path("cartoon_tub"));
  const backends::Image cartoon = draw(plan(scene, 320, 240), *backend);
  for (scene::Object& object : scene.objects)
    if (object.effect.ends_with("cartoon.json"))
      object.effect.replace(object.effect.size() - 12, 12, "stylised_highlight.json");
  const backends::Image stylised = draw(plan(scene, 320, 240), *backend);
  // The cosine passes through more operations, and the fwidth of it in another order.
  for (size_t i = 0; i < cartoon.rgba.size(); ++i)
    ASSERT_NEAR(stylised.rgba[i], cartoon.rgba[i], 0.01f) << i / 4;
}

TEST(StylisedHighlight, ShiftMovesItBySineOfTheNormal) {
  const auto backend = cpu_backend();
  const Highlight moved = highlight(R"(, "highlight_shift": [0.4, -0.25])", *backend);
  // The half vector plus the shift points along the normal where its tangential part is minus the shift.
  EXPECT_NEAR(moved.mean(0), 0.4 * pixels, 4);
  EXPECT_NEAR(moved.mean(1), -0.25 * pixels, 4);
}

TEST(StylisedHighlight, StretchLengthensItAndRotationTurnsIt) {
  const auto backend = cpu_backend();
  const Highlight wide = highlight(R"(, "highlight_stretch": [2, 1])", *backend);
  EXPECT_NEAR(wide.extent(0) / wide.extent(1), 2, 0.15);
  EXPECT_NEAR(wide.moment(0, 1), 0, 1);
  const Highlight turned = highlight(R"(, "highlight_stretch": [2, 1], "highlight_rotation": 30)", *backend);
  const double angle = 0.5 * std::atan2(2 * turned.moment(0, 1), turned.moment(0, 0) - turned.moment(1, 1));
  EXPECT_NEAR(angle * 180 / M_PI, 30, 2) << "counter-clockwise";
  EXPECT_NEAR(turned.area(), wide.area(), 0.03 * wide.area());
}

TEST(StylisedHighlight, SplitMovesTwoHalvesApart) {
  const auto backend = cpu_backend();
  const Highlight two = highlight(R"(, "highlight_split": [0.35, 0])", *backend);
  EXPECT_FALSE(two.covers(0.5, 0.5));
  EXPECT_TRUE(two.covers(std::floor(0.35 * pixels) + 0.5, 0.5));
  EXPECT_TRUE(two.covers(-std::floor(0.35 * pixels) - 0.5, 0.5));
  EXPECT_NEAR(two.mean(0), 0, 0.5);
  const Highlight four = highlight(R"(, "highlight_split": [0.3, 0.3])", *backend);
  EXPECT_FALSE(four.covers(0.5, 0.5) || four.covers(30.5, 0.5) || four.covers(0.5, 30.5));
  for (const double x : {-30.5, 30.5})
    for (const double y : {-30.5, 30.5}) EXPECT_TRUE(four.covers(x, y)) << x << " " << y;
}

TEST(StylisedHighlight, SquareFillsTheSquareAroundIt) {
  const auto backend = cpu_backend();
  const auto filled = [&](const std::string& parameters) {
    const Highlight found = highlight(parameters, *backend);
    return found.area() / (found.extent(0) * found.extent(1));
  };
  EXPECT_NEAR(filled(""), M_PI / 4, 0.04);
  EXPECT_GT(filled(R"(, "highlight_square": 0.293)"), 0.85);
}

}  // namespace
}  // namespace isoshade::equivalence
