// SPDX-License-Identifier: Apache-2.0
// Creates a backend by its name.
#pragma once

#include <memory>
#include <string>

#include "backends/backend.h"
#include "backends/cpu/kernel.h"
#include "compiler/support/process.h"

namespace isoshade::choice {

/// The options of all backends; each reads its own.
struct Options {
  std::string name = "cpu";  ///< "cpu" "vulkan" "interpreter" "reference"
  std::string lanes;     ///< "1" "4" "8" "16" "8x2" "16x2"; empty: the widest that the machine has
  int threads = 0;       ///< 0: one for each core
  cpu::Execution execution = cpu::Execution::compiled;  ///< of the cpu backend
  std::string compiler;  ///< for generated C++; empty: $ISOSHADE_CXX, c++, g++, clang++
  support::Seconds build_timeout = support::default_time_limit;  ///< for each run of the compiler
  std::string cache;     ///< the folder of the cache; empty: the user's
  std::string device;    ///< part of the name of a Vulkan device, or its number; empty: a CPU device if there is one
  std::string division;  ///< of Vulkan: "native" or "exact"; empty: as the probe decides
};

/// Null if the backend is unknown or cannot be used, which is reported. Thread-safe.
std::unique_ptr<backends::Backend> create(const Options& options, support::Diagnostics& diagnostics);

/// Whether the diagnostics say that the machine has no compiler for generated C++, and nobody asked for a certain one.
/// The cpu backend can then interpret programs.
bool may_stand_in(const Options& options, const support::Diagnostics& diagnostics);

}  // namespace isoshade::choice
