// SPDX-License-Identifier: Apache-2.0
// Internal errors abort with a message, or are thrown to the boundary of a library (boundary.h); none is a diagnostic.
#pragma once

#include <string_view>

namespace isoshade::support {

/// Prints "isoshade: internal error: MESSAGE" to stderr and aborts; or throws, see boundary.h.
[[noreturn]] void bug(std::string_view message);

/// Aborts unless `condition` holds.
inline void assert_that(bool condition, std::string_view message) {
  if (!condition) bug(message);
}

}  // namespace isoshade::support
