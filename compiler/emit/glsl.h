// SPDX-License-Identifier: Apache-2.0
// GLSL 4.50 for Vulkan.
#pragma once

#include <string>
#include <vector>

#include "compiler/emit/printer.h"
#include "compiler/ir/module.h"

namespace isoshade::emit {

/// The entry function and all that it calls, without a stage around them: engine-neutral text.
std::string glsl_functions(const ir::Module& module, uint32_t entry);
/// The same for a text that defines ISO_ZERO itself. `texts` receives what print_functions (printer.h) gives.
std::string glsl_functions(const ir::Module& module, uint32_t entry, std::vector<FunctionText>& texts);

/// What every shader of ours begins with: the version, and the execution mode without which `a < b ? a : b`
/// may swallow a NaN.
std::string glsl_head();

}  // namespace isoshade::emit
