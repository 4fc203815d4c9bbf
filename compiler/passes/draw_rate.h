// SPDX-License-Identifier: Apache-2.0
// Which values of a function are the same for all pixels of a draw.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "compiler/passes/hoist.h"

namespace isoshade::passes {

/// Of a function whose parameters at some places are the same all over a draw.
struct RatesOfFunction {
  std::vector<bool> same;   ///< by value
  /// By instruction: a branch or a loop all of whose results are the same. It is computed as a whole.
  std::vector<bool> whole;
  std::vector<ir::InstructionId> made_by;  ///< by value; none: a parameter
};

class Rates {
 public:
  Rates(const ir::Module& module, const DrawRate& rate) : module_(module), rate_(rate) {}

  /// `parameters`: which of them are the same.
  const RatesOfFunction& of(uint32_t function, const std::vector<bool>& parameters);
  /// Whether a function's results depend on its arguments alone, and on buffers that are the same.
  bool depends_on_arguments(uint32_t function);

 private:
  friend class RateWalk;
  bool is_late(const ir::Function& f, const std::vector<ir::InstructionId>& made_by, ir::InstructionId address) const;
  bool is_same_load(const ir::Function& f, const std::vector<ir::InstructionId>& made_by, const ir::Instruction& load) const;

  const ir::Module& module_;
  const DrawRate& rate_;
  std::map<std::pair<uint32_t, std::vector<bool>>, RatesOfFunction> known_;
  std::map<uint32_t, bool> depends_;
};

}  // namespace isoshade::passes
