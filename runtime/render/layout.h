// SPDX-License-Identifier: Apache-2.0
// Where each image of a frame lies while it is needed, and which posts run in one go.
#pragma once

#include <vector>

#include "backends/slots.h"
#include "runtime/render/plan.h"

namespace isoshade::render {

/// Steps of the chain that run in one go: all but the first look at no pixel but their own, and nothing else reads what is
/// between them. They share one image.
struct StepGroup {
  size_t first = 0, count = 0;
};

struct FrameLayout {
  struct ViewImages {
    size_t camera = 0;  ///< the first of its words
    backends::Slot depth, color;
  };
  std::vector<ViewImages> views;  ///< with one pixel for all samples of one
  ViewImages drawn_motion;        ///< of the motion before it is complete
  backends::Slot motion;
  size_t drawn_steps = 0;         ///< steps of the chain that run over each sample or pixel as it is drawn
  std::vector<StepGroup> groups;  ///< of the other steps
  std::vector<backends::Slot> images;  ///< of the chain: the picture's, then that of each step
  size_t most_images = 1;              ///< of the chain that are kept at a time, with the one that is made
  size_t floats = 0;                   ///< of all images together
  ViewImages probe;                    ///< of the samples of one pixel; only if steps run apart

  /// With `apart`, each step that need not run over samples is a group of its own.
  explicit FrameLayout(const Plan& plan, bool apart = false);

  /// Steps that run right after what is before them, pixel by pixel.
  size_t fused() const;
};

/// The bytes of shadow maps.
uint64_t shadow_bytes(const Plan& plan);

}  // namespace isoshade::render
