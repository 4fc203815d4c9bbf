// SPDX-License-Identifier: Apache-2.0
// Internal errors abort with a message; they are never reported as diagnostics.
#pragma once

#include <string_view>

namespace isoshade::support {

/// Prints "isoshade: internal error: MESSAGE" to stderr and aborts.
[[noreturn]] void bug(std::string_view message);

/// Aborts unless `condition` holds.
inline void assert_that(bool condition, std::string_view message) {
  if (!condition) bug(message);
}

}  // namespace isoshade::support
