// SPDX-License-Identifier: Apache-2.0
// Pictures side by side on white paper, with captions.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace isoshade::cli {

class Canvas {
 public:
  static constexpr int text_scale = 2;               ///< pixels of the canvas for one of a letter
  static constexpr int text_height = 7 * text_scale;  ///< in pixels
  static int text_width(std::string_view text);

  Canvas(int width, int height);

  /// Copies a picture whose upper left corner lies here; it must fit. 4 bytes per pixel.
  void place(int left, int top, int width, std::span<const uint8_t> rgba);
  /// Writes dark letters, monospaced; ASCII letters, digits and some signs, a box for all others. What lies outside of the
  /// canvas is cut off.
  void write(int left, int top, std::string_view text);

  int width() const { return width_; }
  int height() const { return height_; }
  std::span<const uint8_t> rgba() const { return rgba_; }

 private:
  size_t pixel(int x, int y) const;
  void draw(int left, int top, const uint8_t (&bits)[7]);

  int width_, height_;
  std::vector<uint8_t> rgba_;
};

}  // namespace isoshade::cli
