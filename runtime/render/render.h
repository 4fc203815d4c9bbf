// SPDX-License-Identifier: Apache-2.0
// Drawing a planned frame with a backend.
#pragma once

#include <optional>

#include "runtime/raster/clip.h"
#include "runtime/render/draw_evaluator.h"
#include "runtime/render/kept.h"
#include "runtime/render/plan.h"
#include "runtime/scene/image_file.h"

namespace isoshade::render {

/// Draws frames with a backend. Its memory and that of the backend live on from one frame to the next.
class Renderer {
 public:
  /// The backend must outlive it.
  explicit Renderer(backends::Backend& backend) : backend_(backend) {}

  /// Draws the views in their order (vertex programs, clipping and snapping, pixel programs), then runs the posts over the
  /// picture. Every backend takes the same steps on the same numbers. If a pixel is not finite, the frame is drawn once
  /// more, step by step, to find what made it so. What has not changed since the last frame is not drawn again
  /// (Skip::frames), unless another renderer has drawn with the backend since then. Reports errors of the device.
  bool draw(const Plan& plan, DrawStats& stats, support::Diagnostics& diagnostics);
  /// The picture that was drawn last; valid until the backend is used again. A device of its own gives it back only now.
  scene::ImageView image();

 private:
  friend class FrameRenderer;
  backends::Backend& backend_;
  support::Array<float> clip_, clip_before_;
  support::Array<float> vertices_;  ///< of the view that is drawn: the frame's, and those that clipping made
  support::Array<int32_t> triangles_;
  raster::Clipper clipper_;
  DrawEvaluator evaluator_;  ///< for posts
  DrawnFrame drawn_;  ///< the frame that was drawn last
  backends::Slot color_, depth_;  ///< of the picture that was drawn last
};

/// Draws one frame; `image` receives a copy.
bool render(const Plan& plan, backends::Backend& backend, backends::Image& image, DrawStats& stats,
            support::Diagnostics& diagnostics);

}  // namespace isoshade::render
