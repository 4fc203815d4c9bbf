// SPDX-License-Identifier: Apache-2.0
// What a lowered document computes, in floats and in 57 digits, with lights, textures and images to ask for.
#pragma once

#include <array>
#include <vector>

#include "backends/reference/evaluator.h"
#include "compiler/interface/binding.h"
#include "compiler/ir/interpreter.h"
#include "compiler/lower/frame_layout.h"

namespace isoshade::accuracy {

/// Tables that what stands around a document loads from: lights, textures from 1x1 to 8192x1, images.
class Surroundings {
 public:
  Surroundings();

  static constexpr int textures = 6;
  /// Gives bodies to what a lowered document leaves to its host.
  static void define(ir::Module& module, const interface::Interface& interface);
  template <class Machine>
  void bind(Machine& machine) const {
    for (size_t i = 0; i < buffers_.size(); ++i)
      if (!buffers_[i].empty()) machine.bind(static_cast<uint32_t>(i), buffers_[i]);
  }

 private:
  std::array<std::vector<uint32_t>, std::size(lower::frame_buffers)> buffers_;
};

/// Runs the function of a document: `floats` has bodies for the library's functions, `exact` none.
class DocumentRuns {
 public:
  /// `interface`: of both modules.
  DocumentRuns(ir::Module floats, ir::Module exact, const interface::Interface& interface);

  /// The words of the parameters. False if the floats took too many steps. Needs lanes::FpGuard.
  bool run_floats(std::span<const uint32_t> arguments);
  void run_exact(std::span<const uint32_t> arguments);

  const std::vector<uint32_t>& floats() const { return floats_; }
  const std::vector<reference::Cell>& exact() const { return exact_; }
  /// Of the entry.
  const std::vector<ir::Parameter>& parameters() const {
    return exact_module_.functions[entry_].parameters;
  }

 private:
  Surroundings surroundings_;
  ir::Module floats_module_, exact_module_;
  uint32_t entry_;
  ir::Interpreter interpreter_;
  reference::Evaluator evaluator_;
  std::vector<uint32_t> floats_;
  std::vector<reference::Cell> exact_;
};

}  // namespace isoshade::accuracy
