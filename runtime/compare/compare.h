// SPDX-License-Identifier: Apache-2.0
// Whether two images are the same bits; if not, where and how far apart.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "backends/backend.h"

namespace isoshade::compare {

/// R G B A and depth.
using Pixel = std::array<float, 5>;

Pixel pixel_at(const backends::Image& image, int x, int y);

/// The number of floats from one to the other, counted on the line of all floats, -0 and +0 being neighbours
/// and NaNs lying beyond the infinities. 0 only for the same bits.
uint32_t ulp_distance(float a, float b);
/// The largest of a pixel's five distances.
uint32_t ulp_distance(const Pixel& a, const Pixel& b);

struct Comparison {
  struct DifferingPixel {
    int x = 0, y = 0;  ///< from the left and from the top
    Pixel a{}, b{};
  };

  bool same_size = true;  ///< if not, nothing else was compared
  int64_t pixels = 0;
  int64_t differing = 0;
  uint32_t largest_ulp = 0;
  std::optional<DifferingPixel> first;  ///< in the order of the rows

  bool identical() const { return same_size && differing == 0; }
};

/// Compares bit for bit.
Comparison compare(const backends::Image& a, const backends::Image& b);

/// "identical: 0 of 921600 pixels differ", or what is different: counts on one line, then the first pixel's
/// values on two, named as given. No line end at the end.
std::string describe(const Comparison& comparison, std::string_view name_a, std::string_view name_b);

/// SHA-256 over width and height (uint32), R G B A of all pixels (float32), depth of all pixels (float32);
/// little endian, rows top down. 64 hex digits.
std::string image_hash(const backends::Image& image);

/// SHA-256 over width and height (uint32, little endian) and the bytes of all pixels. 64 hex digits.
std::string encoded_hash(int width, int height, std::span<const uint8_t> rgba);

}  // namespace isoshade::compare
