// SPDX-License-Identifier: Apache-2.0
// Telling what of an object was not drawn.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compiler/driver/driver.h"
#include "runtime/render/stats.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

/// How much of an object a pass left out.
struct PassSkips {
  int64_t unseen = 0;    ///< copies
  int64_t disabled = 0;  ///< parts of copies
  int64_t uncut = 0;     ///< parts of copies that are drawn without their cut-out
};

/// Adds to `skips` what the passes of its effect, at least one, left out of an object whose mesh has `parts`.
void report_skips(const scene::Object& object, const driver::Effect& effect, int64_t parts,
                  std::span<const PassSkips> passes, std::vector<Skipped>& skips);

/// Adds what tiles were spared while a frame was drawn.
void report_tiles(const backends::TileCounts& counts, std::vector<Skipped>& skips);

}  // namespace isoshade::render
