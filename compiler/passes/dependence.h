// SPDX-License-Identifier: Apache-2.0
// Which values of a function change with which: what derivatives are to follow.
#pragma once

#include <functional>
#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// One mark for each value, or each of a list.
using Marks = std::vector<bool>;

/// Which results of a call change, given which of its arguments do.
using CallChanges = std::function<Marks(const ir::Instruction&, const Marks& arguments)>;

/// The values that change if these parameters do. Only floats can; what goes through ints, truths, floor and
/// loads changes nowhere but where it jumps.
Marks changing(const ir::Function& function, const Marks& parameters, const CallChanges& calls);

/// Of the values that are `changing`, those on which `wanted` ones depend, and these.
Marks needed(const ir::Function& function, const Marks& changing, const Marks& wanted);

}  // namespace isoshade::passes
