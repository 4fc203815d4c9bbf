// SPDX-License-Identifier: Apache-2.0
// Child processes and temporary files that must not outlive this process.
#pragma once

#include <mutex>
#include <string>
#include <sys/types.h>

namespace isoshade::support {

/// The global list of them. Hold the lock from before you create one until it is added, so that clean_up()
/// cannot miss it.
class Leftovers {
 public:
  /// Blocks forever once clean_up() has started in another thread, so that nothing new is created.
  [[nodiscard]] static std::unique_lock<std::mutex> lock();

  // The caller must hold the lock.
  static void add_path(const std::string& path);  ///< a file, or a folder with its contents
  static void remove_path(const std::string& path);
  static void add_group(pid_t group);  ///< a process group; remove it before waiting for its leader
  static void remove_group(pid_t group);

  /// Kills the groups and removes the files and folders. Keeps the lock, because the process is about to exit.
  static void clean_up();
};

/// Makes the termination signals (SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU) clean up before they end the process.
/// Ignored signals, as under nohup, stay ignored. Call before any thread is started: a dedicated thread waits for the
/// signals, and all other threads block them.
void clean_up_on_signals();

/// For the handler of a fault signal, which may call only async-signal-safe functions: lets the thread that waits for
/// signals clean up, and ends the process with `status`.
[[noreturn]] void clean_up_and_exit(int status);

}  // namespace isoshade::support
