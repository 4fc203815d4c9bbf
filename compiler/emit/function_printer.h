// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/emit/printer.h"

namespace isoshade::emit {

/// One function: its head and body, or its prototype if it has none.
std::string print_function(const ir::Module& module, const ir::Function& function, const FunctionText& text,
                           const Language& language, const std::vector<FunctionText>& texts,
                           const Names& globals);

}  // namespace isoshade::emit
