// SPDX-License-Identifier: Apache-2.0
// The CPU backend: generated C++, compiled by the machine's compiler, run over tiles on all cores. Until it is compiled,
// or if it cannot be, the interpreter may run the programs.
#pragma once

#include <memory>
#include <string>

#include "backends/backend.h"
#include "backends/cpu/kernel.h"
#include "compiler/support/process.h"

namespace isoshade::cpu {

struct CpuOptions {
  /// "1", "4", "8", "16", "8x2", "16x2"; empty: the fastest of the machine.
  std::string lanes;
  /// 0: as many as the machine has cores.
  int threads = 0;
  /// A path, or a name on PATH. Empty: $ISOSHADE_CXX, else c++, g++, clang++.
  std::string compiler;
  /// The folder that caches compiled code. Empty: isoshade in $XDG_CACHE_HOME or $HOME/.cache.
  std::string cache;
  /// The time that the compiler may take for one program.
  support::Seconds build_timeout = support::default_time_limit;
  Execution execution = Execution::compiled;
  /// A folder that receives the generated C++; empty: none does.
  std::string keep;
  /// The text of a program; see targets/cpp/stages.h for its exports.
  CppText cpp = driver::cpp;
};

/// Null if the lanes, the compiler or the cache are not available, which is reported. After Id::no_compiler, callers
/// may ask for Execution::interpreted instead.
std::unique_ptr<backends::Backend> create(const CpuOptions& options, support::Diagnostics& diagnostics);

}  // namespace isoshade::cpu
