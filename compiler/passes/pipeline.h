// SPDX-License-Identifier: Apache-2.0
// The passes in their order.
#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "compiler/functions/tier.h"
#include "compiler/interface/skips.h"
#include "compiler/ir/module.h"
#include "compiler/passes/hoist.h"

namespace isoshade::passes {

/// The functions that are called from outside the module; dce updates the indices.
struct Entries {
  std::vector<uint32_t> functions;
  /// Other programs call them, and compute with what they return.
  bool are_linked = false;
  /// What hoist goes by, for the only function; none: it does nothing. What it moved is left in `draw_values`.
  std::optional<DrawRate> draw_rate = {};
  std::optional<DrawValues> draw_values = {};

  Entries(std::initializer_list<uint32_t> list) : functions(list) {}
  uint32_t operator[](size_t i) const { return functions[i]; }
};

/// One line of a pipeline.
struct ModulePass {
  std::string_view name;
  void (*run)(ir::Module&, Entries&, functions::Tier);
  std::string_view reason;  ///< why it stands where it stands
  std::optional<interface::Skip> skip = {};  ///< it is left out where this skip is off
};

/// From the lowered module to what is printed: no declarations, no dead code, nothing that a driver would fold.
std::span<const ModulePass> optimisations();
/// After `optimisations`, for devices whose `/` and `sqrt` are not correctly rounded.
std::span<const ModulePass> division_lowering();
/// After `optimisations` (and `division_lowering`), for languages that have neither imulhi nor umulhi.
std::span<const ModulePass> multiplication_lowering();

/// Called after each pass with its name.
using Dump = std::function<void(std::string_view pass, const ir::Module&)>;

/// Runs the passes in order, but for those of skips that are off; library functions get the bodies of the tier. With
/// `check` (always in debug builds), a pass that leaves an invalid module is a bug.
void run(std::span<const ModulePass> passes, ir::Module& module, Entries& entries, functions::Tier tier,
         const Dump& dump = {}, bool check = false, const interface::Skips& skips = {});

}  // namespace isoshade::passes
