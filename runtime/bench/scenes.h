// SPDX-License-Identifier: Apache-2.0
// Whole scenes for the bench.
#pragma once

#include <deque>
#include <vector>

#include "runtime/bench/backends.h"
#include "runtime/render/plan.h"

namespace isoshade::bench {

/// Adds a point for each scene, tier and contestant: the time to draw a pixel of the image, visibility and background
/// included, and the error of its colours at a smaller size. Plans are kept in `plans`, for contestants remember
/// programs.
bool measure_scenes(const BenchOptions& options, const std::vector<Contestant>& devices,
                    std::deque<render::Plan>& plans, Report& report, support::Diagnostics& diagnostics);

}  // namespace isoshade::bench
