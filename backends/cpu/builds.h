// SPDX-License-Identifier: Apache-2.0
// Compiling in the background. What is not done when this process ends goes on, and the next process that needs it, or any
// that compiles with the same cache, takes it from there.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <sys/types.h>
#include <thread>
#include <utility>
#include <vector>

#include "backends/cache.h"
#include "backends/cpu/compiler.h"

namespace isoshade::cpu {

/// What compiling needs besides a text.
struct Toolchain {
  Compiler compiler;
  backends::Cache cache;
  LaneCount lanes;
};

/// A text to compile.
struct Build {
  std::string what;   ///< for messages: "the pixel program of \"a.json\""
  std::string text;
  std::string entry;  ///< of the cache, which receives the shared object
  /// Called on another thread when the entry is there; reports what is wrong with it.
  std::function<void(const std::string& path, support::Diagnostics&)> ready;
};

class Builds {
 public:
  /// `toolchain` must outlive this.
  explicit Builds(const Toolchain& toolchain) : toolchain_(toolchain) {}
  /// Calls no `ready` any more. Leaves unfinished builds to processes that go on, unless the cache is temporary.
  ~Builds();
  Builds(const Builds&) = delete;
  Builds& operator=(const Builds&) = delete;

  void add(Build build);
  /// Reports, as warnings, what has failed since the last call.
  void report(support::Diagnostics& diagnostics);

 private:
  using Clock = std::chrono::steady_clock;
  struct Running {
    Running(Build made, std::string in) : build(std::move(made)), folder(std::move(in)) {}
    Build build;
    std::string folder;
    pid_t group = 0;  ///< of the processes that compile it; 0: they are another process's
    Clock::time_point start = {};
  };
  enum class Claim : uint8_t { done, own, other };

  void work();
  void leave(std::vector<Running> rest);
  void adopt_all() const;
  bool adopt(const std::string& entry, const std::string& folder, support::Diagnostics& diagnostics) const;
  Claim claim(Running& running);
  bool begin(Running& running);
  bool start(const std::vector<Running*>& all);
  bool use(const Running& running);
  bool is_done(Running& running);
  static void forget(const Running& running);
  static void abandon(const Running& running);
  void fail(const support::Diagnostics& failure);
  void fail(const Running& running, const std::string& how, const std::string& words);

  const Toolchain& toolchain_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ends_ = false;             ///< this and the following two need the mutex
  std::deque<Build> waiting_;
  std::vector<support::Diagnostic> failures_;
  std::vector<Running> running_;  ///< of the thread alone
  std::thread thread_;            ///< started by the first build
};

}  // namespace isoshade::cpu
