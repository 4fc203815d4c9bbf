// SPDX-License-Identifier: Apache-2.0
// The ranges of a function's values, derived from the declared ranges of its parameters.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "compiler/prove/rules.h"
#include "compiler/functions/tier.h"
#include "compiler/ir/module.h"

namespace isoshade::passes {

/// The range of a component. By default it is unknown: then the component may be NaN or infinite, too.
struct KnownRange {
  double lo = 1, hi = 0;
  /// A float that is 0 may be -0.
  bool may_be_minus_zero = true;
  /// No float but 0 has a smaller magnitude.
  double gap = 0x1p-126;
  /// Of a range that is not known otherwise: the component is no NaN, but may be infinite on the other side.
  std::optional<double> least = {}, most = {};

  explicit operator bool() const { return lo <= hi; }
  bool is_point() const { return lo == hi; }
  bool is_zero() const { return lo == 0 && hi == 0; }
  bool may_be_zero() const { return lo <= 0 && hi >= 0; }
  bool is_never_minus_zero() const { return *this && (!may_be_zero() || !may_be_minus_zero); }
  /// Whether the sign bit is known to be 0.
  bool is_plus() const { return *this && lo >= 0 && is_never_minus_zero(); }
};
/// By component of a value.
using KnownRanges = std::array<KnownRange, 4>;

/// One walk through a function.
struct RangeFrame {
  const ir::Function* function = nullptr;
  std::vector<KnownRanges> values;
};

/// Interval analysis of a module. Needs lanes::FpGuard, and bodies for all calls.
class RangeWalker {
 public:
  RangeWalker(const ir::Module& module, functions::Tier tier);

  /// The ranges of the results for these ranges of the arguments. Records the arguments of calls to functions of
  /// documents.
  std::vector<KnownRanges> walk(uint32_t function, const std::vector<KnownRanges>& arguments);
  /// The ranges of a function's parameters over all its calls; empty if it was not called.
  const std::vector<KnownRanges>& arguments_of(uint32_t function) const { return arguments_[function]; }
  /// Whether a walk met something in the function that ranges decide: a comparison, or a min or max of known numbers.
  bool met_decisions(uint32_t function) const { return met_decisions_[function]; }
  /// False if the walk exceeded its budget; then nothing is known.
  bool finished() const { return budget_ > 0; }

  /// Sets the ranges of an instruction's results. `walk_block`: walks a block of it, whose parameters are set.
  void instruction(RangeFrame& frame, const ir::Instruction& made,
                   const std::function<void(ir::BlockId)>& walk_block);
  /// The ranges of a value of which only the type is known.
  static KnownRanges any(ir::Type type);
  /// The row of functions.def that a function is a variant of, or "".
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
