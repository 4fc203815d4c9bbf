// SPDX-License-Identifier: Apache-2.0
// The texts of functions that many programs have: those of the library, and of documents that other documents call. They are
// printed once in a process.
#pragma once

#include "compiler/emit/printer.h"

namespace isoshade::emit {

/// The same as print_function, and the same text, which is kept. A function is known again by all that its text depends on,
/// not by its name.
bool print_known_function(std::string& out, const ir::Function& function, const FunctionText& text,
                          const TextContext& context);

}  // namespace isoshade::emit
