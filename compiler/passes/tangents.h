// SPDX-License-Identifier: Apache-2.0
// Copies a function's body and adds the derivatives of its values.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "compiler/ir/builder.h"
#include "compiler/passes/dependence.h"

namespace isoshade::passes {

/// One direction of differentiation.
struct Way {
  std::string suffix;  ///< of the names of derivatives: "_ddx"
  ir::Opcode op{};     ///< which op asks for derivatives in this direction: ddx or ddy
  Marks needed;        ///< the values whose derivative is needed
  /// By value of the old body: its derivative in the new body; none where it is not needed, or is zero.
  std::vector<ir::ValueId> change = {};
};

/// Copies a body and differentiates it, by the column `change` of ops.def: the derivative of floor, and of whatever is
/// no float, is 0; that of a select or branch is that of the side taken; |x| and sqrt(x) have derivative 0 at 0.
class Tangents {
 public:
  using ValueId = ir::ValueId;
  using Values = std::vector<ValueId>;

  /// Whether a ddx or ddy is copied as it is.
  using Waits = std::function<bool(const ir::Instruction& derivative)>;
  /// Makes the call of `made`; `arguments` are those of the new body.
  using Call = std::function<Values(const ir::Instruction& made, const Values& arguments)>;
  /// The derivatives of the call's results; none where they are not needed.
  using CallChange =
      std::function<Values(const ir::Instruction& made, const Values& arguments, const Way& way)>;

  /// `from` is the old function; the builder's function begins with the same parameters.
  Tangents(ir::Builder& builder, const ir::Function& from, std::vector<Way>& ways, Waits waits, Call call,
           CallChange call_change);

  /// Makes the body. The builder is then at its end.
  void run() { block(0); }
  ValueId value(ValueId old) const { return values_[old]; }
  /// The derivative of a value of the old body; a zero where there is none.
  ValueId change(const Way& way, ValueId old);

 private:
  ValueId zero(ir::Type type);
  void block(ir::BlockId id);
  void instruction(const ir::Instruction& made);
  void copy(const ir::Instruction& made);
  void branch(const ir::Instruction& made);
  void loop(const ir::Instruction& made);
  void take_results(const ir::Instruction& made, const Values& results);
  ValueId change_of(const ir::Instruction& made, const Way& way);
  /// The sum of two derivatives, either of which may be none, which is zero.
  ValueId sum(ValueId a, ValueId b);
  ValueId componentwise(ir::Type type, const std::function<ValueId(uint32_t)>& component);
  void name(ValueId made, ValueId old, const std::string& suffix, size_t first_new);

  ir::Builder& b_;
  const ir::Function& from_;
  std::vector<Way>& ways_;
  Waits waits_;
  Call call_;
  CallChange call_change_;
  Values values_;  ///< by value of `from`
};

}  // namespace isoshade::passes
