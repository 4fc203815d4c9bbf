// SPDX-License-Identifier: Apache-2.0
// What must not outlive this process: the programs that it runs, and its temporary files and folders.
#pragma once

#include <mutex>
#include <string>
#include <sys/types.h>

namespace isoshade::support {

/// The list of them. Whoever makes one holds the lock from before it is made until it is added, so that no
/// clean_up() can miss it.
class Leftovers {
 public:
  /// Waits forever once another thread cleans up: nothing may be made any more.
  [[nodiscard]] static std::unique_lock<std::mutex> lock();

  // The caller holds the lock.
  static void add_path(const std::string& path);  ///< a file, or a folder with all that is in it
  static void remove_path(const std::string& path);
  static void add_group(pid_t group);  ///< of processes; its leader is not waited for before it is removed
  static void remove_group(pid_t group);

  /// Kills the groups, removes the files and folders, and keeps the lock: the process is about to end.
  static void clean_up();
};

/// From here on a signal that asks the process to end (SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU) still ends it, but
/// first cleans up. One that is ignored, as under nohup, stays ignored. Call before any thread is started: a thread
/// of its own waits for the signals, and all others block them.
void clean_up_on_signals();

/// From the handler of a signal that a fault raised, in which next to nothing is allowed: lets the thread that waits for
/// signals clean up, and ends the process with this status.
[[noreturn]] void clean_up_and_exit(int status);

}  // namespace isoshade::support
