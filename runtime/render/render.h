// SPDX-License-Identifier: Apache-2.0
// Drawing a planned frame with a backend.
#pragma once

#include "runtime/render/plan.h"

namespace isoshade::render {

/// Draws the views in their order (vertex programs, clipping and snapping, pixel programs), then runs the posts over
/// the picture, which `image` receives. Every backend takes the same steps on the same numbers. Reports errors of the
/// device.
bool render(const Plan& plan, backends::Backend& backend, backends::Image& image, DrawStats& stats,
            support::Diagnostics& diagnostics);

}  // namespace isoshade::render
