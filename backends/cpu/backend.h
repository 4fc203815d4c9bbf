// SPDX-License-Identifier: Apache-2.0
// The CPU backend: generated C++, compiled by the machine's compiler, run over tiles on all cores.
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
  /// Where compiled code is kept. Empty: isoshade in $XDG_CACHE_HOME or $HOME/.cache.
  std::string cache;
  /// How long the compiler may take for one program.
  support::Seconds build_timeout = support::default_time_limit;
  /// A folder that receives the generated C++; empty: none does.
  std::string keep;
  /// The text of a program; emit/stages.h tells what it must export.
  CppText cpp = driver::cpp;
};

/// Nothing if the lanes, the compiler or the cache cannot be had, which is reported. Id::no_compiler is the
/// sign that the interpreter should serve instead.
std::unique_ptr<backends::Backend> create(const CpuOptions& options, support::Diagnostics& diagnostics);

}  // namespace isoshade::cpu
