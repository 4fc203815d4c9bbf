// SPDX-License-Identifier: Apache-2.0
// The object that made a pixel infinite or NaN.
#pragma once

#include "backends/backend.h"
#include "runtime/render/finite.h"
#include "runtime/render/layout.h"

namespace isoshade::render {

/// Finds the object that the first of `report.drawn` shows, by drawing the samples of that pixel again, to `probe`.
/// `drawing`: as it was drawn, without posts.
bool find_object(backends::Backend& backend, const backends::Drawing& drawing, const FrameLayout::ViewImages& probe,
                 NonFiniteReport& report, support::Diagnostics& diagnostics);

}  // namespace isoshade::render
