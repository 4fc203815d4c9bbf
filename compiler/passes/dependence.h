// SPDX-License-Identifier: Apache-2.0
// Which values of a function depend on which: where derivatives are needed.
#pragma once

#include <functional>
#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// One mark for each value, or each of a list.
using Marks = std::vector<bool>;

/// Which results of a call change, given which of its arguments do.
using CallChanges = std::function<Marks(const ir::Instruction&, const Marks& arguments)>;

/// The values whose derivative may be other than 0 if these parameters change: floats that depend on them other than
/// through ints, truth values, floor and loads, which are constant but for jumps.
Marks changing(const ir::Function& function, const Marks& parameters, const CallChanges& calls);

/// Those of the `changing` values that are wanted, or on which wanted ones depend.
Marks needed(const ir::Function& function, const Marks& changing, const Marks& wanted);

/// The floats that are marked or depend on some that are, other than through ints, truth values and floor.
Marks depending(const ir::Function& function, Marks marks);

}  // namespace isoshade::passes
