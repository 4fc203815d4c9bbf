// SPDX-License-Identifier: Apache-2.0
// Posts over images that a test makes, without a scene.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <string>
#include <vector>

#include "compiler/driver/driver.h"
#include "compiler/lower/frame_layout.h"
#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {

/// Four floats a pixel, or for a depth one; rows top down.
struct Pixels {
  int width = 0, height = 0;
  std::vector<float> floats;

  const float* at(int x, int y) const {
    return &floats[4 * (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x))];
  }
};

/// A post over a depth, the image that it goes over, and those that it lists.
class Screen {
 public:
  Screen(const support::Source& source, int width, int height, const Pixels& depth,
         const std::vector<Pixels>& images)
      : width_(width), height_(height) {
    support::Diagnostics diagnostics;
    check::Library library(ISOSHADE_GRAPHS "/library");
    driver::CompileOptions options;
    options.library = &library;
    options.skips.set(interface::Skip::rates, false);  // the record has no room for what a draw computes
    auto compiled = driver::compile_post(source, options, diagnostics);
    EXPECT_TRUE(compiled) << diagnostics.text();
    if (compiled) post = *std::move(compiled);
    record_ = post.parameters.defaults();
    frame.resize(lower::frame_word::count);
    view.resize(lower::view_word::camera_words);
    images_.push_back(depth);
    images_.insert(images_.end(), images.begin(), images.end());
  }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  void set(const std::string& parameter, std::initializer_list<float> words) {
    const auto field = post.parameters.find(parameter);
    ASSERT_TRUE(field) << "no parameter " << parameter;
    ASSERT_EQ(words.size(), static_cast<size_t>(post.parameters.fields[*field].words));
    const auto word = static_cast<ptrdiff_t>(post.parameters.word_of(*field));
    std::copy(words.begin(), words.end(), record_.begin() + word);
  }

  std::vector<float> run(backends::Backend& backend) {
    support::Diagnostics diagnostics;
    backends::SlotAllocator slots;
    std::vector<backends::ImageRead> images;
    for (const Pixels& image : images_) {
      const int pixels = std::max(1, image.width * image.height);  // what is not read has none
      const int channels = static_cast<int>(image.floats.size()) / pixels;
      images.push_back({slots.take(image.width, image.height, channels)});
    }
    const backends::Slot made = slots.take(width_, height_, 4);
    EXPECT_TRUE(backend.reserve(slots.length(), diagnostics)) << diagnostics.text();
    for (size_t i = 0; i < images.size(); ++i) backend.write(images[i].slot.first, images_[i].floats);
    const backends::ScreenPass pass{.program = &post.program,
                                    .width = width_,
                                    .height = height_,
                                    .frame = frame,
                                    .view = view,
                                    .record = record_,
                                    .images = images};
    EXPECT_TRUE(backend.post({&pass, 1}, made, diagnostics)) << diagnostics.text();
    const std::span<const float> rgba = backend.read(made);
    return {rgba.begin(), rgba.end()};
  }
  std::vector<float> interpreted() { return run(*interpreter::create()); }

  driver::Post post;
  std::vector<float> frame;  ///< words of lower::frame_word
  std::vector<float> view;   ///< words of lower::view_word

 private:
  int width_, height_;
  std::vector<float> record_;
  std::vector<Pixels> images_;  ///< the depth, then those that are read
};

}  // namespace isoshade::equivalence
