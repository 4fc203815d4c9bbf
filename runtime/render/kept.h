// SPDX-License-Identifier: Apache-2.0
// What the images of the last frame still show in the next one.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/render/layout.h"
#include "runtime/render/plan.h"

namespace isoshade::render {

/// What a frame was drawn from, as far as its images still hold it.
class DrawnFrame {
 public:
  DrawnFrame() = default;
  DrawnFrame(const Plan& plan, const FrameLayout& layout);

  /// By view: whether its target holds what the plan draws there. None, if the images lie elsewhere.
  std::vector<bool> views_of(const Plan& plan, const FrameLayout& layout) const;
  /// Whether the whole frame is the same, where all of its views are.
  bool has_posts_of(const Plan& plan, const FrameLayout& layout) const;

 private:
  struct Step {
    uint64_t program;
    std::vector<float> record;
    std::vector<int> sources;
    int width, height;
    bool operator==(const Step&) const = default;
  };
  struct DrawnView {
    uint64_t revision;
    backends::Slot depth, color;
    bool is_whole;  ///< nothing was written over it later in the frame
  };
  static std::vector<Step> steps_of(const Plan& plan, size_t count);

  backends::Revisions revisions_;
  std::vector<DrawnView> views_;  ///< empty: nothing is known
  std::vector<Step> steps_;
  size_t drawn_steps_ = 0, floats_ = 0;
  int samples_ = 0, result_ = 0;
  bool has_motion_ = false;
};

}  // namespace isoshade::render
