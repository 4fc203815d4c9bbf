// SPDX-License-Identifier: Apache-2.0
// Posts over images that a test makes, without a scene.
#pragma once

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
         const std::vector<Pixels>& images) {
    support::Diagnostics diagnostics;
    check::Library library(ISOSHADE_GRAPHS "/library");
    driver::CompileOptions options;
    options.library = &library;
    auto compiled = driver::compile_post(source, options, diagnostics);
    EXPECT_TRUE(compiled) << diagnostics.text();
    if (compiled) post = *std::move(compiled);
    record_ = post.parameters.defaults();
    frame.resize(lower::frame_word::count);
    view.resize(lower::view_word::camera_words);
    add({width, height, {}});
    add(depth);
    for (const Pixels& image : images) add(image);
    pass_ = {&post.program, width, height, 0, frame, view, record_, images_, records_};
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
    std::vector<float> rgba;
    EXPECT_TRUE(backend.post(pass_, rgba, diagnostics)) << diagnostics.text();
    return rgba;
  }
  std::vector<float> interpreted() { return run(*interpreter::create()); }

  driver::Post post;
  std::vector<float> frame;  ///< words of lower::frame_word
  std::vector<float> view;   ///< words of lower::view_word

 private:
  void add(const Pixels& pixels) {
    records_.insert(records_.end(), {static_cast<int32_t>(images_.size()), pixels.width, pixels.height, -1});
    images_.insert(images_.end(), pixels.floats.begin(), pixels.floats.end());
  }
  std::vector<float> record_, images_;
  std::vector<int32_t> records_;
  backends::ScreenPass pass_;
};

}  // namespace isoshade::equivalence
