// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/emit/printer.h"

namespace isoshade::emit {

/// Appends one function: its head and body, or its prototype if it has none.
void print_function(std::string& out, const ir::Module& module, const ir::Function& function,
                    const FunctionText& text, const Language& language,
                    const std::vector<FunctionText>& texts, const Names& globals);

}  // namespace isoshade::emit
