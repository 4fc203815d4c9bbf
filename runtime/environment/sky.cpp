// SPDX-License-Identifier: Apache-2.0
#include "runtime/environment/sky.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "backends/interpreter/stages.h"
#include "compiler/driver/driver.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/parse_number.h"
#include "runtime/scene/host_math.h"
#include "runtime/threads/workers.h"

namespace isoshade::environment {
namespace {

/// Texels at the edge of the sun are the mean of this many directions squared.
constexpr int edge_directions_each_way = 16;
/// A texel is less wide than this, in radians.
constexpr float texel_width = 0.015f;

std::string text_of(const glm::vec3& v) {
  return "[" + support::format_float(v.x) + ", " + support::format_float(v.y) + ", " + support::format_float(v.z) +
         "]";
}

/// Of the sun, in radians.
float radius_of(const scene::Sun& sun) {
  constexpr float radians_per_degree = 0x1.1df46ap-6f;
  return sun.size * 0.5f * radians_per_degree;
}

glm::vec3 towards(const scene::Sun& sun) { return scene::normalize(-sun.direction); }

/// Radiance times the solid angle, weighted by the cosine, is the irradiance.
glm::vec3 radiance_of(const scene::Sun& sun) {
  const float sine = scene::sin_cos_of_degrees(sun.size * 0.5f).sin;
  constexpr float pi = 0x1.921fb6p1f;
  return sun.color * (sun.intensity / ((pi * sine) * sine));
}

/// Evaluates the program of a sky for directions side by side.
class Sky {
 public:
  explicit Sky(const driver::Program& program) : stages_(program) {}
  /// The radiance that is seen in each direction. The caller holds an FpGuard.
  void see(std::span<const glm::vec3> directions, std::span<glm::vec3> radiances) const {
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
    interpreter::BufferView buffers[std::size(lower::frame_buffers)];
    constexpr int32_t nothing = 0;
    std::fill(std::begin(buffers), std::end(buffers), interpreter::BufferView{&nothing, 1});
    buffers[static_cast<size_t>(lower::FrameBuffer::inputs)] = {directions.data(), static_cast<int>(3 * directions.size())};
    std::vector<int> words(3 * directions.size());
    stages_.eval(buffers, 0, static_cast<int>(directions.size()), words.data());
    std::memcpy(radiances.data(), words.data(), words.size() * sizeof(int));
  }

 private:
  interpreter::Stages stages_;
};

}  // namespace

std::optional<driver::Program> sky_program(const scene::Sky& sky, check::Library& library,
                                           support::Diagnostics& diagnostics) {
  const scene::Sun sun = sky.sun.value_or(scene::Sun{});
  std::string node;
  {
    const lanes::FpGuard guard;
    node = R"({"type": "sky_with_sun", "direction": "direction", "horizon": )" + text_of(sky.horizon) +
           ", \"zenith\": " + text_of(sky.zenith) + ", \"ground\": " + text_of(sky.ground) +
           ", \"haze\": " + support::format_float(sky.haze) + ", \"sun_direction\": " + text_of(towards(sun)) +
           ", \"sun_color\": " + text_of(sky.sun ? radiance_of(sun) : glm::vec3(0)) +
           ", \"sun_radius\": " + support::format_float(sky.sun ? radius_of(sun) : 0.0f) + "}";
  }
  const std::string text = R"({"isoshade": 1, "function": "environment_sky", "inputs": {"direction": {"type": "vector3"}},
 "nodes": {"sky": )" + node + R"(}, "outputs": {"out": "sky"}})";
  driver::CompileOptions options;
  options.library = &library;
  return driver::compile_function(std::make_shared<support::SourceFile>("the sky of the environment", text), options,
                                  diagnostics);
}

Pyramid paint_sky(const scene::Sky& sky, const driver::Program& program, float rotate, float intensity,
                  const PrefilterOptions& options) {
  constexpr int side = functions::environment_side;
  Pyramid pyramid;
  scene::SinCos turn{};
  glm::vec3 sun_direction(0);
  float sun_radius = 0;
  {
    const lanes::FpGuard guard;
    turn = scene::sin_cos_of_degrees(rotate);
    if (sky.sun) sun_direction = towards(*sky.sun);
    if (sky.sun) sun_radius = radius_of(*sky.sun);
  }
  /// The direction at a place, in units of a texel of `size` texels a side, before the sky was turned.
  const auto direction = [&](float x, float y, float size) {
    const auto d = functions::octahedral_direction(lanes::vec<float, 2>(x / size, y / size));
    return scene::normalize(glm::vec3(d.x * turn.cos - d.z * turn.sin, d.y, d.x * turn.sin + d.z * turn.cos));
  };
  const auto is_at_edge = [&](const glm::vec3& d) {
    const glm::vec3 apart = d - sun_direction;
    const float square = scene::dot(apart, apart);
    // The chord is less than the angle, and more than 0.9 of it up to half a right angle.
    const float from = 0.9f * sun_radius - texel_width, to = sun_radius + texel_width;
    return square < to * to && (from <= 0.0f || square > from * from);
  };
  const auto limited = [&](glm::vec3 color) {
    for (int i = 0; i < 3; ++i) {
      color[i] = color[i] * intensity;
      color[i] = color[i] > 0.0f ? color[i] : 0.0f;
      color[i] = color[i] < 1e6f ? color[i] : 1e6f;
    }
    return color;
  };
  const Sky sky_at(program);
  threads::Workers(options.threads).for_each(side, [&](size_t y) {
    const float row = static_cast<float>(y), size = static_cast<float>(side);
    std::vector<glm::vec3> middles(side), colors(side);
    for (size_t x = 0; x < side; ++x) middles[x] = direction(static_cast<float>(x) + 0.5f, row + 0.5f, size);
    sky_at.see(middles, colors);
    float* texel = pyramid.level(0) + channels * ((y + 1) * (side + 2) + 1);
    for (size_t x = 0; x < side; ++x, texel += channels) {
      glm::vec3 color = colors[x];
      if (sky.sun && is_at_edge(middles[x])) {
        constexpr int n = edge_directions_each_way;
        constexpr float step = 1.0f / n;
        std::array<glm::vec3, n * n> parts, seen;
        for (int i = 0; i < n * n; ++i) {
          const float right = (static_cast<float>(i % n) + 0.5f) * step;
          const float down = (static_cast<float>(i / n) + 0.5f) * step;
          parts[static_cast<size_t>(i)] = direction(static_cast<float>(x) + right, row + down, size);
        }
        sky_at.see(parts, seen);
        color = glm::vec3(0);
        for (const glm::vec3& part : seen) color = color + part;
        color = color * (step * step);
      }
      color = limited(color);
      for (int i = 0; i < 3; ++i) texel[i] = color[i];
      texel[3] = 1.0f;
    }
  });
  return pyramid;
}

}  // namespace isoshade::environment
