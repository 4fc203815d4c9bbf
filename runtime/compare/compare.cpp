// SPDX-License-Identifier: Apache-2.0
#include "runtime/compare/compare.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "compiler/support/assert.h"
#include "compiler/support/parse_number.h"
#include "compiler/support/sha256.h"

namespace isoshade::compare {
namespace {

static_assert(std::endian::native == std::endian::little, "the hashes are defined over little-endian words");

void check_whole(const backends::Image& image) {
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  support::assert_that(image.rgba.size() == 4 * pixels && image.depth.size() == pixels, "the pixel count of an image does not match its size");
}

/// Maps floats to integers in the same order: negative floats come first, with their bits inverted.
uint32_t ordered_bits(float x) {
  constexpr uint32_t sign = 0x80000000u;
  const auto bits = std::bit_cast<uint32_t>(x);
  return (bits & sign) != 0 ? ~bits : bits | sign;
}

std::string describe_pixel(std::string_view name, size_t width, const Pixel& pixel) {
  std::string text = "  " + std::string(name) + std::string(width - name.size(), ' ');
  constexpr std::string_view channels[] = {"  r ", "  g ", "  b ", "  a ", "  depth "};
  for (size_t i = 0; i < pixel.size(); ++i) {
    text.append(channels[i]).append(support::format_float(pixel[i]));
    text.append(" (").append(support::format_hex_float(pixel[i])).append(")");
  }
  return text;
}

void add_size(support::Sha256& hash, int width, int height) {
  const uint32_t size[] = {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
  hash.add(size, sizeof size);
}

}  // namespace

Pixel pixel_at(const backends::Image& image, int x, int y) {
  const size_t i = static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x);
  const float* rgba = &image.rgba[4 * i];
  return {rgba[0], rgba[1], rgba[2], rgba[3], image.depth[i]};
}

uint32_t ulp_distance(float a, float b) {
  const uint32_t x = ordered_bits(a);
  const uint32_t y = ordered_bits(b);
  return std::max(x, y) - std::min(x, y);
}

uint32_t ulp_distance(const Pixel& a, const Pixel& b) {
  uint32_t largest = 0;
  for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, ulp_distance(a[i], b[i]));
  return largest;
}

Comparison compare(const backends::Image& a, const backends::Image& b) {
  check_whole(a);
  check_whole(b);
  Comparison comparison;
  comparison.same_size = a.width == b.width && a.height == b.height;
  if (!comparison.same_size) return comparison;
  comparison.pixels = int64_t{a.width} * a.height;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const Pixel in_a = pixel_at(a, x, y);
      const Pixel in_b = pixel_at(b, x, y);
      if (std::memcmp(in_a.data(), in_b.data(), sizeof in_a) == 0) continue;
      ++comparison.differing;
      comparison.largest_ulp = std::max(comparison.largest_ulp, ulp_distance(in_a, in_b));
      if (!comparison.first) comparison.first = {x, y, in_a, in_b};
    }
  }
  return comparison;
}

std::string describe(const Comparison& comparison, std::string_view name_a, std::string_view name_b) {
  if (!comparison.same_size) return "different: the images differ in size";
  std::string text = comparison.identical() ? "identical: " : "different: ";
  text +=
      std::to_string(comparison.differing) + " of " + std::to_string(comparison.pixels) + " pixels differ";
  if (!comparison.first) return text;
  text += ", by at most " + std::to_string(comparison.largest_ulp) +
          " ULP; the first at x = " + std::to_string(comparison.first->x) +
          ", y = " + std::to_string(comparison.first->y) + "\n";
  const size_t width = std::max(name_a.size(), name_b.size());
  return text + describe_pixel(name_a, width, comparison.first->a) + "\n" +
         describe_pixel(name_b, width, comparison.first->b);
}

std::string image_hash(const backends::Image& image) {
  check_whole(image);
  support::Sha256 hash;
  add_size(hash, image.width, image.height);
  hash.add(image.rgba.data(), image.rgba.size() * sizeof(float));
  hash.add(image.depth.data(), image.depth.size() * sizeof(float));
  return hash.hex();
}

std::string encoded_hash(int width, int height, std::span<const uint8_t> rgba) {
  support::Sha256 hash;
  add_size(hash, width, height);
  hash.add(rgba.data(), rgba.size());
  return hash.hex();
}

}  // namespace isoshade::compare
