// SPDX-License-Identifier: Apache-2.0
#include "compiler/ir/module.h"

#include <algorithm>

namespace isoshade::ir {

uint32_t Module::find(std::string_view function) const {
  for (uint32_t i = 0; i < functions.size(); ++i)
    if (functions[i].name == function) return i;
  return none;
}

uint32_t Module::find_buffer(std::string_view name) const {
  for (uint32_t i = 0; i < buffers.size(); ++i)
    if (buffers[i].name == name) return i;
  return none;
}

bool asks_for_derivatives(const Module& module) {
  return std::ranges::any_of(module.functions, [](const Function& function) {
    return std::ranges::any_of(function.instructions,
                               [](const Instruction& made) { return is_derivative(made.op); });
  });
}

}  // namespace isoshade::ir
