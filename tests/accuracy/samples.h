// SPDX-License-Identifier: Apache-2.0
// Arguments to measure functions at: the same ones on every machine and in every run.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "compiler/functions/body.h"

namespace isoshade::accuracy {

struct Range {
  double low;
  double high;
};

/// Floats as integers in the order of their values, and back.
inline int64_t order(float x) {
  const auto bits = std::bit_cast<int32_t>(x);
  return bits < 0 ? -static_cast<int64_t>(bits & 0x7fffffff) : bits;
}
inline float from_order(int64_t i) {
  return std::bit_cast<float>(i < 0 ? static_cast<uint32_t>(-i) | 0x80000000u : static_cast<uint32_t>(i));
}

/// Where sweeps over all floats, or over hundreds of millions of pairs, found the largest errors.
inline constexpr double worst_cases[] = {
    0x1.058ff8p+0, 0x1.feaf02p-2, 0x1.86ee4ap+5, 0x1.68bee4p+0, 0x1.69fb6ap-1, 0x1.87333p-5,
    0x1.6ea67ep-5, 0x1.f8e18ap-3, 0x1.f03d7ap-1, 0x1.03644ap+0, 0x1.c56bb6p12, 0x1.f09d98p12,
    0x1.0894bep11, 0x1.6ccb2p-2,  0x1.c043p+5,   0x1.9e3924p-2, 0x1.713b4ep-2};

inline bool is_denormal(float x) { return x != 0 && std::abs(x) < 0x1p-126f; }

/// Values in a range: spread over the numbers, spread over the floats, and where functions tend to fail.
class Samples {
 public:
  /// Magnitudes below `smallest` become 0.
  Samples(Range range, float smallest, uint32_t seed) : range_(range), smallest_(smallest), random_(seed) {
    first_ = order(inside(static_cast<float>(range.low)));
    last_ = order(inside(static_cast<float>(range.high)));
    for (int e = -126; e <= 127; ++e) add_critical(std::ldexp(1.0, e));
    for (int i = 1; i <= 100; ++i) add_critical(i), add_critical(i + 0.5), add_critical(1.0 / i);
    for (int i = 1; i <= 6000; i += 1 + i / 8)
      add_critical(i * 1.57079632679489662), add_critical(i * 0.34657359028);
    for (double x : worst_cases) add_critical(x);
    for (double edge : {range.low, range.high}) add_critical(edge);
    critical_.push_back(inside(0.0f));
  }

  float next() {
    switch (random_() % 4) {
      case 0: return tidy(static_cast<float>(range_.low + (range_.high - range_.low) * fraction()));
      case 1: return near(critical_[random_() % critical_.size()]);
      default:
        return tidy(
            from_order(first_ + static_cast<int64_t>(fraction() * static_cast<double>(last_ - first_))));
    }
  }

 private:
  double fraction() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

  float inside(float x) const {
    if (x < range_.low) x = static_cast<float>(range_.low);
    if (x > range_.high) x = static_cast<float>(range_.high);
    if (x < range_.low) return std::nextafter(x, INFINITY);
    return x > range_.high ? std::nextafter(x, -INFINITY) : x;
  }

  float tidy(float x) const {
    x = inside(x);
    return std::abs(x) < smallest_ || is_denormal(x) ? inside(0.0f) : x;
  }

  float near(float x) {
    const auto steps = static_cast<int64_t>(random_() % 9) - 4;
    const int64_t i = order(x) + steps;
    return tidy(from_order(i < first_ ? first_ : i > last_ ? last_ : i));
  }

  void add_critical(double x) {
    for (double v : {x, -x})
      if (v >= range_.low && v <= range_.high) critical_.push_back(static_cast<float>(v));
  }

  Range range_;
  float smallest_;
  std::mt19937_64 random_;
  int64_t first_ = 0;
  int64_t last_ = 0;
  std::vector<float> critical_;
};

/// The next value of any argument type.
template <class T>
struct Sampled;
template <>
struct Sampled<float> {
  static float next(Samples& samples) { return samples.next(); }
};
template <int N>
struct Sampled<lanes::vec<float, N>> {
  static lanes::vec<float, N> next(Samples& s) {
    if constexpr (N == 2) return {s.next(), s.next()};
    if constexpr (N == 3) return {s.next(), s.next(), s.next()};
    if constexpr (N == 4) return {s.next(), s.next(), s.next(), s.next()};
  }
};
template <int N>
struct Sampled<functions::mat<float, N>> {
  static functions::mat<float, N> next(Samples& samples) {
    functions::mat<float, N> m;
    for (auto& column : m.column) column = Sampled<lanes::vec<float, N>>::next(samples);
    return m;
  }
};

}  // namespace isoshade::accuracy
