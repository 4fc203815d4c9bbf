// SPDX-License-Identifier: Apache-2.0
// A function in two parts, for hoist.cpp: what pixels compute, and what the draw computes for them.
#pragma once

#include <algorithm>
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "compiler/ir/module.h"
#include "compiler/passes/draw_rate.h"

namespace isoshade::passes {

/// A value that pixels read: of the function itself, or one of those that a call of it reads.
struct Item {
  ir::ValueId value = ir::none;  ///< none: of a call
  ir::InstructionId call = ir::none;
  size_t of_call = 0;  ///< the number of the callee's item
  bool operator<(const Item& other) const {
    return std::tie(value, call, of_call) < std::tie(other.value, other.call, other.of_call);
  }
};

/// A function in two: what pixels compute, and what the draw computes for them.
struct Split {
  uint32_t pixels = ir::none;  ///< the function with the items as further parameters
  uint32_t draw = ir::none;    ///< (what it needs of the parameters that are the same) -> the items
  std::vector<size_t> needs;   ///< these parameters
  std::vector<bool> reads;     ///< by parameter: whether pixels still read it
  std::vector<ir::Parameter> items;
};

/// Which parameters the results of a function depend on.
std::vector<bool> parameters_needed(const ir::Function& f);

/// By value: whether it costs pixels no operation, as constants, words of records, and vectors of such. Only kernels load
/// from records.
std::vector<bool> free_values(const ir::Function& f, const RatesOfFunction& rates, bool is_kernel);

/// Copies instructions of one function into another.
class Copier {
 public:
  Copier(const ir::Function& from, ir::Function& to) : from_(from), to_(to) {}

  std::map<ir::ValueId, ir::ValueId> values;  ///< what became of the values of the first

  ir::ValueId new_value(ir::ValueId of);
  /// Copies an instruction whose operands are copied, and its blocks. It is in no block yet.
  ir::InstructionId copy(ir::InstructionId id);

 private:
  ir::BlockId copy_block(ir::BlockId id);

  const ir::Function& from_;
  ir::Function& to_;
};

/// Copies what some values depend on into a function of its own.
class Slice {
 public:
  /// `splits`: of the calls whose callees are split, into functions of the module.
  Slice(const ir::Function& from, const RatesOfFunction& rates, const std::map<ir::InstructionId, const Split*>& splits,
        const ir::Module& module, ir::Function& to);

  ir::ValueId copy(const Item& item) { return item.value != ir::none ? copy(item.value) : copy_result(item); }
  void yield(ir::ValueId value, std::string name);

  std::vector<size_t> needs;  ///< the parameters of the other function that this one has, in their order

 private:
  ir::ValueId copy(ir::ValueId value);
  /// A result of the draw function of a call's callee.
  ir::ValueId copy_result(const Item& item);
  /// Puts a body where it is called, so that what several calls compute alike is computed once.
  std::vector<ir::ValueId> inline_body(const ir::Function& body, std::span<const ir::ValueId> arguments);
  std::vector<ir::ValueId> call(const Split& split, std::span<const ir::ValueId> arguments);
  ir::ValueId add_parameter(ir::ValueId value);
  /// What an instruction reads, and what its blocks read and do not make.
  std::vector<ir::ValueId> read_from_outside(ir::InstructionId id) const;

  const ir::Function& from_;
  const RatesOfFunction& rates_;
  const std::map<ir::InstructionId, const Split*>& splits_;
  const ir::Module& module_;
  ir::Function& to_;
  Copier copier_;
  std::map<ir::InstructionId, std::vector<ir::ValueId>> results_;  ///< of calls
};

}  // namespace isoshade::passes
