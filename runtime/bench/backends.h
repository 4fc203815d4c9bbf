// SPDX-License-Identifier: Apache-2.0
// The backends that are measured, and the measurement of whole scenes on them.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "backends/backend.h"
#include "runtime/bench/measure.h"
#include "runtime/render/plan.h"

namespace isoshade::bench {

/// For each program, GLSL definitions that replace the generated ones of the same names.
using BuiltIns = std::map<const driver::Program*, std::string>;

struct Contestant {
  std::string backend;  ///< "cpu", "vulkan"
  std::string lanes;
  bool built_ins = false;  ///< uses GLSL's own functions in the programs that have BuiltIns
  std::unique_ptr<backends::Backend> device;
};

/// The cpu at each lane count, vulkan, and vulkan with built-ins. They cache the text of each program by its address, so
/// programs must outlive them. Empty, with diagnostics, if one of them cannot be created.
std::vector<Contestant> contestants(const BenchOptions& options, const BuiltIns& built_ins,
                                    support::Diagnostics& diagnostics);

/// The GLSL text with `definitions` in place of its own definitions of the same names, and without `precise`, so that
/// drivers may optimise it.
std::string with_built_ins(std::string glsl, const std::string& definitions);

/// Adds a point for each scene, tier and contestant: the time per pixel of the image, including vertices, visibility and
/// background, and the error of its colours at a smaller size; and one of an ordinary renderer on the Vulkan device, see
/// ForwardPeer. `plans` keeps the plans alive, because contestants cache the texts of
/// their programs by address.
bool measure_scenes(const BenchOptions& options, const std::vector<Contestant>& devices,
                    std::deque<render::Plan>& plans, Report& report, support::Diagnostics& diagnostics);

}  // namespace isoshade::bench
