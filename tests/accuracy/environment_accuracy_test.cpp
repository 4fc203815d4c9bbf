// SPDX-License-Identifier: Apache-2.0
// The maps of an environment against integrals of the same image, in double.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <random>

#include "runtime/environment/prefilter.h"

namespace isoshade::environment {
namespace {

using V = std::array<double, 3>;
constexpr double pi = 3.14159265358979323846;

double dot(const V& a, const V& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The direction that a place of an equirectangular image shows; u to the right and v down, both 0 to 1.
V direction_at(double u, double v) {
  const double turn = 2 * pi * (u - 0.5), from_top = pi * v;
  return {std::sin(from_top) * std::sin(turn), std::cos(from_top), -std::sin(from_top) * std::cos(turn)};
}

double at(const scene::TextureLevel& image, int x, int y, int c) {
  x = (x + image.width) % image.width;
  y = std::clamp(y, 0, image.height - 1);
  return static_cast<double>(image.texels[static_cast<size_t>(4 * (y * image.width + x) + c)]);
}

/// Bilinear, as the maps are made.
double bilinear(const scene::TextureLevel& image, double u, double v, int c) {
  const double x = u * image.width - 0.5, y = v * image.height - 0.5;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const double s = x - x0, t = y - y0;
  return (at(image, x0, y0, c) * (1 - s) + at(image, x0 + 1, y0, c) * s) * (1 - t) +
         (at(image, x0, y0 + 1, c) * (1 - s) + at(image, x0 + 1, y0 + 1, c) * s) * t;
}

/// Points all over the sphere, with the radiance and the solid angle of each.
struct Point {
  V direction, radiance;
  double solid_angle;
};
std::vector<Point> points_of(const scene::TextureLevel& image, int width) {
  std::vector<Point> points;
  const int height = width / 2;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = (x + 0.5) / width, v = (y + 0.5) / height;
      V radiance;
      for (int c = 0; c < 3; ++c) radiance[static_cast<size_t>(c)] = bilinear(image, u, v, c);
      points.push_back({direction_at(u, v), radiance, 2 * pi / width * (pi / height) * std::sin(pi * v)});
    }
  return points;
}

/// The mean of the radiance that a surface reflects to a viewer who looks along its normal: weighted by GGX and the cosine.
V radiance_of(const std::vector<Point>& points, const V& normal, double alpha) {
  V sum{};
  double weights = 0;
  const double square = alpha * alpha;
  for (const Point& point : points) {
    const double cosine = dot(normal, point.direction);
    if (cosine <= 0) continue;
    const double half2 = (1 + cosine) / 2;  // the squared cosine of half the angle
    const double width = half2 * (square - 1) + 1;
    const double weight = cosine * square / (width * width) * point.solid_angle;
    for (size_t c = 0; c < 3; ++c) sum[c] += point.radiance[c] * weight;
    weights += weight;
  }
  for (double& value : sum) value /= weights;
  return sum;
}

V irradiance_of(const std::vector<Point>& points, const V& normal) {
  V sum{};
  for (const Point& point : points)
    for (size_t c = 0; c < 3; ++c)
      sum[c] += point.radiance[c] * std::max(0.0, dot(normal, point.direction)) * point.solid_angle / pi;
  return sum;
}

/// A map at a direction, bilinear.
V read(const scene::TextureLevel& map, const V& d) {
  const auto place = functions::octahedral_place(
      lanes::vec<float, 3>(static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])));
  const int side = map.width - 2;
  const double x = static_cast<double>(place.x) * side + 0.5, y = static_cast<double>(place.y) * side + 0.5;
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  V value{};
  for (int i = 0; i < 4; ++i) {
    const int column = x0 + (i & 1), row = y0 + (i >> 1);
    const double weight = ((i & 1) != 0 ? x - x0 : 1 - x + x0) * (i > 1 ? y - y0 : 1 - y + y0);
    for (int c = 0; c < 3; ++c)
      value[static_cast<size_t>(c)] +=
          weight * static_cast<double>(map.texels[static_cast<size_t>(4 * (row * map.width + column) + c)]);
  }
  return value;
}

V read(const Maps& maps, const V& d, double alpha) {
  const double level = static_cast<double>(functions::environment_level(static_cast<float>(alpha)));
  const auto lesser = std::min(static_cast<size_t>(level), static_cast<size_t>(functions::environment_levels - 2));
  const V fine = read(maps[lesser], d), coarse = read(maps[lesser + 1], d);
  V value;
  for (size_t c = 0; c < 3; ++c) value[c] = fine[c] + (coarse[c] - fine[c]) * (level - static_cast<double>(lesser));
  return value;
}

std::vector<V> directions() {
  std::vector<V> all{{0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {0, 0, -1}};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  while (all.size() < 40) {
    V d{any(random), any(random), any(random)};
    const double length = std::sqrt(dot(d, d));
    if (length > 1 || length < 0.1) continue;
    for (double& x : d) x /= length;
    all.push_back(d);
  }
  return all;
}

Maps maps_of(const scene::TextureLevel& image) {
  Pyramid pyramid = project(image, 0, 1, {});
  fill_levels(pyramid);
  return prefilter(pyramid, {});
}

/// A sky above a dark ground with a window of light, and noise.
scene::TextureLevel soft_image() {
  scene::TextureLevel image{512, 256, {}};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const V d = direction_at((x + 0.5) / image.width, (y + 0.5) / image.height);
      const double sky = d[1] > 0 ? 0.4 + 0.6 * (1 - d[1]) : 0.05;
      const double window = d[0] > 0.6 && std::abs(d[1] - 0.3) < 0.2 ? 8 : 0;
      const double stripes = 0.2 * (1 + std::sin(20 * d[2]));
      for (const double value : {sky + window, sky + window + stripes, 2 * sky + window, 1.0})
        image.texels.push_back(static_cast<float>(value));
    }
  return image;
}

/// The same with a sun of 2 degrees whose radiance is 10,000 times that of the sky.
scene::TextureLevel sunny_image() {
  scene::TextureLevel image = soft_image();
  const V sun{0.48, 0.6, 0.64};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (dot(direction_at((x + 0.5) / image.width, (y + 0.5) / image.height), sun) > std::cos(pi / 180))
        for (int c = 0; c < 3; ++c) image.texels[static_cast<size_t>(4 * (y * image.width + x) + c)] = 1e4f;
  return image;
}

struct Errors {
  double largest = 0, square = 0;
  int count = 0;

  void add(const V& computed, const V& exact) {
    // Relative to the brightest channel.
    const double scale = std::max({exact[0], exact[1], exact[2]});
    for (size_t c = 0; c < 3; ++c) {
      const double error = std::abs(computed[c] - exact[c]) / scale;
      largest = std::max(largest, error);
      square += error * error;
      ++count;
    }
  }
  double mean() const { return std::sqrt(square / count); }
};

Errors errors_at(const Maps& maps, const std::vector<Point>& points, double alpha) {
  Errors errors;
  for (const V& d : directions()) errors.add(read(maps, d, alpha), radiance_of(points, d, alpha));
  std::printf("  alpha %.4f: root mean square %.4f, largest %.4f\n", alpha, errors.mean(), errors.largest);
  return errors;
}

TEST(EnvironmentAccuracy, RadianceOfASkyWithAWindowIsNearTheIntegral) {
  const Maps maps = maps_of(soft_image());
  const std::vector<Point> points = points_of(soft_image(), 1024);
  for (int level = 1; level < functions::environment_levels; ++level) {
    const double alpha = static_cast<double>(functions::environment_roughness(static_cast<float>(level)));
    const Errors errors = errors_at(maps, points, alpha);
    EXPECT_LT(errors.mean(), alpha < 0.15 ? 0.03 : 0.004);
    EXPECT_LT(errors.largest, alpha < 0.15 ? 0.2 : 0.02);
  }
  std::printf("  between the levels:\n");
  for (const double alpha : {0.03, 0.09, 0.2, 0.4, 0.6, 0.8}) EXPECT_LT(errors_at(maps, points, alpha).mean(), alpha < 0.15 ? 0.035 : 0.007);
}

TEST(EnvironmentAccuracy, RadianceAroundASunIsNearTheIntegral) {
  const Maps maps = maps_of(sunny_image());
  const std::vector<Point> points = points_of(sunny_image(), 1024);
  for (int level = 2; level < functions::environment_levels; ++level) {
    const double alpha = static_cast<double>(functions::environment_roughness(static_cast<float>(level)));
    EXPECT_LT(errors_at(maps, points, alpha).mean(), alpha < 0.15 ? 0.08 : 0.02);
  }
}

TEST(EnvironmentAccuracy, IrradianceIsNearTheIntegral) {
  for (const auto& [name, image] : {std::pair{"window", soft_image()}, std::pair{"sun", sunny_image()}}) {
    const Maps maps = maps_of(image);
    const std::vector<Point> points = points_of(image, 1024);
    Errors errors;
    for (const V& d : directions()) errors.add(read(maps.back(), d), irradiance_of(points, d));
    std::printf("  irradiance, %s: root mean square %.5f, largest %.5f\n", name, errors.mean(), errors.largest);
    EXPECT_LT(errors.mean(), 0.003);
    EXPECT_LT(errors.largest, 0.01);
  }
}

}  // namespace
}  // namespace isoshade::environment
