// SPDX-License-Identifier: Apache-2.0
#include "backends/slots.h"

#include <climits>
#include <iterator>

#include "compiler/lower/frame_layout.h"
#include "compiler/support/assert.h"

namespace isoshade::backends {

std::vector<int32_t> image_records(int width, int height, std::span<const ImageRead> images) {
  namespace word = lower::image_word;
  std::vector<int32_t> records((1 + images.size()) * word::stride);
  const auto place = [](size_t floats) {
    support::assert_that(floats <= INT_MAX, "an image lies beyond what an index reaches");
    return static_cast<int32_t>(floats);
  };
  const auto set = [&](size_t record, size_t first, const Slot& slot, size_t camera) {
    int32_t* const words = &records[record * word::stride];
    words[word::first] = place(first);
    words[word::width] = slot.width;
    words[word::height] = slot.height;
    words[word::camera] = camera == ImageRead::no_camera ? -1 : place(camera);
  };
  set(0, 0, {0, width, height, 0}, ImageRead::no_camera);
  for (size_t i = 0; i < images.size(); ++i) set(1 + i, images[i].slot.first, images[i].slot, images[i].camera);
  return records;
}

size_t SlotAllocator::take(size_t floats) {
  const size_t wanted = rounded(floats);
  for (auto place = free_.begin(); place != free_.end(); ++place) {
    const auto [first, size] = *place;
    if (size < wanted) continue;
    free_.erase(place);
    if (size > wanted) free_[first + wanted] = size - wanted;
    return first;
  }
  // Grow from the last place if it is free.
  size_t first = length_;
  if (!free_.empty() && free_.rbegin()->first + free_.rbegin()->second == length_) {
    first = free_.rbegin()->first;
    free_.erase(std::prev(free_.end()));
  }
  length_ = first + wanted;
  return first;
}

Slot SlotAllocator::take(int width, int height, int channels) {
  Slot slot{0, width, height, channels};
  slot.first = take(slot.size());
  return slot;
}

void SlotAllocator::give_back(const Slot& slot) {
  if (slot.size() == 0) return;
  auto [place, is_new] = free_.emplace(slot.first, rounded(slot.size()));
  support::assert_that(is_new, "a place is given back twice");
  const auto next = std::next(place);
  if (next != free_.end() && place->first + place->second == next->first) {
    place->second += next->second;
    free_.erase(next);
  }
  if (place == free_.begin()) return;
  const auto before = std::prev(place);
  if (before->first + before->second != place->first) return;
  before->second += place->second;
  free_.erase(place);
}

}  // namespace isoshade::backends
