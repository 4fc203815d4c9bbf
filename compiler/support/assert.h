// SPDX-License-Identifier: Apache-2.0
// Bugs of ours end the program with a message; they are never the user's to read as a diagnostic.
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
