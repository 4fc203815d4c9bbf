// SPDX-License-Identifier: Apache-2.0
// Computes what is the same for all pixels of a draw, once for its record.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "compiler/lower/frame_layout.h"
#include "compiler/passes/hoist.h"

namespace isoshade::render {

/// Not thread-safe. Records with the same words share one computation.
class DrawEvaluator {
 public:
  /// Forgets what was computed if the array, which must outlive the calls of fill(), has other contents now.
  void bind(lower::FrameBuffer buffer, std::span<const uint32_t> words);
  void bind(lower::FrameBuffer buffer, std::span<const float> words) {
    bind(buffer, {reinterpret_cast<const uint32_t*>(words.data()), words.size()});
  }
  void bind(lower::FrameBuffer buffer, std::span<const int32_t> words) {
    bind(buffer, {reinterpret_cast<const uint32_t*>(words.data()), words.size()});
  }

  /// Writes the values into the record, which has room for them. Null: there are none.
  void fill(const std::shared_ptr<const passes::DrawValues>& values, std::span<float> record);

 private:
  struct Known;
  struct Bound {
    std::span<const uint32_t> words;
    std::vector<uint32_t> contents;
  };

  std::map<lower::FrameBuffer, Bound> bound_;
  std::map<const passes::DrawValues*, std::shared_ptr<Known>> known_;
};

}  // namespace isoshade::render
