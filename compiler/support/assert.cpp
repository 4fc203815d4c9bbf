// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/assert.h"

#include <cstdio>
#include <cstdlib>

namespace isoshade::support {

void bug(std::string_view message) {
  std::fprintf(stderr, "isoshade: internal error: %.*s\n", static_cast<int>(message.size()), message.data());
  std::abort();
}

}  // namespace isoshade::support
