// SPDX-License-Identifier: Apache-2.0
// isoshade cache: prints the folder and the contents of the cache, or clears it.
#include "backends/cache.h"

#include <cstdio>

#include "compiler/support/memory.h"
#include "runtime/cli/session.h"

namespace isoshade::cli {

int cache(const CacheArguments& arguments, const Common& common) {
  support::Diagnostics diagnostics = make_diagnostics(common);
  const auto cache = backends::Cache::open("", diagnostics);
  const bool usual = cache && cache->folder() == backends::Cache::usual_folder();
  if (cache && !usual)
    std::printf("there is no cache: every run compiles again\n");
  else if (cache) {
    const backends::CacheContents held = cache->contents();
    const backends::CacheContents left = arguments.clear ? cache->clear() : held;
    const backends::CacheLimit limit;
    std::printf("%s\n", cache->folder().c_str());
    if (arguments.clear) {
      std::printf("%zu entries deleted, %zu left\n", held.entries - left.entries, left.entries);
    } else {
      std::printf("%zu entries, %s (at most %zu entries, %s)\n", held.entries,
                  support::memory_text(held.bytes).c_str(), limit.entries,
                  support::memory_text(limit.bytes).c_str());
      for (size_t k = 0; k < backends::entry_kinds; ++k)
        if (held.of_kind[k] > 0)
          std::printf("  %s: %zu\n", std::string(backends::name(static_cast<backends::EntryKind>(k))).c_str(),
                      held.of_kind[k]);
    }
  }
  return flush(diagnostics, common) ? failure : success;
}

}  // namespace isoshade::cli
