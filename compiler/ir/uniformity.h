// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::ir {

/// By value: whether it is the same for all lanes of a batch, given the parameters' `uniform` flags. Values
/// are pure, so it does not matter whether the branches around them are uniform: an instruction's results are
/// uniform where its operands are, a branch's where condition and yields are, a loop's index always, and a
/// carried value where count, initial value and yield are.
std::vector<bool> uniform_values(const Function& function);
/// The same where these parameters are uniform.
std::vector<bool> uniform_values(const Function& function, const std::vector<bool>& parameters);

}  // namespace isoshade::ir
