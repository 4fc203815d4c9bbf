// SPDX-License-Identifier: Apache-2.0
// Which numbers the values of a function may be, by what is declared of parameters.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "compiler/prove/rules.h"
#include "compiler/functions/tier.h"
#include "compiler/ir/module.h"

namespace isoshade::passes {

/// What a component is known to lie in; nothing by default: then it may be NaN or infinite, too.
struct KnownRange {
  double lo = 1, hi = 0;
  explicit operator bool() const { return lo <= hi; }
  bool is_point() const { return lo == hi; }
};
/// Of the components of a value.
using KnownRanges = std::array<KnownRange, 4>;

/// One walk through a function.
struct RangeFrame {
  const ir::Function* function = nullptr;
  std::vector<KnownRanges> values;
};

/// Walks functions by ranges. Needs lanes::FpGuard, and bodies for all calls.
class RangeWalker {
 public:
  RangeWalker(const ir::Module& module, functions::Tier tier);

  /// The ranges of the results, for these of the arguments. What calls of functions that documents have were given is
  /// kept.
  std::vector<KnownRanges> walk(uint32_t function, const std::vector<KnownRanges>& arguments);
  /// Of the parameters of a function, over all its calls; nothing: it was not called.
  const std::vector<KnownRanges>& arguments_of(uint32_t function) const { return arguments_[function]; }
  /// Whether a walk through the function met anything that ranges decide: a comparison, or a choice of known numbers.
  bool met_decisions(uint32_t function) const { return met_decisions_[function]; }
  /// False if walking took too long to be finished; then nothing is known.
  bool finished() const { return budget_ > 0; }

  /// Sets the ranges of an instruction's results. `walk_block`: walks a block of it, whose parameters are set.
  void instruction(RangeFrame& frame, const ir::Instruction& made,
                   const std::function<void(ir::BlockId)>& walk_block);
  /// What is known of nothing but its type.
  static KnownRanges any(ir::Type type);
  /// As a function of functions.def is called in its table, or "".
  std::string_view row_of(uint32_t function) { return library_of(function).row; }

 private:
  struct Library {
    std::string_view row;
    const prove::Rule* rule = nullptr;  ///< null: its body tells
    bool chooses = false;                  ///< min, max, clamp or saturate
  };
  const Library& library_of(uint32_t function);
  KnownRanges primitive(const RangeFrame& frame, const ir::Instruction& made) const;
  void call(RangeFrame& frame, const ir::Instruction& made);
  KnownRanges chosen(const RangeFrame& frame, const ir::Instruction& made, std::string_view row) const;
  KnownRanges by_rule(const RangeFrame& frame, const ir::Instruction& made, const Library& library) const;
  void loop(RangeFrame& frame, const ir::Instruction& made,
            const std::function<void(ir::BlockId)>& walk_block);
  void block(RangeFrame& frame, ir::BlockId id, uint32_t function);
  bool decides(const RangeFrame& frame, const ir::Instruction& made);
  void keep(uint32_t function, const std::vector<KnownRanges>& arguments);

  const ir::Module& module_;
  functions::Tier tier_;
  std::vector<std::vector<KnownRanges>> arguments_;  ///< by function
  std::vector<bool> met_decisions_;                  ///< by function
  std::vector<std::optional<Library>> library_;      ///< by function
  int budget_ = 200'000;                             ///< instructions
};

}  // namespace isoshade::passes
