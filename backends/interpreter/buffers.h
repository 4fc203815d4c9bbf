// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <climits>
#include <iterator>
#include <span>

#include "backends/interpreter/steps.h"
#include "backends/shared.h"

namespace isoshade::interpreter {

/// The arrays that a call passes to kernels on the host.
class Buffers {
 public:
  /// `taker`: who reads them, for messages. `frame`: the frame that owns the arrays, or null.
  Buffers(std::string_view taker, const backends::Frame* frame) : taker_(taker), frame_(frame) {
    std::fill(std::begin(views_), std::end(views_), BufferView{&nothing, 1});
  }

  /// Reports an array that is too long to be indexed.
  template <class T>
  bool bind(lower::FrameBuffer buffer, std::span<const T> words, support::Diagnostics& diagnostics) {
    if (words.size() > INT_MAX) {
      const backends::ArrayLimit limit{taker_, size_t{4} * INT_MAX, true};
      backends::report_too_large(buffer, words.size_bytes(), limit, frame_, diagnostics);
      return false;
    }
    BufferView& view = views_[static_cast<size_t>(buffer)];
    view = words.empty() ? BufferView{&nothing, 1} : BufferView{words.data(), static_cast<int>(words.size())};
    return true;
  }
  bool bind(const backends::ViewPass& pass, const backends::Layers& layers, std::span<const float> vertices,
            support::Diagnostics& diagnostics) {
    const auto use = [&]<class T>(lower::FrameBuffer buffer, std::span<const T> words) {
      return bind(buffer, words, diagnostics);
    };
    return backends::for_each_array(pass, layers, vertices, use) && backends::for_each_texture_array(pass.frame, use);
  }
  bool bind(const backends::ScreenPass& pass, const backends::Layers& layers, support::Diagnostics& diagnostics) {
    return backends::for_each_array(pass, layers, [&]<class T>(lower::FrameBuffer buffer, std::span<const T> words) {
      return bind(buffer, words, diagnostics);
    });
  }
  const BufferView* views() const { return views_; }

 private:
  static constexpr int32_t nothing = 0;
  BufferView views_[std::size(lower::frame_buffers)];
  std::string_view taker_;
  const backends::Frame* frame_;
};

}  // namespace isoshade::interpreter
