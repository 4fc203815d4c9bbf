// SPDX-License-Identifier: Apache-2.0
// Threads whose float mode is the one that the contract requires.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "runtime/lanes/lanes.h"

namespace isoshade::threads {

class Workers {
 public:
  /// 0: as many as there are cores.
  explicit Workers(int threads) : arena_(threads > 0 ? threads : tbb::task_arena::automatic) {
    const size_t wanted = static_cast<size_t>(arena_.max_concurrency());
    using Limit = tbb::global_control;
    if (wanted > Limit::active_value(Limit::max_allowed_parallelism))
      more_.emplace(Limit::max_allowed_parallelism, wanted);
  }

  int count() const { return arena_.max_concurrency(); }

  /// Runs body(i) for all i in [0, count), in parallel and in any order. Each task sets the float mode: TBB's threads
  /// have the mode of the thread that first used TBB.
  template <class Body>
  void for_each(size_t count, const Body& body) {
    arena_.execute([&] {
      tbb::parallel_for(tbb::blocked_range<size_t>(0, count), [&](const tbb::blocked_range<size_t>& range) {
        const lanes::FpGuard guard_floats;
        for (size_t i = range.begin(); i < range.end(); ++i) body(i);
      });
    });
  }

 private:
  tbb::task_arena arena_;
  std::optional<tbb::global_control> more_;
};

}  // namespace isoshade::threads
