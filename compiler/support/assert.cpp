// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/assert.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>

#include "compiler/support/boundary.h"

namespace isoshade::support {
namespace {

std::atomic<bool> bugs_throw = false;

}  // namespace

void let_bugs_throw() { bugs_throw = true; }

void bug(std::string_view message) {
  if (bugs_throw) throw InternalError(message);
  std::fprintf(stderr, "isoshade: internal error: %.*s\n", static_cast<int>(message.size()), message.data());
  std::abort();
}

}  // namespace isoshade::support
