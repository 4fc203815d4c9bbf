// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "compiler/passes/editor.h"

namespace isoshade::passes {

/// A value that equals a primitive op's result for all values of its operands, given that no float is denormal and
/// NaN is one value (ir/laws.def); nothing if none is known. The op is left as it is; new instructions come before it.
/// Note that x + (+0) is not x, because (-0) + (+0) is +0; nor are x - x and x * 0 zero, because x may be NaN.
std::optional<ir::ValueId> identity(Editor& editor, const ir::Instruction& instruction);

}  // namespace isoshade::passes
