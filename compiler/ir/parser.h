// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "compiler/ir/module.h"

namespace isoshade::ir {

/// Reads text IR (printer.h) back. Values, instructions, blocks and origins are numbered in the order of the
/// text, as the renumber pass does it, so that print and parse reproduce a renumbered module exactly. Returns
/// nothing and sets `error` to "line 3: ..." for any other text. The module is well formed, but need not be
/// valid (validator.h).
std::optional<Module> parse(std::string_view text, std::string& error);

}  // namespace isoshade::ir
