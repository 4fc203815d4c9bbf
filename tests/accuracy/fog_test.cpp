// SPDX-License-Identifier: Apache-2.0
// Height fog against double precision, with the camera far above the origin; and the distances that it is made from.
#include <cmath>
#include <cstdio>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "runtime/lanes/float_rules.h"
#include "runtime/scene/placement.h"
#include "tests/equivalence/screen.h"

namespace isoshade::equivalence {
namespace {

constexpr int width = 96, height = 54;
constexpr double fog_begin = 975, fog_end = 1015;
constexpr double fog[3] = {0.5, 0.62, 0.875}, surface[3] = {0.125, 0.75, 0.0625};

/// Depths of points between 1 and 300 units along the view, evenly in the logarithm.
Pixels depths(float near) {
  Pixels depth{width, height, {}};
  std::mt19937 random(1);
  for (int i = 0; i < width * height; ++i) {
    const double part = static_cast<double>(random()) / 4294967296.0;
    depth.floats.push_back(static_cast<float>(near / std::pow(300.0, part)));
  }
  return depth;
}

/// The fogged colour in double, from what the post was given in float.
void expected_color(const scene::Camera& camera, int x, int y, double depth, double (&color)[3]) {
  const glm::dvec3 eye(camera.position);
  const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.target) - eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(camera.up)));
  const glm::dvec3 up = glm::cross(right, forward);
  const double half = std::tan(static_cast<double>(camera.fov) * M_PI / 360);
  const double across = ((x + 0.5) / width * 2 - 1) * half * width / height,
               above = (1 - (y + 0.5) / height * 2) * half;
  const glm::dvec3 point =
      eye + (forward + right * across + up * above) * (static_cast<double>(camera.near) / depth);
  const double density = std::clamp((fog_end - point.y) / (fog_end - fog_begin), 0.0, 1.0);
  for (int c = 0; c < 3; ++c) color[c] = surface[c] * (1 - density) + fog[c] * density;
}

double worst_error(const support::Source& source, const scene::Camera& camera) {
  const Pixels depth = depths(camera.near);
  Pixels image{width, height, {}};
  for (int i = 0; i < width * height; ++i)
    image.floats.insert(image.floats.end(), {static_cast<float>(surface[0]), static_cast<float>(surface[1]),
                                             static_cast<float>(surface[2]), 1.0f});
  Screen screen(source, width, height, depth, {image});
  screen.set("fog_density", {1});
  screen.set("fog_color",
             {static_cast<float>(fog[0]), static_cast<float>(fog[1]), static_cast<float>(fog[2])});
  screen.set("fog_begin", {static_cast<float>(fog_begin)});
  screen.set("fog_end", {static_cast<float>(fog_end)});
  {
    const lanes::FpGuard guard;
    scene::store_camera(camera, width, height, screen.view);
  }
  const std::vector<float> found = screen.interpreted();
  double worst = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + static_cast<size_t>(x);
      double color[3];
      expected_color(camera, x, y, static_cast<double>(depth.floats[i]), color);
      for (size_t c = 0; c < 3; ++c)
        worst = std::max(worst, std::abs(static_cast<double>(found[4 * i + c]) - color[c]));
    }
  }
  return worst;
}

support::Source height_fog() {
  support::Diagnostics diagnostics;
  return graph::read_source(ISOSHADE_GRAPHS "/effects/height_fog.json", diagnostics);
}

/// The same, with the height of the point in world space in between.
support::Source height_fog_in_world_space() {
  std::string text = height_fog()->text();
  const auto replace = [&](const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  replace("\"camera_height\": \"camera.y\"", "\"camera_height\": 0");
  replace("\"worldposition\", \"space\": \"camera\"", "\"worldposition\", \"space\": \"world\"");
  return std::make_shared<support::SourceFile>("fog.json", text);
}

TEST(Fog, HeightFogIsAccurateTo21BitsAtCameraHeight1000) {
  double worst = 0, worst_in_world_space = 0;
  for (const float pitch : {-0.4f, -0.05f, 0.0f, 0.3f}) {
    for (const float fov : {30.0f, 60.0f}) {
      scene::Camera camera;
      camera.position = {300, 1000, -200};
      camera.target = camera.position + glm::vec3(0.6f, pitch, -0.8f);
      camera.fov = fov;
      worst = std::max(worst, worst_error(height_fog(), camera));
      worst_in_world_space = std::max(worst_in_world_space, worst_error(height_fog_in_world_space(), camera));
    }
  }
  std::printf("height fog: absolute error %.2g from the camera, %.2g in world space; 2^-21 is %.2g\n", worst,
              worst_in_world_space, std::ldexp(1.0, -21));
  EXPECT_LE(worst, std::ldexp(1.0, -21));
  EXPECT_GT(worst_in_world_space, 2 * worst);
}

TEST(Fog, HeightFogIsFiniteWhenBeginEqualsEnd) {
  Screen screen(height_fog(), 2, 1, {2, 1, {0.5f, 0.01f}}, {{2, 1, std::vector<float>(8, 0.25f)}});
  screen.set("fog_begin", {1});
  screen.set("fog_end", {1});
  scene::Camera camera;
  camera.position = {0, 2, 0};
  camera.target = {0, 1, -2};
  {
    const lanes::FpGuard guard;
    scene::store_camera(camera, 2, 1, screen.view);
  }
  const std::vector<float> found = screen.interpreted();
  EXPECT_EQ(found[0], 0.25f);     // near the camera, above the fog
  EXPECT_EQ(found[4 + 1], 0.7f);  // far away, below it
  EXPECT_EQ(found[4 + 3], 1.0f);
}

TEST(Fog, LinearDepthIsWithinTwoRoundings) {
  const float near = 0.1f, far = 2000.0f;
  scene::Camera camera;
  camera.near = near;
  Screen screen(std::make_shared<support::SourceFile>(
                    "depth.json", R"({"isoshade": 1, "post": "d", "nodes": {"d": {"type": "scenedepth"}},
                      "outputs": {"color": "d.linear"}})"),
                4, 1, {4, 1, {near / 1, near / 10, near / 100, near / 1000}}, {{1, 1, {0, 0, 0, 0}}});
  {
    const lanes::FpGuard guard;
    scene::store_camera(camera, 4, 1, screen.view);
  }
  const std::vector<float> found = screen.interpreted();
  std::printf("distance   relative error from reversed depth, and from a depth that is 1 at %g\n",
              static_cast<double>(far));
  const double distances[] = {1, 10, 100, 1000};
  for (size_t i = 0; i < 4; ++i) {
    const double error = std::abs(static_cast<double>(found[4 * i]) / distances[i] - 1);
    // What is usual elsewhere: z = a + b / distance in float, and back.
    const float a = far / (far - near), b = -far * near / (far - near);
    const float z = a + b / static_cast<float>(distances[i]);
    const double usual = std::abs(static_cast<double>(b / (z - a)) / distances[i] - 1);
    std::printf("%8g   %.2g   %.2g\n", distances[i], error, usual);
    EXPECT_LE(error, std::ldexp(1.0, -22));
  }
}

}  // namespace
}  // namespace isoshade::equivalence
