// SPDX-License-Identifier: Apache-2.0
// How backends say that an array of a frame is larger than they take.
#pragma once

#include <cstddef>
#include <string_view>

#include "backends/backend.h"
#include "compiler/lower/frame_layout.h"

namespace isoshade::backends {

/// Who takes no more than `bytes` in one array.
struct ArrayLimit {
  std::string_view taker;  ///< the name of the device, or "the cpu backend"
  size_t bytes = 0;
  bool is_cpu = false;  ///< no other takes more
};

/// Reports that the array has `bytes`: what is too large, what takes most of it if there is a `frame` that tells, and
/// the way out.
void report_too_large(lower::FrameBuffer array, size_t bytes, const ArrayLimit& limit, const Frame* frame,
                      support::Diagnostics& diagnostics);

}  // namespace isoshade::backends
