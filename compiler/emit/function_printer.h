// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/emit/printer.h"

namespace isoshade::emit {

/// Appends one function: its head and body, or its prototype if it has none. Whether it is short enough for one line.
/// `locals` receives the names in it.
bool print_function(std::string& out, const ir::Function& function, const FunctionText& text,
                    const TextContext& context, Names* locals = nullptr);

}  // namespace isoshade::emit
