// SPDX-License-Identifier: Apache-2.0
// Where images lie in the array `layers` of a frame, and the records by which programs find them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace isoshade::backends {

/// A place for an image: `channels` floats a pixel (4, or 1 for a depth), rows top down. No channels: no image.
struct Slot {
  size_t first = 0;  ///< its first float
  int width = 0, height = 0;
  int channels = 0;

  size_t row_floats() const { return static_cast<size_t>(width) * static_cast<size_t>(channels); }
  size_t size() const { return row_floats() * static_cast<size_t>(height); }
  bool exists() const { return channels > 0; }
  bool operator==(const Slot&) const = default;
};

/// An image that a program may read.
struct ImageRead {
  static constexpr size_t no_camera = ~size_t{0};
  Slot slot;  ///< without channels if its pixels are not read; its size may still be asked for
  /// The first of the floats that hold the camera of the view that drew it (lower::view_word, without matrices).
  size_t camera = no_camera;
};

/// The records of lower::image_word: of the image that is made, then of those that are read.
std::vector<int32_t> image_records(int width, int height, std::span<const ImageRead> images);

/// Hands out places in an array whose length it finds.
class SlotAllocator {
 public:
  /// The first of `floats` floats that nothing else uses until they are given back.
  size_t take(size_t floats);
  Slot take(int width, int height, int channels);
  void give_back(const Slot& slot);
  /// The length of the array that has held everything so far.
  size_t length() const { return length_; }

 private:
  /// Places begin at multiples of 16 floats: a cache line.
  static size_t rounded(size_t floats) { return (floats + 15) / 16 * 16; }

  std::map<size_t, size_t> free_;  ///< the length of each free place, by its first float
  size_t length_ = 0;
};

}  // namespace isoshade::backends
