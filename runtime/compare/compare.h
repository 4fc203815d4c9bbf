// SPDX-License-Identifier: Apache-2.0
// Compares two images bit for bit: where they differ, and by how much.
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

/// The number of steps between two floats in the order of all floats, in which -0 and +0 are neighbours and NaNs lie beyond
/// the infinities. 0 only for equal bits.
uint32_t ulp_distance(float a, float b);
/// The largest distance of the five components.
uint32_t ulp_distance(const Pixel& a, const Pixel& b);

struct Comparison {
  struct DifferingPixel {
    int x = 0, y = 0;  ///< from the upper left
    Pixel a{}, b{};
  };

  bool same_size = true;  ///< if false, the pixels were not compared
  int64_t pixels = 0;
  int64_t differing = 0;
  uint32_t largest_ulp = 0;
  std::optional<DifferingPixel> first;  ///< in row order

  bool identical() const { return same_size && differing == 0; }
};

Comparison compare(const backends::Image& a, const backends::Image& b);

/// "identical: 0 of 921600 pixels differ"; or "different: ..." followed by two lines with the values of the first differing
/// pixel in each image. Does not end in a newline.
std::string describe(const Comparison& comparison, std::string_view name_a, std::string_view name_b);

/// SHA-256 over width and height (uint32), R G B A of all pixels (float32), depth of all pixels (float32);
/// little endian, rows top down. 64 hex digits.
std::string image_hash(const backends::Image& image);

/// SHA-256 over width and height (uint32, little endian) and the bytes of all pixels. 64 hex digits.
std::string encoded_hash(int width, int height, std::span<const uint8_t> rgba);

}  // namespace isoshade::compare
