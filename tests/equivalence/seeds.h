// SPDX-License-Identifier: Apache-2.0
// Which random programs or scenes a test makes.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace isoshade::equivalence {

struct Seeds {
  uint64_t first, last;
};

/// From 0 on, `full_count` with ISOSHADE_FULL; or those of ISOSHADE_SEEDS=FIRST,LAST.
inline Seeds seeds(uint64_t count, uint64_t full_count) {
  Seeds chosen{0, std::getenv("ISOSHADE_FULL") != nullptr ? full_count : count};
  if (const char* given = std::getenv("ISOSHADE_SEEDS"))
    std::sscanf(given, "%lu,%lu", &chosen.first, &chosen.last);
  return chosen;
}

}  // namespace isoshade::equivalence
