// SPDX-License-Identifier: Apache-2.0
// Depth of field, as scenes/depth_of_field.json applies it: how large the image of a point is, and what spreads over what.
#include <cmath>

#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

constexpr double focal_length = 0.085, f_number = 1.4, focus = 2, sensor_height = 0.024;  // metres

/// The diameter of the circle of confusion of a point, in pixels: the formula of a thin lens.
double diameter_of(double distance, int size) {
  const double aperture = focal_length / f_number;
  return aperture * focal_length * std::abs(distance - focus) / (distance * (focus - focal_length)) /
         sensor_height * size;
}

/// The height of the view at a distance of 1, for the angle at which a lens focused at `focus` sees the sensor.
double view_height() { return sensor_height * (focus - focal_length) / (focal_length * focus); }

/// The objects before a background, seen by that lens from the origin along -z; with the posts of the shipped scene but
/// its tone curve.
scene::Scene through_lens(const std::string& objects, const std::string& background, bool posts,
                          int samples = 1) {
  const double fov = 2 * std::atan(view_height() / 2) * 180 / M_PI;
  scene::Scene made = load(std::make_shared<support::SourceFile>(
      scene_path("through_lens"), R"({"isoshade": 1, "scene": "through_lens", "background": )" + background +
                                      R"(, "camera": {"position": [0, 0, 0], "target": [0, 0, -1], "fov": )" +
                                      std::to_string(fov) + R"(}, "objects": {)" + objects + "}}"));
  made.samples = samples;
  if (!posts) return made;
  made.posts = load(scene_path("depth_of_field")).posts;
  made.posts.pop_back();  // the tone curve
  for (scene::Post& post : made.posts) {
    for (scene::Parameter& parameter : post.parameters) {
      const auto set = [&](std::string_view name, double value) {
        if (parameter.name != name) return;
        parameter.value.number = static_cast<float>(value);
        parameter.value.integral = value == std::floor(value);
        parameter.value.integer = static_cast<int64_t>(value);
      };
      set("focus_distance", focus);
      set("f_number", f_number);
      set("focal_length", focal_length * 1000);
      set("unit", 1);
      set("largest", 0.08);
      set("blades", 0);
    }
  }
  return made;
}

backends::Image image_of(const scene::Scene& scene, int size, backends::Backend& backend) {
  return draw(plan(scene, size, size), backend);
}

float red_at(const backends::Image& image, int x, int y) {
  return image.rgba[4 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x))];
}

/// A plane that faces the camera, of one colour, from x = `left` to `right` in shares of half the view's width.
std::string wall(const std::string& name, double distance, double left, double right,
                 const std::string& color) {
  const double half = view_height() / 2 * distance;
  return '"' + name + R"(": {"mesh": {"type": "plane", "size": [)" + std::to_string((right - left) * half) +
         ", " + std::to_string(8 * half) +
         R"(]}, "effect": "../effects/flat.json", "transform": {"rotate": [90, 0, 0], "translate": [)" +
         std::to_string((left + right) / 2 * half) + ", 0, " + std::to_string(-distance) +
         R"(]}, "parameters": {"color": )" + color + "}}";
}

TEST(DepthOfField, ImageOfAPointHasTheDiameterOfTheThinLensFormula) {
  constexpr int size = 400;
  const auto backend = cpu_backend();
  for (const double distance : {1.2, 1.5, 3.0, 4.0, 8.0, 30.0}) {
    // A ball whose own image is 6 pixels wide.
    const double radius = 3 * view_height() * distance / size;
    const std::string ball = R"("ball": {"mesh": {"type": "sphere", "radius": )" + std::to_string(radius) +
                             R"(}, "effect": "../effects/flat.json", "transform": {"translate": [0, 0, )" +
                             std::to_string(-distance) +
                             R"(]}, "parameters": {"color": [1000, 1000, 1000]}})";
    const backends::Image image = image_of(through_lens(ball, "[0, 0, 0, 1]", true), size, *backend);
    // Half as bright as its middle: the edge of a disc that is smoothed evenly.
    double middle = 0, inside = 0;
    for (int y = -4; y < 4; ++y)
      for (int x = -4; x < 4; ++x) middle += red_at(image, size / 2 + x, size / 2 + y) / 64.0;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) inside += red_at(image, x, y) > 0.5 * middle;
    const double diameter = 2 * std::sqrt(inside / M_PI);
    RecordProperty("diameter at " + std::to_string(distance), std::to_string(diameter));
    EXPECT_NEAR(diameter, diameter_of(distance, size), 1.0) << "distance " << distance;
  }
}

/// The largest difference between the pictures with and without depth of field.
double largest_change(const std::string& objects, int samples, backends::Backend& backend) {
  const backends::Image with = image_of(through_lens(objects, "[0, 0, 0, 1]", true, samples), 240, backend);
  const backends::Image without =
      image_of(through_lens(objects, "[0, 0, 0, 1]", false, samples), 240, backend);
  double most = 0;
  for (size_t i = 0; i < with.rgba.size(); ++i)
    most = std::max(most, std::abs(double{with.rgba[i]} - double{without.rgba[i]}));
  return most;
}

TEST(DepthOfField, SharpEdgesBleedLessThanOnePercent) {
  // Of two walls, each of one colour, the farther one behind all of the picture: blurred, it looks as before, so that
  // every change is light that has crossed the edge of the nearer one, which is in focus. The edge lies within a pixel.
  const auto backend = cpu_backend();
  for (const int samples : {1, 16}) {
    for (const double distance : {2.2, 3.0, 100.0}) {
      for (const auto& [name, near, far] : {std::tuple{"bright before dark", "[100, 100, 100]", "[0, 0, 0]"},
                                            {"dark before bright", "[0, 0, 0]", "[100, 100, 100]"}}) {
        const double change =
            largest_change(wall("near", focus, -2, 0.1037, near) + ", " + wall("far", distance, -8, 8, far),
                           samples, *backend);
        RecordProperty(
            name + (" at " + std::to_string(distance)) + ", " + std::to_string(samples) + " samples",
            std::to_string(change));
        EXPECT_LE(change, 1.0) << name << ", distance " << distance << ", " << samples << " samples";
      }
    }
  }
}

TEST(DepthOfField, NearFieldSpreadsOverWhatIsSharp) {
  // Half of the picture, in front of a dark wall in focus: at the edge half of it, and a part as far as the radius.
  const auto backend = cpu_backend();
  constexpr int size = 400;
  const double distance = 1.4, radius = diameter_of(distance, size) / 2;
  const backends::Image image = image_of(
      through_lens(wall("near", distance, -4, 0, "[1, 1, 1]") + ", " + wall("far", focus, -8, 8, "[0, 0, 0]"),
                   "[0, 0, 0, 1]", true),
      size, *backend);
  for (const double part : {-1.2, 0.0, 0.25, 0.5, 0.75, 1.2}) {
    const int x = size / 2 + static_cast<int>(std::lround(part * radius));
    // The share of a disc on the other side of a line.
    const double p = std::clamp((x + 0.5 - size / 2) / radius, -1.0, 1.0);
    const double expected = (std::acos(p) - p * std::sqrt(1 - p * p)) / M_PI;
    RecordProperty("at " + std::to_string(part) + " radii, of " + std::to_string(expected),
                   std::to_string(red_at(image, x, size / 2)));
    EXPECT_NEAR(red_at(image, x, size / 2), expected, 0.06) << part << " radii outside";
  }
}

TEST(DepthOfField, WhatIsInFocusStaysAsItWas) {
  const auto backend = cpu_backend();
  EXPECT_EQ(largest_change(wall("sharp", focus, -1, 0.31, "[1, 1, 1]") + ", " +
                               wall("other", focus * 1.0005, -1, 1, "[0.25, 0.25, 0.25]"),
                           4, *backend),
            0);
}

}  // namespace
}  // namespace isoshade::equivalence
