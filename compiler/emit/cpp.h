// SPDX-License-Identifier: Apache-2.0
// C++20 over runtime/lanes.
#pragma once

#include <string>
#include <vector>

#include "compiler/emit/printer.h"
#include "compiler/ir/module.h"

namespace isoshade::emit {

/// The entry function and all that it calls as templates over the float type F, for use inside a namespace
/// that says `using namespace isoshade::lanes`: engine-neutral text.
std::string cpp_functions(const ir::Module& module, uint32_t entry);
/// `texts` receives what print_functions (printer.h) gives.
std::string cpp_functions(const ir::Module& module, uint32_t entry, std::vector<FunctionText>& texts);

/// `struct Buffers` with a member for each buffer of the module.
std::string cpp_buffers(const ir::Module& module);

}  // namespace isoshade::emit
