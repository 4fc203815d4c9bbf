// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "compiler/ir/module.h"

namespace isoshade::ir {

/// Reads text IR (printer.h) back. Values, instructions, blocks and origins are numbered in the order of the
/// text, as the renumber pass does it: print and parse give back exactly a module that is numbered so. Any
/// other text gives nothing and `error` = "line 3: ...". What it gives is well formed, but not yet valid
/// (validator.h).
std::optional<Module> parse(std::string_view text, std::string& error);

}  // namespace isoshade::ir
