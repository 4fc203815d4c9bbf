// SPDX-License-Identifier: Apache-2.0
// Runs another program without a shell.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <sys/types.h>
#include <utility>
#include <vector>

#include "compiler/support/diagnostics.h"

namespace isoshade::support {

struct ProcessEnd {
  int status;          ///< the exit status, or 128 + the number of the signal that ended it
  std::string output;  ///< stdout and stderr, at most 64 KiB
  bool late = false;   ///< killed because it exceeded the time limit
};

using Seconds = std::chrono::duration<double>;

/// The time limit unless the user sets one.
inline constexpr Seconds default_time_limit{120};

using Variables = std::vector<std::pair<std::string, std::string>>;

/// The path of a program: `name` itself if it contains a slash, else the first match in PATH; empty if there is none.
/// Relative entries of PATH are skipped, so the working directory is never searched.
std::string find_program(const std::string& name);

/// Runs the program at path arguments[0] and waits for it. Its stdin is empty, and `variables` are added to its
/// environment. After `limit`, kills it and every process that it started. Returns nullopt if it cannot be started.
std::optional<ProcessEnd> run_process(const std::vector<std::string>& arguments,
                                      const Variables& variables = {}, Seconds limit = default_time_limit);

/// Starts the program at path arguments[0] in a process group of its own, which may outlive this process: it has no input,
/// its output is lost, and it is no child of this process. It inherits `descriptor`. Returns the group, nothing if it cannot
/// be started. Until the group is removed from Leftovers, signals that end this process end it too.
std::optional<pid_t> start_process(const std::vector<std::string>& arguments, const Variables& variables, int descriptor);

/// Reports under `id` that a program did not finish `what` ("compile ...") in time. The caller adds the suggestion.
Diagnostic& report_late(Id id, const std::string& program, const std::string& what, Seconds limit,
                        Diagnostics& diagnostics);

}  // namespace isoshade::support
