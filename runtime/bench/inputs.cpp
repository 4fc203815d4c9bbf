// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <random>

#include "runtime/bench/subject.h"

namespace isoshade::bench {

namespace {

/// Ranges of inputs that declare none, or whose declared range is much wider than what scenes use.
struct Range {
  std::string_view effect, input;
  float low, high;
  bool towards_high = false;  ///< more samples there: cosines of small angles
};
constexpr Range ranges[] = {
    {"ggx_d", "alpha", 1e-3f, 1},
    {"ggx_d", "n_dot_h", 0, 1, true},
    {"schlick_f", "v_dot_h", 0, 1, true},
    {"cook_torrance", "roughness", 1e-3f, 1},
    {"toon_highlight", "spec", 0.5f, 1, true},
    {"toon_highlight", "scale", 0, 0.2f},
    {"toon_highlight", "width", 1e-4f, 0.05f},
    {"toon_highlight", "least_scale", 0, 0.01f},
    {"fog", "camera_height", 0, 1000},
    {"fog", "distance", 0, 10000},
    {"fog", "ray_height", -1, 0.1f},
    {"fog", "begin", 0, 10},
    {"fog", "end", 10, 100},
    {"fog", "density", 0, 1},
    {"rsqrt", "x", 1e-6f, 1e6f},
    {"exp2", "x", -20, 20},
    {"exp", "x", -20, 20},
    {"log2", "x", 1e-6f, 1e6f},
    {"log", "x", 1e-6f, 1e6f},
    {"pow", "x", 1e-3f, 1},
    {"pow", "y", 0.1f, 8},
    {"sin", "x", -100, 100},
    {"cos", "x", -100, 100},
};

Range range_of(const std::string& effect, const driver::Field& field) {
  for (const Range& range : ranges)
    if (range.effect == effect && range.input == field.name) return range;
  return {effect, field.name, field.min.value_or(0), field.max.value_or(1)};
}

using Vector = std::array<float, 3>;

float dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector combined(float s, const Vector& a, float t, const Vector& b) {
  return {s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2]};
}
Vector normalized(const Vector& v) { return combined(1 / std::sqrt(dot(v, v)), v, 0, v); }

/// The same random numbers on every machine; std::uniform_real_distribution does not guarantee that.
class Random {
 public:
  float fraction() { return static_cast<float>(engine_() >> 8) * 0x1p-24f; }

  /// Uniform in half of the draws; in the others logarithmic over four decades, or logarithmic in the distance from the
  /// high end over six decades.
  float within(const Range& range) {
    const bool spread = engine_() % 2 == 0 || range.low < 0;
    if (spread) return range.low + (range.high - range.low) * fraction();
    if (range.towards_high) return range.high - (range.high - range.low) * std::pow(10.0f, -6 * fraction());
    const float least = std::max(range.low, range.high * 1e-4f);
    return std::clamp(least * std::pow(range.high / least, fraction()), range.low, range.high);
  }

  Vector direction() {
    for (;;) {
      const Vector v{2 * fraction() - 1, 2 * fraction() - 1, 2 * fraction() - 1};
      if (dot(v, v) >= 0.01f && dot(v, v) <= 1) return normalized(v);
    }
  }

 private:
  std::mt19937 engine_{2026};
};

}  // namespace

Bounds bounds_of(const Subject& subject, const driver::Field& field) {
  const Range range = range_of(subject.effect, field);
  return {range.low, range.high};
}

std::vector<int32_t> inputs_of(const Subject& subject, const driver::Program& program, size_t rows) {
  Random random;
  std::vector<int32_t> words;
  for (size_t row = 0; row < rows; ++row) {
    std::vector<Vector> before;
    for (const driver::Field& field : program.inputs) {
      if (field.type != "vector3") {
        const Range range = range_of(subject.effect, field);
        for (int i = 0; i < field.words; ++i) words.push_back(std::bit_cast<int32_t>(random.within(range)));
        continue;
      }
      Vector v = random.direction();
      if (!before.empty() && dot(v, before[0]) < 0) v = combined(-1, v, 0, v);
      // In half of the rows, near the mirror direction, where highlights are.
      if (before.size() == 2 && row % 2 == 0) {
        const Vector mirrored = combined(2 * dot(before[0], before[1]), before[0], -1, before[1]);
        v = normalized(combined(1, mirrored, std::pow(10.0f, -4 * random.fraction()), v));
      }
      before.push_back(v);
      if (subject.variant != nullptr) v = combined(random.within({"", "", 0.01f, 100}), v, 0, v);
      for (const float component : v) words.push_back(std::bit_cast<int32_t>(component));
    }
  }
  return words;
}

}  // namespace isoshade::bench
