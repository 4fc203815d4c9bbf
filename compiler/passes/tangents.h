// SPDX-License-Identifier: Apache-2.0
// A function's body once more, with what its values change by beside them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "compiler/ir/builder.h"
#include "compiler/passes/dependence.h"

namespace isoshade::passes {

/// One way in which what a function depends on changes.
struct Way {
  std::string suffix;  ///< of names of changes: "_ddx"
  ir::Opcode op{};     ///< what asks for changes of this way; ddx or ddy
  Marks needed;        ///< the values whose change is
  std::vector<ir::ValueId> change =
      {};  ///< by value: in the new body; none where it is not needed, or is zero
};

/// Copies a body and differentiates it. The rules: floor and all that is no float change nowhere; a select, a
/// branch follow the side taken; |x| at 0 and sqrt(x) at 0 change by 0; other ops as calculus has it.
class Tangents {
 public:
  using ValueId = ir::ValueId;
  using Values = std::vector<ValueId>;

  /// Makes the call of `made`; `arguments` are those of the new body.
  using Call = std::function<Values(const ir::Instruction& made, const Values& arguments)>;
  /// What the call's results change by; none where it is not needed.
  using CallChange =
      std::function<Values(const ir::Instruction& made, const Values& arguments, const Way& way)>;

  /// `from` is what the builder's function was, whose first parameters are the same.
  Tangents(ir::Builder& builder, const ir::Function& from, std::vector<Way>& ways, Call call,
           CallChange call_change);

  /// Makes the body. The builder is then at its end.
  void run() { block(0); }
  ValueId value(ValueId old) const { return values_[old]; }
  /// A zero where it is none.
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
  /// The sum, where either may be none.
  ValueId sum(ValueId a, ValueId b);
  ValueId componentwise(ir::Type type, const std::function<ValueId(uint32_t)>& component);
  void name(ValueId made, ValueId old, const std::string& suffix, size_t first_new);

  ir::Builder& b_;
  const ir::Function& from_;
  std::vector<Way>& ways_;
  Call call_;
  CallChange call_change_;
  Values values_;  ///< by value of `from`
};

}  // namespace isoshade::passes
