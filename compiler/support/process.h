// SPDX-License-Identifier: Apache-2.0
// Running another program, without a shell in between.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compiler/support/diagnostics.h"

namespace isoshade::support {

struct ProcessEnd {
  int status;          ///< its exit status; 128 and the signal's number if one ended it
  std::string output;  ///< what it wrote to stdout and stderr, at most 64 KiB of it
  bool late = false;   ///< it did not end in time, and was killed
};

using Seconds = std::chrono::duration<double>;

/// How long a program may take where the user does not say.
inline constexpr Seconds default_time_limit{120};

using Variables = std::vector<std::pair<std::string, std::string>>;

/// The path of a program: `name` itself if it has a slash, else where PATH has it; empty if there is none. The
/// working folder is not searched, whatever PATH says.
std::string find_program(const std::string& name);

/// Runs the program at the path arguments[0] to its end, with nothing to read and `variables` set in its
/// environment. After `limit` it is killed, with all programs that it started. Nothing if it cannot be started.
std::optional<ProcessEnd> run_process(const std::vector<std::string>& arguments,
                                      const Variables& variables = {}, Seconds limit = default_time_limit);

/// Reports under `id` that a program did not do something, "compile ...", in time. The caller suggests what to do.
Diagnostic& report_late(Id id, const std::string& program, const std::string& what, Seconds limit,
                        Diagnostics& diagnostics);

}  // namespace isoshade::support
