// SPDX-License-Identifier: Apache-2.0
// Drawing a planned frame with a backend.
#pragma once

#include "runtime/render/plan.h"

namespace isoshade::render {

/// The vertex stage, clipping and snapping, then drawing. Whatever the backend, the same steps on the same
/// numbers. Reports what goes wrong on the device.
bool render(const Plan& plan, backends::Backend& backend, backends::Image& image, DrawStats& stats,
            support::Diagnostics& diagnostics);

}  // namespace isoshade::render
