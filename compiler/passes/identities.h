// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "compiler/passes/editor.h"

namespace isoshade::passes {

/// A value that a primitive op's result equals on all values of its operands, given that no float is denormal
/// and NaN is one value; nothing if none is known. The op stays as it is; what is made comes before it. x +
/// (+0) is not x, because (-0) + (+0) is +0; neither is x - x zero, nor x * 0.
std::optional<ir::ValueId> identity(Editor& editor, const ir::Instruction& instruction);

}  // namespace isoshade::passes
