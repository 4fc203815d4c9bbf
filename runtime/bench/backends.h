// SPDX-License-Identifier: Apache-2.0
// The backends that are measured against each other.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "backends/backend.h"
#include "runtime/bench/measure.h"

namespace isoshade::bench {

/// GLSL definitions by program, in place of the generated ones of the same names.
using BuiltIns = std::map<const driver::Program*, std::string>;

struct Contestant {
  std::string backend;  ///< "cpu", "vulkan"
  std::string lanes;
  bool built_ins = false;  ///< runs GLSL's own functions, where a subject has such a text
  std::unique_ptr<backends::Backend> device;
};

/// The cpu at each lane count, vulkan, and vulkan with built-ins. They keep the texts of programs, which must outlive
/// them, so that a second run of a program makes none. Empty, with diagnostics, where one cannot be had.
std::vector<Contestant> contestants(const BenchOptions& options, const BuiltIns& built_ins,
                                    support::Diagnostics& diagnostics);

/// A GLSL text with these definitions instead of its own of the same names, and free to be optimised.
std::string with_built_ins(std::string glsl, const std::string& definitions);

}  // namespace isoshade::bench
